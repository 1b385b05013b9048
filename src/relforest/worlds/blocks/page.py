"""Recorded episodes as a page that plays them: one HTML file that works offline."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import astuple
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from relforest.support.errors import InputError
from relforest.support.player import player_page
from relforest.worlds.blocks.recording import OptionRecord, Recording

RATE: Final = 25
"""Pictures per second of the page."""

SCORE_NAMES: Final = {
    "high-towers": "mean height",
    "color-grouping": "colour score",
    "arch": "area of the arch",
}
"""Name of a task -> what its score is."""

# Hundredths of a unit and thousandths of a radian are finer than a pixel.
_GRAIN: Final = np.array([100.0, 100.0, 1000.0])
_DIGITS: Final = 4


def page(recordings: Sequence[Recording], *, title: str = "Blocks", subtitle: str = "") -> str:
    """Return a page that plays recorded episodes.

    Parameters
    ----------
    recordings : sequence of Recording
        At least one; all of the same task.
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
        If recordings are missing, they differ in their tasks, the task is unknown, or a number is not finite.

    Notes
    -----
    Locations are kept in hundredths of a unit and angles in thousandths of a radian, and of each picture what
    changed: an episode takes about a kilobyte per second.
    """
    if not recordings:
        raise InputError("a page needs at least one recorded episode")
    task = recordings[0].task
    if any(other.task != task for other in recordings):
        raise InputError("the episodes of a page must be of the same task")
    if task not in SCORE_NAMES:
        raise InputError(f"task must be one of {', '.join(SCORE_NAMES)}, got {task!r}")
    game = {
        "title": title,
        "subtitle": subtitle,
        "task": task,
        "score": SCORE_NAMES[task],
        "rate": RATE,
        "episodes": [_episode(recording) for recording in recordings],
    }
    return player_page("relforest.worlds.blocks", game)


def _episode(recording: Recording) -> dict[str, Any]:
    ticks = np.arange(round((recording.times[-1] - recording.times[0]) * RATE) + 1)
    times = recording.times[0] + ticks / RATE
    gone = [_gone(recording.times, recording.poses[:, block]) for block in range(len(recording.ids))]
    columns = [
        _column(times, recording.times, recording.poses[:, block, part])
        for block in range(len(recording.ids))
        for part in range(3)
    ]
    poses = np.stack(columns, axis=1) if columns else np.zeros((len(ticks), 0))
    whole = np.rint(poses * np.tile(_GRAIN, len(recording.ids))).astype(np.int64)
    # Where each moment lies, so that what was held just then is known.
    latest = np.searchsorted(recording.times, times + 1e-9, side="right") - 1
    held = recording.held[latest]
    changes = np.flatnonzero(np.diff(held, prepend=-2))
    start = float(recording.times[0])
    return {
        "ids": recording.ids.tolist(),
        "sides": [[_rounded(half) for half in pair] for pair in recording.half_extents.tolist()],
        "colors": [_hex(color) for color in recording.colors],
        "ticks": len(ticks),
        "moves": np.diff(whole, axis=0, prepend=0).ravel().tolist(),
        "gone": [None if time is None else max(round((time - start) * RATE), 0) for time in gone],
        "held": [[int(tick), int(held[tick])] for tick in changes],
        "first": _rounded(recording.first_score),
        "total": _rounded(recording.total_reward),
        "options": [_option(option, start) for option in recording.options],
        "marks": [
            [[_rounded(part) for part in astuple(mark)] for mark in marks] for marks in recording.marks
        ],
    }


def _gone(times: NDArray[np.float64], poses: NDArray[np.float64]) -> float | None:
    """Return when a block fell off the table, or None."""
    missing = np.isnan(poses.sum(axis=1))
    if not missing.any():
        return None
    first = int(np.argmax(missing))
    if first == 0 or not missing[first:].all():
        raise InputError(
            "a block must have a pose at the beginning, and none after it has fallen off the table"
        )
    return float(times[first])


def _column(
    wanted: NDArray[np.float64], times: NDArray[np.float64], values: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return a coordinate at other moments; what is gone stays where it was last."""
    there = ~np.isnan(values)
    if not np.isfinite(values[there]).all():
        raise InputError("an episode with states that are not finite cannot be shown")
    return np.interp(wanted, times[there], values[there])


def _option(option: OptionRecord, start: float) -> dict[str, Any]:
    return {
        "name": option.name,
        "blocks": list(option.blocks),
        "target": None if option.target is None else _rounded(option.target),
        "from": max(round((option.begin - start) * RATE), 0),
        "until": max(round((option.end - start) * RATE), 0),
        "duration": _rounded(option.duration),
        "reward": _rounded(option.reward),
        "score": _rounded(option.score),
    }


def _hex(color: NDArray[np.float64]) -> str:
    if not np.isfinite(color).all():
        raise InputError("an episode with states that are not finite cannot be shown")
    return "#" + "".join(f"{round(255 * part):02x}" for part in np.clip(color, 0.0, 1.0).tolist())


def _rounded(value: float) -> float:
    if not np.isfinite(value):
        raise InputError("an episode with states that are not finite cannot be shown")
    return round(float(value), _DIGITS)
