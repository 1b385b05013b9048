"""Recorded episodes as a page that plays them: one HTML file that works offline."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from relforest.support.errors import InputError
from relforest.support.player import player_page
from relforest.worlds.keepaway.recording import Recording

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
        HTML with style, script and data included; it can be opened from disk.

    Raises
    ------
    InputError
        If recordings are missing, they differ in field or teams, or a state is not finite.

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
    return player_page("relforest.worlds.keepaway", game)


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
