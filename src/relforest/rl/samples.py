"""The experience that each part of an iteration learns from, laid out so that scenes are queried once.

LSPI learns from up to 100 000 transitions of all batches, labels come from the latest batch (Palmer (2015),
section 7.2). Both refer to the same list of distinct state-action pairs per action type: a candidate action
of a next state is usually also the action taken there, and is one scene, not two.

Letters: n transitions, c candidate actions of their next states, m_a distinct state-action pairs of action
type a.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import final

import numpy as np

from relforest.rl.action_scenes import action_scenes
from relforest.rl.experience import BoolArray, Experience, concatenate
from relforest.scenes import Scenes, Schema
from relforest.scenes.arrays import FloatArray, IntArray
from relforest.support.rng import generator


@final
@dataclass(frozen=True, slots=True, eq=False)
class Transitions:
    """Transitions with state-action pairs identified by action type and row in the table of that type."""

    types: IntArray
    rows: IntArray
    """(n,) each: the observed pair (s, a)."""
    rewards: FloatArray  # (n,) discounted reward inside the action
    discounts: FloatArray  # (n,) ``discount ** duration``, and 0 where nothing follows
    next_starts: IntArray
    """(n + 1,): the candidates of transition i are ``next_starts[i]`` to ``next_starts[i + 1]`` (exclusive);
    there are none where the discount is 0."""
    next_types: IntArray
    next_rows: IntArray
    """(c,) each: the pairs (s', a') of those candidates."""

    def __len__(self) -> int:
        """Return the number of transitions."""
        return len(self.types)


@final
@dataclass(frozen=True, slots=True, eq=False)
class Samples:
    """The data that one iteration of SMRF-RPI learns from."""

    scenes: tuple[Scenes, ...]
    """For each action type its distinct state-action pairs (m_a scenes, arguments bound)."""
    lspi: Transitions  # transitions used to learn policies
    latest: Transitions  # all transitions of the latest batch, used for labels and trees


def draw_samples(
    batches: Sequence[Experience],
    schemas: Sequence[Schema],
    *,
    discount: float,
    max_samples: int,
    bootstrap_on_truncation: bool,
    seed: np.random.SeedSequence,
) -> Samples:
    """Choose the transitions of one iteration.

    The latest batch is the last one. For each action type, the schema has the attributes of the world and the
    parameters of the type. Transitions are drawn without replacement from all batches; see
    `relforest.rl.settings.RPISettings` for `max_samples` and `bootstrap_on_truncation`.

    References
    ----------
    Palmer (2015), section 7.2; the SMDP target of section 2.1.
    """
    pool = concatenate(batches)
    chosen = np.arange(len(pool))
    if len(pool) > max_samples:
        chosen = np.sort(generator(seed).choice(len(pool), max_samples, replace=False))
    latest = np.arange(len(pool) - len(batches[-1]), len(pool))
    ends = pool.terminal if bootstrap_on_truncation else pool.terminal | pool.truncated
    discounts = np.where(ends, 0.0, discount**pool.durations)
    needed = _needed_candidates(pool, np.union1d(chosen, latest), discounts)
    tables = [np.flatnonzero(needed & (pool.types == number)) for number in range(len(schemas))]
    row_of = np.full(len(pool.types), -1)
    for table in tables:
        row_of[table] = np.arange(len(table))
    return Samples(
        tuple(action_scenes(pool, table, schema) for table, schema in zip(tables, schemas, strict=True)),
        _transitions(pool, chosen, discounts, row_of),
        _transitions(pool, latest, discounts, row_of),
    )


def _needed_candidates(pool: Experience, chosen: IntArray, discounts: FloatArray) -> BoolArray:
    """Mark the candidates needed by the chosen transitions; (c,) bool."""
    needed = np.zeros(len(pool.types), dtype=np.bool_)
    needed[pool.actions[chosen]] = True
    needed[_following(pool, chosen[discounts[chosen] > 0.0])[1]] = True
    return needed


def _following(pool: Experience, chosen: IntArray) -> tuple[IntArray, IntArray]:
    """Return the number of candidates after each chosen transition, and all of them in order."""
    states = pool.next_states[chosen]
    starts = pool.candidates[states]
    counts = pool.candidates[states + 1] - starts
    ends = np.cumsum(counts)
    total = int(ends[-1]) if len(ends) else 0
    return counts, np.arange(total) + np.repeat(starts - (ends - counts), counts)


def _transitions(pool: Experience, chosen: IntArray, discounts: FloatArray, row_of: IntArray) -> Transitions:
    bootstrapped = discounts[chosen] > 0.0
    counts = np.zeros(len(chosen), dtype=np.int64)
    counts[bootstrapped], following = _following(pool, chosen[bootstrapped])
    actions = pool.actions[chosen]
    return Transitions(
        types=pool.types[actions],
        rows=row_of[actions],
        rewards=pool.rewards[chosen],
        discounts=discounts[chosen],
        next_starts=np.concatenate([np.zeros(1, np.int64), np.cumsum(counts)]),
        next_types=pool.types[following],
        next_rows=row_of[following],
    )
