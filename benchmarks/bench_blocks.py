"""Blocks: CPU time of an episode of five actions, and how much of it is the physics engine's own."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass

import Box2D
import numpy as np
from gymnasium.utils.seeding import np_random
from peers import blocks as twin
from table import Cell, Table

from relforest.worlds.blocks.command import Command, run_command
from relforest.worlds.blocks.env import BlocksEnv, arch_env, color_grouping_env, high_towers_env
from relforest.worlds.blocks.handling import Handling
from relforest.worlds.blocks.policies import make_policy
from relforest.worlds.blocks.simulation import BlocksSimulation

CASES: tuple[tuple[str, Callable[[], BlocksEnv], str], ...] = (
    ("high towers", high_towers_env, "random"),
    ("high towers", high_towers_env, "large-first"),
    ("color grouping", color_grouping_env, "manual"),
    ("arch", arch_env, "careful"),
)
EPISODES = 40
REPEATS = 3
CALIBRATION = 100_000

HANDLING = Handling()


@dataclass
class StepClock:
    """Time spent inside steps of Box2D."""

    nanoseconds: int = 0
    steps: int = 0


@dataclass(frozen=True)
class Speed:
    """CPU time of an episode, its steps, and the share of the time that is spent inside them."""

    milliseconds: float
    steps: float
    share: float


@contextmanager
def timed_steps() -> Iterator[StepClock]:
    """Time every step that Box2D takes inside the ``with`` block, in worlds that are made inside it."""
    # The class holds a wrapper that binds the world, not the function itself.
    clock, original = StepClock(), vars(Box2D.b2World)["Step"]
    Box2D.b2World.Step = on_the_clock(clock, Box2D.b2World.Step)
    try:
        yield clock
    finally:
        Box2D.b2World.Step = original


def on_the_clock(clock: StepClock, step: Callable[..., None]) -> Callable[..., None]:
    """Return a step that is timed."""
    now = time.perf_counter_ns

    def timed(world: object, dt: float, velocity_iterations: int, position_iterations: int) -> None:
        begin = now()
        step(world, dt, velocity_iterations, position_iterations)
        clock.nanoseconds += now() - begin
        clock.steps += 1

    return timed


def cost_of_timing() -> tuple[float, float]:
    """Return the nanoseconds that timing adds to a step: to what the clock shows, and in all."""

    def nothing(*_: object) -> None:
        pass

    def nanoseconds(function: Callable[..., None]) -> float:
        begin = time.perf_counter_ns()
        for _ in range(CALIBRATION):
            function(None, 0.0, 0, 0)
        return (time.perf_counter_ns() - begin) / CALIBRATION

    shown = []
    for _ in range(REPEATS):
        pairs = [time.perf_counter_ns() - time.perf_counter_ns() for _ in range(CALIBRATION)]
        shown.append(-float(np.mean(pairs)))
    timed = on_the_clock(StepClock(), nothing)
    whole = min(nanoseconds(timed) for _ in range(REPEATS)) - min(
        nanoseconds(nothing) for _ in range(REPEATS)
    )
    return min(shown), whole


def play(env: BlocksEnv, policy_name: str, seed: int) -> tuple[Command, ...]:
    """Play an episode, and return the commands that were given."""
    rng, policy = np.random.default_rng(seed), make_policy(policy_name, env)
    env.reset(seed=seed)
    commands, is_over = [], False
    while not is_over:
        decision = env.decision()
        position = policy.choose(decision, rng)
        commands.append(env.command(position))
        _, _, terminated, truncated, _ = env.step(decision.indices[position])
        is_over = terminated or truncated
    return tuple(commands)


def replay(env: BlocksEnv, commands: Sequence[Command], seed: int) -> None:
    """Give the same commands again, without environment and policy: what is left is the physics."""
    rng, _ = np_random(seed)
    sim = BlocksSimulation(rng)
    sim.drop(env.task.blocks(rng, env.n_blocks, sim.next_id), turned=env.task.turned)
    for command in commands:
        run_command(sim, command, HANDLING)


def speed(work: Callable[[int], object]) -> Speed:
    """Measure ``work(seed)`` over a number of episodes; the CPU time is that of the fastest repeat."""
    spent = []
    work(0)
    for _ in range(REPEATS):
        begin = time.process_time()
        for seed in range(EPISODES):
            work(seed)
        spent.append(time.process_time() - begin)
    shown, whole = cost_of_timing()
    with timed_steps() as clock:
        begin_nanoseconds = time.perf_counter_ns()
        for seed in range(EPISODES):
            work(seed)
        elapsed = time.perf_counter_ns() - begin_nanoseconds
    share = (clock.nanoseconds - clock.steps * shown) / (elapsed - clock.steps * whole)
    return Speed(1e3 * min(spent) / EPISODES, clock.steps / EPISODES, share)


def measure(task: str, make: Callable[[], BlocksEnv], policy: str) -> tuple[Cell, ...]:
    """Time episodes, their options alone, and these on the plain engine."""
    env = make()
    given = [play(env, policy, seed) for seed in range(EPISODES)]
    whole = speed(lambda seed: play(env, policy, seed))
    options = speed(lambda seed: replay(env, given[seed], seed))
    with twin.plain_engine():
        plain = speed(lambda seed: replay(env, given[seed], seed))
    own = (whole.milliseconds, whole.share, options.milliseconds, options.share)
    return (
        task,
        policy,
        round(whole.steps),
        *own,
        plain.milliseconds,
        plain.milliseconds / options.milliseconds,
    )


def run() -> Table:
    """Measure all cases."""
    return Table(
        "blocks",
        "Aim: at least 0.7 of the time of the options inside steps of Box2D, and 1.5 times the speed of a\n"
        f"plain loop ({twin.__name__}) that asks Box2D for everything in every step. Episodes include the\n"
        "environment and the policy; options are the drop and the five actions alone.",
        (
            "task",
            "policy",
            "steps",
            "ms an episode",
            "in steps",
            "ms of options",
            "in steps",
            "ms of plain loop",
            "times faster",
        ),
        tuple(measure(*case) for case in CASES),
    )


if __name__ == "__main__":
    run().report()
