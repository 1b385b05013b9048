"""One measurement -> tidy rows: part, condition, chunk, measure, value."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from time import process_time
from typing import Final

import numpy as np
from numpy.typing import NDArray

from relforest.experiments.blocks import settings
from relforest.experiments.blocks.episodes import Measures, play, seeds_of, world
from relforest.experiments.study import Context
from relforest.experiments.table import Row
from relforest.support.progress import report
from relforest.support.rng import generator, stream
from relforest.worlds.blocks.balance import balance_trial
from relforest.worlds.blocks.blocks import Block, arch_blocks, random_blocks
from relforest.worlds.blocks.drop_on import drop_on_trial
from relforest.worlds.blocks.outcomes import random_colors
from relforest.worlds.blocks.scores import COLOR_DISTANCES
from relforest.worlds.blocks.simulation import MAX_STAGE_STEPS, BlocksSimulation

_LONGEST: Final = 5000
_LIFTED: Final = 20.0
_ALWAYS_KEPT: Final = frozenset({"total", "stands"})


def compute(setting: settings.BlocksSetting, context: Context) -> list[Row]:
    """Return a row per number measured; only those of SPEED differ from run to run.

    References
    ----------
    Palmer (2015), sections 5.3.1 and 7.4.
    """
    head: Row = {"part": setting.part, "condition": setting.condition, "chunk": setting.chunk}
    return [
        {**head, "measure": name, "value": value} for name, value in _PARTS[setting.part](setting, context)
    ]


def _settle(setting: settings.BlocksSetting, context: Context) -> Measures:
    rng = generator(context.stream)
    sim = BlocksSimulation(rng)
    is_arch = setting.condition == settings.ARCH_BLOCKS
    for number in range(setting.count):
        report("drops", number, setting.count)
        first = sim.next_id
        blocks = arch_blocks(rng, 3, first_id=first) if is_arch else random_blocks(rng, 5, first_id=first)
        steps = sim.drop(blocks, turned=is_arch)
        # An episode does not wait longer; the reference did.
        if steps >= MAX_STAGE_STEPS:
            steps += sim.wait_for_rest(_LONGEST)
        yield "steps", float(steps)
        yield "height", float(sim.poses[:, 1].mean())


def _lift(setting: settings.BlocksSetting, context: Context) -> Measures:
    sim = BlocksSimulation(generator(context.stream))
    width, height = map(float, setting.condition.split(" x "))
    sim.place([Block(0, (width, height), (0.0, 0.0, 0.0))], [(0.0, height, 0.0)])
    sim.wait_for_rest(_LONGEST)
    sim.grab(0, (0.0, 0.0))
    steps, _ = sim.carry((0.0, _LIFTED), _LONGEST)
    yield "steps", float(steps)


def _play(setting: settings.BlocksSetting, context: Context) -> Measures:
    env = world(setting.part, setting.condition)
    for episode in range(setting.count):
        report("episodes", episode, setting.count)
        for name, value in play(env, setting.condition, *seeds_of(stream(context.stream, episode))):
            if name in _ALWAYS_KEPT or (setting.part, setting.condition, name) in settings.OPTION_REFERENCE:
                yield name, value


def _colors(setting: settings.BlocksSetting, context: Context) -> Measures:
    rng = generator(context.stream)

    def draw() -> NDArray[np.float64]:
        is_uniform = setting.condition == settings.UNIFORM_RGB
        return rng.random((setting.count, 3)) if is_uniform else random_colors(rng, setting.count)

    one, other = draw(), draw()
    for name, short in (("ciede2000", "lab"), ("rgb", "rgb")):
        distance = COLOR_DISTANCES[name]
        apart = distance.difference(distance.coordinates(one), distance.coordinates(other))
        for percent in (25, 50):
            yield f"{short}_q{percent}", float(np.percentile(apart, percent))
        yield f"{short}_max", float(apart.max())
        yield f"{short}_near", float((apart <= distance.middle).mean())


def _outcomes(setting: settings.BlocksSetting, context: Context) -> Measures:
    rng, limits = generator(context.stream), settings.OUTCOME_TASKS[setting.condition]
    make_trial = balance_trial if setting.condition in settings.BALANCE_TASKS else drop_on_trial
    for number in range(setting.count):
        report("trials", number, setting.count)
        outcome = make_trial(rng, limits).outcome
        yield "decided", float(outcome is not None)
        if outcome is not None:
            yield "label", float(outcome)


def _speed(setting: settings.BlocksSetting, context: Context) -> Measures:
    env = world(settings.TOWERS, setting.condition)
    for episode in range(setting.count + 1):
        report("episodes", episode, setting.count + 1)
        begin = process_time()
        found = dict(play(env, setting.condition, *seeds_of(stream(context.stream, episode))))
        elapsed = process_time() - begin
        # The first episode pays for what is done only once.
        if episode:
            yield "milliseconds", 1000 * elapsed
            yield "steps", found["episode_steps"]


_PARTS: Final[Mapping[str, Callable[[settings.BlocksSetting, Context], Measures]]] = {
    settings.SETTLE: _settle,
    settings.LIFT: _lift,
    settings.TOWERS: _play,
    settings.GROUPS: _play,
    settings.ARCHES: _play,
    settings.COLORS: _colors,
    settings.OUTCOMES: _outcomes,
    settings.SPEED: _speed,
}
