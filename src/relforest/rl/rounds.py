"""The inner loop of SMRF-RPI: rounds of representation and policy learning on a fixed set of samples.

Each round labels the latest batch by Bellman error, learns a few candidate trees per action type, tests each
of them by learning a policy with it, and adds the best one per type (Palmer (2015), Algorithm 6.1 and section
6.3).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import final

import numpy as np

from relforest.forests.tree_features import tree_features
from relforest.rl.bellman import error_labels, look_ahead
from relforest.rl.experience import BoolArray
from relforest.rl.lspi import LSPIResult, lspi
from relforest.rl.lstdq import LSTDQ
from relforest.rl.samples import Samples
from relforest.rl.selection import Fit, fit_of, select
from relforest.rl.settings import RPISettings
from relforest.rl.value import ValueFunction, forest_features
from relforest.scenes.arrays import FloatArray, IntArray
from relforest.support.parallel import run_tasks
from relforest.support.progress import part, report
from relforest.support.rng import generator, stream
from relforest.trees import Tree, query
from relforest.trees.growth import Growth, grow

_SCENES, _GROWTH = 0, 1


@final
@dataclass(frozen=True, slots=True, eq=False)
class Candidate:
    """A tree that may join the forest of an action type."""

    growth: Growth  # the tree, not a stub, and how it came about
    columns: FloatArray  # (m, k) its features of all state-action pairs of the type
    fit: Fit | None  # how well LSPI fits with the tree; None if candidates are not tested

    @property
    def tree(self) -> Tree:
        """The tree."""
        return self.growth.tree

    @property
    def significance(self) -> tuple[float, float]:
        """How significant the tree was in its own learning; smaller is better.

        The lowest p-value among its questions, and the gain in log likelihood where that vanishes.
        """
        steps = self.growth.steps
        return min(step.p_value for step in steps), -sum(step.gain for step in steps)


@final
@dataclass(frozen=True, slots=True, eq=False)
class _Round:
    """What all candidates of a round share: samples, representation so far, its policy, labels."""

    samples: Samples
    settings: RPISettings
    tables: tuple[FloatArray, ...]
    policy: LSPIResult
    labels: BoolArray


def improve(
    value: ValueFunction,
    samples: Samples,
    *,
    settings: RPISettings,
    seed: np.random.SeedSequence,
    n_jobs: int = 1,
) -> ValueFunction:
    """Run rounds until no tree is added.

    Every candidate has its own random stream, named by round, action type and attempt, so that the result
    does not depend on how many are learned at the same time.

    There is at most one tree more per action type and round, with the weights of the last policy.

    References
    ----------
    Palmer (2015), Algorithm 6.1 (the RPI loop).
    """
    report("features of the trees so far")
    tables = tuple(
        forest_features(trees, scenes, value.features)
        for trees, scenes in zip(value.forests, samples.scenes, strict=True)
    )
    # The first labels come from the values that the agent acted on; only then are they fitted to the samples.
    errors = look_ahead(tables, value.weights, samples.latest).errors
    policy = lspi(LSTDQ.of(tables, samples.lspi, settings.lspi.max_condition), value.weights, settings.lspi)
    forests = value.forests
    for number in range(settings.max_rounds):
        now = _Round(samples, settings, tables, policy, error_labels(errors, samples.latest.types))
        with part(f"round {number + 1}"):
            added = _select(now, _candidates(now, stream(seed, number), n_jobs))
        if not any(added):
            break
        forests = tuple(
            trees if new is None else (*trees, new.tree) for trees, new in zip(forests, added, strict=True)
        )
        tables = tuple(
            table if new is None else np.hstack([table, new.columns])
            for table, new in zip(tables, added, strict=True)
        )
        problem = LSTDQ.of(tables, samples.lspi, settings.lspi.max_condition)
        policy = lspi(problem, _widened(policy.weights, tables), settings.lspi)
        errors = look_ahead(tables, policy.weights, samples.latest).errors
    return replace(value, forests=forests, weights=policy.weights)


def _candidates(now: _Round, seed: np.random.SeedSequence, n_jobs: int) -> list[list[Candidate]]:
    """Learn and test the candidates of one round; those of each action type in the order of the attempts."""
    latest, n_types = now.samples.latest, len(now.tables)
    tasks = []
    for number in range(n_types):
        own = np.flatnonzero(latest.types == number)
        if now.labels[own].any():
            attempts = range(now.settings.n_candidates)
            tasks += [(now, number, own, attempt, stream(seed, number, attempt)) for attempt in attempts]
    named = [(f"tree {number} of {len(tasks)}", *task) for number, task in enumerate(tasks, 1)]
    found = run_tasks(_candidate, named, n_jobs=n_jobs, prefer="threads")
    candidates: list[list[Candidate]] = [[] for _ in range(n_types)]
    for task, candidate in zip(tasks, found, strict=True):
        if candidate is not None:
            candidates[task[1]].append(candidate)
    return candidates


def _candidate(
    name: str, now: _Round, number: int, own: IntArray, attempt: int, seed: np.random.SeedSequence
) -> Candidate | None:
    """Learn one tree on a random part of the latest batch and test it; None for a stub."""
    settings, scenes = now.settings, now.samples.scenes[number]
    count = min(settings.max_scenes, len(own))
    drawn = generator(stream(seed, _SCENES)).choice(own, count, replace=False)
    labels = now.labels[drawn] if attempt < settings.trees_per_label else ~now.labels[drawn]
    if labels.all() or not labels.any():
        return None
    with part(name):
        growth = grow(
            scenes.take(now.samples.latest.rows[drawn]),
            labels,
            rng=generator(stream(seed, _GROWTH)),
            settings=settings.tree,
        )
        if growth.tree.is_stub:
            return None
        report("testing the tree")
        columns = tree_features(growth.tree, query(growth.tree, scenes), settings.features)
        return Candidate(growth, columns, _tested(now, number, columns) if settings.wrapper else None)


def _tested(now: _Round, number: int, columns: FloatArray) -> Fit:
    """Learn a policy with the columns of one more tree (the wrapper of section 6.3)."""
    start = list(now.policy.weights)
    start[number] = np.pad(start[number], (0, columns.shape[1]))
    result = lspi(now.policy.problem.extended(number, columns), start, now.settings.lspi)
    return fit_of(result.lookahead, result.n_features)


def _select(now: _Round, candidates: Sequence[Sequence[Candidate]]) -> list[Candidate | None]:
    """Choose at most one candidate per action type."""
    old = fit_of(now.policy.lookahead, now.policy.n_features)
    threshold = now.settings.alpha / now.settings.n_candidates
    chosen: list[Candidate | None] = []
    for own in candidates:
        if not now.settings.wrapper:
            chosen.append(min(own, key=lambda candidate: candidate.significance, default=None))
            continue
        position = select(old, [candidate.fit for candidate in own if candidate.fit is not None], threshold)
        chosen.append(None if position is None else own[position])
    return chosen


def _widened(weights: Sequence[FloatArray], tables: Sequence[FloatArray]) -> tuple[FloatArray, ...]:
    """Append a weight of 0 for every new column."""
    return tuple(np.pad(w, (0, table.shape[1] - len(w))) for w, table in zip(weights, tables, strict=True))
