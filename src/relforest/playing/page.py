"""Recorded episodes as a page that plays them: one HTML file that works offline."""

from __future__ import annotations

import html
import json
import pkgutil
import re
from collections.abc import Mapping, Sequence
from typing import Any, Final

from relforest.playing.frames import Stage
from relforest.playing.recorder import Recording
from relforest.playing.tracks import FINE, TURN, Tables, episode_data
from relforest.support.errors import InputError

_PACKAGE: Final = "relforest.playing"
_PLACE: Final = re.compile(r"@@([a-z]+)@@")
# Within a script element, "</script" and "<!--" would end or hide what follows, and JSON allows line
# separators that old JavaScript does not.
_UNSAFE: Final = {"<": "\\u003c", ">": "\\u003e", "&": "\\u0026", "\u2028": "\\u2028", "\u2029": "\\u2029"}


def page(recordings: Sequence[Recording], *, title: str = "Episodes", subtitle: str = "") -> str:
    """Return a page that plays recorded episodes.

    Parameters
    ----------
    recordings : sequence of Recording
        At least one; all on the same stage.
    title : str
        Name of the page.
    subtitle : str
        A line beside it.

    Returns
    -------
    str
        HTML with style, script and data included; it can be opened from disk.

    Raises
    ------
    InputError
        If recordings are missing, they differ in their stages, a number is not finite, a color is unknown,
        or a part of the page is missing from this installation.

    Notes
    -----
    Of each tick of time only what changed is kept: a thing that moves takes about ten bytes.
    """
    if not recordings:
        raise InputError("a page needs at least one recorded episode")
    stage = recordings[0].stage
    if any(other.stage != stage for other in recordings):
        raise InputError("the episodes of a page must be on the same stage: show them on pages of their own")
    tables = Tables(stage)
    game = {
        "title": title,
        "subtitle": subtitle,
        "view": stage.view,
        "widest": stage.widest,
        "room": stage.room,
        "rate": stage.rate,
        "score": stage.score_name,
        "legend": stage.legend,
        "grain": (stage.view[1] - stage.view[0]) / FINE,
        "turn": 1 / TURN,
        "backdrop": tables.look(stage.backdrop),
        "roles": list(stage.shades),
        "episodes": [episode_data(recording, tables) for recording in recordings],
        "looks": tables.looks,
        "words": tables.words,
    }
    parts = {
        "title": html.escape(title),
        "style": f"{_colors(stage)}\n{asset(_PACKAGE, 'player.css')}",
        "script": asset(_PACKAGE, "player.js"),
        "data": embedded(game),
    }
    return filled(asset(_PACKAGE, "player.html"), parts)


def filled(template: str, parts: Mapping[str, str]) -> str:
    """Return a template with every placeholder, such as ``@@title@@``, replaced by the part of that name."""
    # In one pass, so that placeholders inside a part are not filled.
    return _PLACE.sub(lambda place: parts[place[1]], template)


def _colors(stage: Stage) -> str:
    light, dark = (
        " ".join(f"--{role}: {pair[shade]};" for role, pair in stage.shades.items()) for shade in (0, 1)
    )
    return f":root {{ {light} }}\n@media (prefers-color-scheme: dark) {{ :root {{ {dark} }} }}"


def embedded(document: Mapping[str, Any]) -> str:
    """Return JSON that is safe inside a script element."""
    text = json.dumps(document, separators=(",", ":"), allow_nan=False)
    return re.sub("[<>&\u2028\u2029]", lambda found: _UNSAFE[found[0]], text)


def asset(package: str, name: str) -> str:
    """Return a part of a page, a file of a package; `InputError` if it is not installed."""
    data = pkgutil.get_data(package, name)
    if data is None:
        raise InputError(f"{name} is missing from {package}: reinstall relforest")
    return data.decode("utf-8").rstrip("\n")
