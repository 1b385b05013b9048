"""Pages that play recorded episodes of a world: one HTML file that works offline.

The package of a world contains ``episode_player.html``, ``.css`` and ``.js``: the page, its additions to the
common style, and the script that draws. The parts common to all players are next to this module.
"""

from __future__ import annotations

import html
import json
import pkgutil
import re
from collections.abc import Mapping
from typing import Any, Final

from relforest.support.errors import InputError

_PLACE: Final = re.compile(r"@@([a-z]+)@@")
# Within a script element, "</script" and "<!--" would end or hide what follows, and JSON allows line
# separators that old JavaScript does not.
_UNSAFE: Final = {"<": "\\u003c", ">": "\\u003e", "&": "\\u0026", "\u2028": "\\u2028", "\u2029": "\\u2029"}
_SHARED: Final = "relforest.support"


def player_page(package: str, game: Mapping[str, Any]) -> str:
    """Return a page that plays episodes.

    Parameters
    ----------
    package : str
        The package of the world, such as ``"relforest.worlds.keepaway"``.
    game : mapping
        JSON for the scripts; ``title``, ``subtitle`` and the list ``episodes`` are read by all players.

    Returns
    -------
    str
        HTML with style, script and data included; it can be opened from disk.

    Raises
    ------
    InputError
        If a part of the player is missing from this installation.
    ValueError
        If ``game`` contains a number that is not finite.
    """
    parts = {
        "title": html.escape(str(game["title"])),
        "style": f"{_asset(_SHARED, 'css')}\n{_asset(package, 'css')}",
        "script": f"{_asset(_SHARED, 'js')}\n\n{_asset(package, 'js')}",
        "data": _embedded(game),
    }
    # In one pass, so that placeholders inside a part are not filled.
    return _PLACE.sub(lambda place: parts[place[1]], _asset(package, "html"))


def _embedded(document: Mapping[str, Any]) -> str:
    """Return JSON that is safe inside a script element."""
    text = json.dumps(document, separators=(",", ":"), allow_nan=False)
    return re.sub("[<>&\u2028\u2029]", lambda found: _UNSAFE[found[0]], text)


def _asset(package: str, suffix: str) -> str:
    data = pkgutil.get_data(package, f"episode_player.{suffix}")
    if data is None:
        raise InputError(f"episode_player.{suffix} is missing from {package}: reinstall relforest")
    return data.decode("utf-8").rstrip("\n")
