"""Recorded episodes as a page that plays them: one HTML file that works offline."""

from __future__ import annotations

import html
from collections.abc import Sequence
from typing import Final

from relforest.playing.document import asset, colors, embedded, filled
from relforest.playing.recorder import Recording
from relforest.playing.tracks import FINE, TURN, Tables, episode_data
from relforest.support.errors import InputError

_PACKAGE: Final = "relforest.playing"


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
        "style": f"{colors(stage)}\n{asset(_PACKAGE, 'player.css')}",
        "script": asset(_PACKAGE, "player.js"),
        "data": embedded(game),
    }
    return filled(asset(_PACKAGE, "player.html"), parts)
