"""The compact form of a recorded episode for the page that plays it: what changes from tick to tick.

A tick is one of the equal steps of time in which the page counts. What stays the same is written once: shapes
in the table of looks, and captions, bands and the like as pairs of a tick and what holds from then on.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict
from typing import Any, Final, final

import numpy as np
from numpy.typing import NDArray

from relforest.playing.frames import Frame, Stage
from relforest.playing.recorder import Choice, Recording, Why
from relforest.playing.shapes import Chip, Shape, Words
from relforest.support.errors import InputError

FINE: Final = 10_000
"""Locations are kept in this fraction of the width of the view, finer than a pixel."""

TURN: Final = 1000
"""Angles are kept in thousandths of a radian."""

_DIGITS: Final = 5
_ABSENT: Final = -1


@final
class Tables:
    """All that is drawn and said: tuples of shapes, and words, each written once."""

    def __init__(self, stage: Stage) -> None:
        self._stage = stage
        self._numbers: dict[tuple[Shape, ...], int] = {}
        # Frames share most tuples, and hashing shapes takes long; they are kept, so that ids stay theirs.
        self._known: dict[int, tuple[int, tuple[Shape, ...]]] = {}
        self._said: dict[Words, int] = {}
        self.looks: list[list[dict[str, Any]]] = []
        self.words: list[list[Any]] = []

    def look(self, shapes: tuple[Shape, ...]) -> int:
        """Return the number of some shapes in the table of looks."""
        if id(shapes) not in self._known:
            if shapes not in self._numbers:
                self._numbers[shapes] = len(self.looks)
                self.looks.append([self._written(shape) for shape in shapes])
            self._known[id(shapes)] = self._numbers[shapes], shapes
        return self._known[id(shapes)][0]

    def said(self, words: Words) -> int:
        """Return the number of some words in the table of words."""
        key = tuple(words)
        if key not in self._said:
            self._said[key] = len(self.words)
            self.words.append([list(part) if isinstance(part, Chip) else part for part in key])
        return self._said[key]

    def _written(self, shape: Shape) -> dict[str, Any]:
        parts = asdict(shape)
        for name in ("color", "fill", "edge", "halo"):
            if parts.get(name):
                self._stage.shade(parts[name])
        plain = {name: _rounded(value) for name, value in parts.items() if value or name == "words"}
        return {"type": type(shape).__name__.lower(), **plain}


def episode_data(recording: Recording, tables: Tables) -> dict[str, Any]:
    """Return an episode as plain values for JSON.

    Raises
    ------
    InputError
        If a number is not finite, or a color unknown.
    """
    frames, rate = recording.frames, recording.stage.rate
    start = frames[0].time
    ticks = np.arange(round((frames[-1].time - start) * rate) + 1)
    times = np.array([frame.time for frame in frames])
    # The latest frame of each tick, and how far it is to the next one.
    latest = np.searchsorted(times, start + ticks / rate + 1e-9, side="right") - 1
    following = np.minimum(latest + 1, len(frames) - 1)
    # Ticks beside a decision show the very moment, in which the world rests.
    moments = np.array([time for choice in recording.choices for time in (choice.begin, choice.end)])
    latest[_ticks(moments, recording)] = np.searchsorted(times, moments)
    gaps = times[following] - times[latest]
    shares = np.where(gaps > 0, (start + ticks / rate - times[latest]) / np.where(gaps > 0, gaps, 1.0), 0.0)
    shares = np.clip(shares, 0.0, 1.0)
    shown = [frames[number] for number in latest]
    tracks = _tracks(frames, tables)
    places = {key: place for place, key in enumerate(tracks)}
    return {
        "ticks": len(ticks),
        "tracks": [_track(track, (latest, following, shares), recording.stage) for track in tracks.values()],
        "notes": _changes(tables.look(frame.notes) for frame in shown),
        "captions": _changes(frame.caption for frame in shown),
        "scores": _changes(_rounded(frame.score) for frame in shown),
        "bands": _changes(frame.band for frame in shown),
        "details": _changes([tables.said(words) for words in frame.details] for frame in shown),
        "choices": [
            _choice(choice, tables, recording) | _why(choice.why, tables, places)
            for choice in recording.choices
        ],
        "before": _rounded(recording.before),
        "reward": _rounded(recording.reward),
        "end": recording.end,
    }


def _tracks(frames: Sequence[Frame], tables: Tables) -> dict[str, tuple[NDArray[np.float64], str]]:
    """Return for each key of a thing (n_frames, 4) looks, x, y and angles, and the color of its trail."""
    tracks: dict[str, tuple[NDArray[np.float64], str]] = {}
    for row, frame in enumerate(frames):
        for key, shapes, x, y, angle, trail in frame.things:
            if key not in tracks:
                tracks[key] = np.full((len(frames), 4), np.nan), trail
            tracks[key][0][row] = tables.look(shapes), x, y, angle
    return tracks


def _track(
    track: tuple[NDArray[np.float64], str],
    moments: tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.float64]],
    stage: Stage,
) -> dict[str, Any]:
    (table, trail), (latest, following, shares) = track, moments
    there = ~np.isnan(table[:, 0])
    if not np.isfinite(table[there]).all():
        raise InputError("an episode with places that are not finite cannot be shown")
    poses = table[:, 1:]
    poses[there, 2] = np.unwrap(poses[there, 2])
    # What is absent stays where it was last, or will be first.
    rows = np.maximum.accumulate(np.where(there, np.arange(len(table)), -1))
    rows[rows < 0] = np.argmax(there)
    begin, end = poses[rows[latest]], poses[rows[following]]
    moves = (there[latest] & there[following])[:, None] & (table[latest, 0] == table[following, 0])[:, None]
    at = np.where(moves, begin + shares[:, None] * (end - begin), begin)
    grain = (stage.view[1] - stage.view[0]) / FINE
    whole = np.rint(at / (grain, grain, 1 / TURN)).astype(np.int64)
    seen = np.where(there[latest], np.nan_to_num(table[latest, 0], nan=_ABSENT), _ABSENT).astype(np.int64)
    return {
        "looks": _changes(seen.tolist()),
        "moves": np.diff(whole, axis=0, prepend=0).ravel().tolist(),
        "trail": trail,
    }


def _changes(values: Iterable[Any]) -> list[list[Any]]:
    """Return the ticks at which something changes, each with the new value."""
    changes: list[list[Any]] = []
    for tick, value in enumerate(values):
        if not changes or changes[-1][1] != value:
            changes.append([tick, value])
    return changes


def _ticks(moments: NDArray[np.float64], recording: Recording) -> NDArray[np.int64]:
    """Return the ticks nearest to some moments."""
    since = moments - recording.frames[0].time
    return np.rint(since * recording.stage.rate).astype(np.int64)


def _choice(choice: Choice, tables: Tables, recording: Recording) -> dict[str, Any]:
    begin, end = _ticks(np.array([choice.begin, choice.end]), recording).tolist()
    known = choice.values is not None and any(math.isfinite(value) for value in choice.values)
    return {
        "from": begin,
        "until": end,
        "lasts": _rounded(choice.end - choice.begin),
        "words": tables.said(choice.words),
        "reward": _rounded(choice.reward),
        "options": [tables.said(words) for words in choice.options],
        "chosen": choice.chosen,
        "values": [_rounded(value) if math.isfinite(value) else None for value in choice.values or ()]
        if known
        else None,
    }


def _why(why: Why | None, tables: Tables, places: Mapping[str, int]) -> dict[str, Any]:
    """Return the reasons for a choice; they mark things by the places of their tracks."""
    if why is None:
        return {}
    explained = why.explanation
    reasons = []
    for number, (reason, found) in enumerate(zip(explained.reasons, why.witnesses, strict=True)):
        says, stands = map(tables.said, why.words(number))
        marks = [places[key] for _, key, _ in found if key in places]
        reasons.append({"adds": _rounded(reason.adds), "says": says, "stands": stands, "marks": marks})
    rest = [explained.n_others, _rounded(explained.rest)]
    lead = _rounded(explained.lead)
    return {"why": {"rival": tables.said(why.rival), "lead": lead, "reasons": reasons, "rest": rest}}


def _rounded(value: Any) -> Any:  # noqa: ANN401 - any plain value
    """Return a plain value with few digits, or raise `InputError` if a number is not finite."""
    if isinstance(value, tuple):
        return [_rounded(part) for part in value]
    if not isinstance(value, float):
        return value
    if not math.isfinite(value):
        raise InputError("an episode with numbers that are not finite cannot be shown")
    return float(f"{value:.{_DIGITS}g}")
