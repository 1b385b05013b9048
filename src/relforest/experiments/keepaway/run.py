"""One measurement -> tidy rows: part, game, condition, run, measure, value."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from time import process_time
from typing import Final

import numpy as np

from relforest.experiments.keepaway.settings import (
    DURATIONS,
    LEARNING,
    PHYSICS,
    SHARED,
    SPEED,
    KeepawaySetting,
)
from relforest.experiments.keepaway.trajectories import TRAJECTORIES, recorded_step_counts
from relforest.experiments.keepaway_team import benchmark_team, play_episodes_with
from relforest.experiments.study import Context
from relforest.experiments.table import Row
from relforest.support.rng import stream
from relforest.worlds.keepaway.play.durations import Played, play_episodes
from relforest.worlds.keepaway.play.events import (
    DASHES,
    FIRST_TOUCH,
    KEEPER_CYCLES,
    KEEPER_KICKS,
    SPEED_STEP,
    TAKER_CYCLES,
    TAKER_KICKS,
    TRANSFERS,
    TURNS,
)
from relforest.worlds.keepaway.server.layout import TAKEN
from relforest.worlds.keepaway.server.options import KeepawayOptions

_QUANTILES: Final = (5, 25, 50, 75, 95)
_SPEED_QUANTILES: Final = (5, 25, 50, 75, 95, 99)
_REPEATS: Final = 3
_AGENTS: Final = 0
_GAMES: Final = 1

Measures = Iterator[tuple[str, float]]


def compute(setting: KeepawaySetting, context: Context) -> list[Row]:
    """Return a row per number measured.

    The physics are compared with the recorded steps in the folder ``RELFOREST_DATA``, if that is set.

    References
    ----------
    Stone, Kuhlmann, Taylor, and Liu (2006), "Keepaway soccer: from machine learning testbed to benchmark".
    """
    head: Row = {
        "part": setting.part,
        "game": setting.game,
        "condition": setting.condition,
        "run": setting.run,
    }
    found = list(_PARTS[setting.part](setting, context)) or [("", float("nan"))]
    return [{**head, "measure": name, "value": None if np.isnan(value) else value} for name, value in found]


def _physics(_setting: KeepawaySetting, _context: Context) -> Measures:
    folder = os.environ.get("RELFOREST_DATA")
    path = None if folder is None else Path(folder) / TRAJECTORIES
    if path is None or not path.exists():
        return
    for motion, count in recorded_step_counts(path).items():
        yield f"{motion}: steps", float(count.steps)
        yield f"{motion}: violations", float(count.violations)


def _durations(setting: KeepawaySetting, context: Context) -> Measures:
    played = play_episodes(setting.condition, _rules(setting), setting.episodes, context.stream)
    durations = played.durations
    yield "episodes", float(len(durations))
    yield "mean", float(durations.mean())
    yield "sd", float(durations.std(ddof=1))
    for percent, value in zip(_QUANTILES, np.percentile(durations, _QUANTILES), strict=True):
        yield f"q{percent}", float(value)
    yield "max", float(durations.max())
    yield "taken", float((played.ends == TAKEN).mean())
    yield from _events(played, setting)


def _events(played: Played, setting: KeepawaySetting) -> Measures:
    counts, cycles = played.events, float(played.durations.sum())
    for name, column in (
        ("transfers", TRANSFERS),
        ("keeper_kicks", KEEPER_KICKS),
        ("taker_kicks", TAKER_KICKS),
    ):
        yield name, float(counts[:, column].mean())
    yield "keeper_in_reach", counts[:, KEEPER_CYCLES].sum() / cycles
    yield "taker_in_reach", counts[:, TAKER_CYCLES].sum() / cycles
    touched = counts[counts[:, FIRST_TOUCH] >= 0, FIRST_TOUCH]
    yield "first_touch", float(touched.mean()) if len(touched) else float("nan")
    commands = cycles * (setting.keepers + setting.takers)
    yield "dashes", counts[:, DASHES].sum() / commands
    yield "turns", counts[:, TURNS].sum() / commands
    if setting.keepers == 3:
        pairs = zip(("nearest_pair", "middle_pair", "farthest_pair"), played.keeper_distances, strict=True)
        yield from ((name, float(distance)) for name, distance in pairs)
    reached = np.cumsum(played.speeds) / played.speeds.sum()
    for percent in _SPEED_QUANTILES:
        yield f"ball_q{percent}", float(np.searchsorted(reached, percent / 100) * SPEED_STEP)


def _learning(setting: KeepawaySetting, context: Context) -> Measures:
    rules = _rules(setting)
    team = benchmark_team(
        rules, shared=setting.condition == SHARED, random_state=stream(context.stream, _AGENTS)
    )
    durations = play_episodes_with(team, rules, setting.episodes, stream(context.stream, _GAMES))
    for end in range(setting.block, setting.episodes + 1, setting.block):
        yield f"{end}", float(durations[end - setting.block : end].mean())


def _speed(setting: KeepawaySetting, context: Context) -> Measures:
    play_episodes(setting.condition, _rules(setting), 1, context.stream)
    fastest = 0.0
    for repeat in range(_REPEATS):
        begin = process_time()
        played = play_episodes(
            setting.condition, _rules(setting), setting.episodes, stream(context.stream, repeat)
        )
        fastest = max(fastest, played.durations.sum() / max(process_time() - begin, 1e-9))
    yield "cycles_per_second", float(fastest)


def _rules(setting: KeepawaySetting) -> KeepawayOptions:
    return KeepawayOptions(setting.keepers, setting.takers, setting.size)


_PARTS: Final[Mapping[str, Callable[[KeepawaySetting, Context], Measures]]] = {
    PHYSICS: _physics,
    DURATIONS: _durations,
    LEARNING: _learning,
    SPEED: _speed,
}
