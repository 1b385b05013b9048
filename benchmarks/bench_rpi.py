"""SMRF-RPI: policy iteration against LSTDQ with dense features, and where the time of an iteration goes."""

from __future__ import annotations

import time
from collections.abc import Iterator

import gymnasium
import numpy as np
from clock import median_seconds
from numpy.typing import NDArray
from table import Cell, Table

from relforest.rl.bellman import look_ahead
from relforest.rl.learner import RPILearner
from relforest.rl.lspi import LSPIResult, lspi
from relforest.rl.lstdq import LSTDQ, well_conditioned
from relforest.rl.samples import Transitions
from relforest.rl.settings import LSPISettings, RPISettings
from relforest.runs import advance
from relforest.support.parallel import one_blas_thread
from relforest.support.rng import seed_sequence

TYPES = 2
OFFERED = 3
SIZES = ((1000, 20), (5000, 40), (5000, 160))
"""Transitions, and features of each type of action."""
DISCOUNT = 0.9
REPEATS = 5
GAMES = (("corridor", "relforest/Corridor-v0", 100), ("keepaway 3v2", "relforest/Keepaway-v0", 10))
"""Name, environment, and episodes an iteration."""


def run() -> Iterator[Table]:
    """Yield both tables."""
    with one_blas_thread():
        yield policy_iteration()
        yield iterations()


def policy_iteration() -> Table:
    """Time LSPI on sparse random features, like the bits of leaves."""
    rows = tuple(_compare(n, width) for n, width in SIZES)
    columns = ("transitions", "features", "policies", "ms", "dense ms", "ratio")
    note = "LSPI by blocks of action types pays with thousands of transitions; 50 policies are evaluated."
    return Table("lspi", note, columns, rows)


def iterations() -> Table:
    """Time the first iteration of SMRF-RPI in parts."""
    rows: list[tuple[Cell, ...]] = []
    for name, world, episodes in GAMES:
        env = gymnasium.make(world, disable_env_checker=True)
        learner = RPILearner(env, RPISettings(), seed_sequence(0), episodes, episodes)
        before, _ = advance(learner, None)
        begin = time.process_time()
        after, seconds = advance(learner, before)
        spent = time.process_time() - begin
        share = seconds["testing"] / sum(seconds.values())
        rows.append((name, episodes, after.state.value.n_trees, spent, 100 * share))
    columns = ("world", "episodes", "trees", "seconds", "% testing")
    return Table(
        "rpi", "One iteration of SMRF-RPI, as many test episodes as training episodes.", columns, tuple(rows)
    )


def _compare(n: int, width: int) -> tuple[Cell, ...]:
    problems = [_problem(np.random.default_rng(seed), n, width) for seed in range(REPEATS)]
    zero = (np.zeros(width),) * TYPES
    settings = LSPISettings()

    def learned(problem: tuple[list[NDArray[np.float64]], Transitions]) -> LSPIResult:
        return lspi(LSTDQ.of(*problem, settings.max_condition), zero, settings)

    policies = [learned(problem).iterations for problem in problems]
    ours = median_seconds(learned, problems)
    theirs = median_seconds(
        lambda pair: _dense(*pair[0], zero, pair[1], settings), zip(problems, policies, strict=True)
    )
    return n, TYPES * width, float(np.median(policies)), 1e3 * ours, 1e3 * theirs, theirs / ours


def _problem(rng: np.random.Generator, n: int, width: int) -> tuple[list[NDArray[np.float64]], Transitions]:
    """Draw transitions in a row; in every state each type of action is offered `OFFERED` times."""
    tables = [(rng.random((n * OFFERED, width)) < 0.1).astype(float) for _ in range(TYPES)]
    states = np.repeat(np.arange(1, n + 1) % n, TYPES * OFFERED)
    types = np.tile(np.repeat(np.arange(TYPES), OFFERED), n)
    transitions = Transitions(
        types=rng.integers(TYPES, size=n),
        rows=np.arange(n) * OFFERED,
        rewards=rng.standard_normal(n),
        discounts=np.full(n, DISCOUNT),
        next_starts=np.arange(n + 1) * TYPES * OFFERED,
        next_types=types,
        next_rows=states * OFFERED + np.tile(np.arange(OFFERED), n * TYPES),
    )
    return tables, transitions


def _dense(
    features: list[NDArray[np.float64]],
    transitions: Transitions,
    weights: tuple[NDArray[np.float64], ...],
    policies: int,
    settings: LSPISettings,
) -> None:
    """Evaluate as many policies with one feature vector over all types of action, as in the source."""
    width, n = features[0].shape[1], len(transitions)
    now, following = np.zeros((n, TYPES * width)), np.zeros((n, TYPES * width))
    for code in range(TYPES):
        own = np.flatnonzero(transitions.types == code)
        now[own, code * width : (code + 1) * width] = features[code][transitions.rows[own]]
    for _ in range(policies):
        chosen = look_ahead(features, weights, transitions).chosen
        following[:] = 0.0
        for code in range(TYPES):
            own = np.flatnonzero(transitions.next_types[chosen] == code)
            block = features[code][transitions.next_rows[chosen[own]]]
            following[own, code * width : (code + 1) * width] = transitions.discounts[own, None] * block
        matrix = well_conditioned(now.T @ (now - following), settings.max_condition)
        solution = np.linalg.solve(matrix, now.T @ transitions.rewards)
        weights = tuple(np.split(solution, TYPES))


if __name__ == "__main__":
    for table in run():
        table.report()
