"""Recorded episodes as a page that plays them: one HTML file that needs no network."""

from __future__ import annotations

import html
import json
import math
import pkgutil
import re
from collections.abc import Mapping, Sequence
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from relforest.support.errors import InputError
from relforest.worlds.keepaway.recording import Recording

_PLACE: Final = re.compile(r"@@([a-z]+)@@")
# Within a script element, "</script" and "<!--" would end or hide what follows, and JSON allows line
# separators that old JavaScript does not.
_UNSAFE: Final = {"<": "\\u003c", ">": "\\u003e", "&": "\\u0026", "\u2028": "\\u2028", "\u2029": "\\u2029"}
_DIGITS: Final = 5


def page(recordings: Sequence[Recording], *, title: str = "Keepaway", subtitle: str = "") -> str:
    """Return a page that plays recorded episodes.

    Parameters
    ----------
    recordings : sequence of Recording
        At least one; all on the same field with the same numbers of players.
    title : str
        Name of the page.
    subtitle : str
        A line beside it.

    Returns
    -------
    str
        HTML. Style, program and data are part of it; it may be opened from a disk.

    Raises
    ------
    InputError
        If there is no recording, they differ in field or teams, or a state is not finite.

    Notes
    -----
    Locations are kept in whole centimetres and directions in whole degrees: an episode takes about 130 bytes
    per cycle.
    """
    if not recordings:
        raise InputError("a page needs at least one recorded episode")
    first = recordings[0]
    form = (first.field, first.keepers, first.takers)
    if any((other.field, other.keepers, other.takers) != form for other in recordings):
        raise InputError("the episodes of a page must have the same field and the same numbers of players")
    game = {
        "title": title,
        "subtitle": subtitle,
        "field": list(first.field),
        "keepers": first.keepers,
        "takers": first.takers,
        "episodes": [_episode(recording) for recording in recordings],
    }
    parts = {
        "title": html.escape(title),
        "style": _asset("css"),
        "script": _asset("js"),
        "data": _embedded(game),
    }
    # In one pass, so that nothing inside a part is taken for a place to fill.
    return _PLACE.sub(lambda place: parts[place[1]], _asset("html"))


def _episode(recording: Recording) -> dict[str, Any]:
    decisions = recording.decisions
    known = bool(np.isfinite(decisions.values).any())
    bodies = _whole(recording.players[:, :, 4:5])
    return {
        "end": int(recording.end),
        "players": np.concatenate([_whole(100 * recording.players[:, :, :2]), bodies], axis=2)
        .ravel()
        .tolist(),
        "ball": _whole(100 * recording.ball[:, :2]).ravel().tolist(),
        "commands": recording.commands.ravel().tolist(),
        "decisions": {
            "time": decisions.times.tolist(),
            "actor": decisions.actors.tolist(),
            "action": decisions.actions.tolist(),
            "order": decisions.orders.ravel().tolist(),
            "values": [_rounded(value) for value in decisions.values.ravel().tolist()] if known else None,
        },
    }


def _whole(values: NDArray[np.float64]) -> NDArray[np.int64]:
    if not np.isfinite(values).all():
        raise InputError("an episode with states that are not finite cannot be shown")
    return np.rint(values).astype(np.int64)


def _rounded(value: float) -> float | None:
    return float(f"{value:.{_DIGITS}g}") if math.isfinite(value) else None


def _embedded(document: Mapping[str, Any]) -> str:
    """Return JSON that is safe inside a script element."""
    text = json.dumps(document, separators=(",", ":"), allow_nan=False)
    return re.sub("[<>&\u2028\u2029]", lambda found: _UNSAFE[found[0]], text)


def _asset(suffix: str) -> str:
    data = pkgutil.get_data("relforest.worlds.keepaway", f"episode_player.{suffix}")
    if data is None:
        raise InputError(f"this installation of relforest lacks episode_player.{suffix}: install it again")
    return data.decode("utf-8").rstrip("\n")
