from __future__ import annotations

from dataclasses import replace

import numpy as np

from relforest.rl.policy import RandomPolicy
from relforest.rl.rollout import rollout
from relforest.rl.samples import Samples, Transitions, draw_samples
from relforest.rl.value import action_schemas
from rl.small_worlds import ACTION_TYPES, SCHEMA, Picking, two_episodes

SCHEMAS = action_schemas(SCHEMA, ACTION_TYPES)
SEED = np.random.SeedSequence(0)


def drawn(*, max_samples: int = 100, bootstrap: bool = True) -> Samples:
    return draw_samples(
        [two_episodes()],
        SCHEMAS,
        discount=0.5,
        max_samples=max_samples,
        bootstrap_on_truncation=bootstrap,
        seed=SEED,
    )


def test_every_pair_is_one_scene() -> None:
    samples = drawn()
    # Taken: pick in states 0 and 1, wait in state 3. Offered in states 1 and 4 (state 2 is terminal): wait in
    # 1, pick in 1 (the pair that is also taken there), wait and pick in 4.
    wait, pick = samples.scenes
    assert wait.matrix[np.concatenate([wait.objects(i) for i in range(3)]), 0].tolist() == [0.8, 0.4, 0.4]
    assert pick.matrix[pick.arguments[:, 0], 0].tolist() == [0.2, 0.8, 0.4]
    # wait: in 1, 3, 4; pick: the thing of 0 (candidate 1), 1 (4), 4 (9).
    transitions = samples.lspi
    assert transitions.types.tolist() == [1, 1, 0]
    assert transitions.rows.tolist() == [0, 1, 1]
    assert transitions.rewards.tolist() == [0.5, 0.0, 0.0]
    # 0.5 ** 2; terminal; 0.5 ** 1.
    assert transitions.discounts.tolist() == [0.25, 0.0, 0.5]
    assert transitions.next_starts.tolist() == [0, 2, 2, 4]
    assert transitions.next_types.tolist() == [0, 1, 0, 1]
    assert transitions.next_rows.tolist() == [0, 1, 2, 2]


def test_a_truncated_episode_may_count_as_ended() -> None:
    transitions = drawn(bootstrap=False).lspi
    assert transitions.discounts.tolist() == [0.25, 0.0, 0.0]
    assert transitions.next_starts.tolist() == [0, 2, 2, 2]


def test_what_follows_at_the_same_moment_is_not_discounted() -> None:
    at_once = replace(two_episodes(), durations=np.array([0.0, 2.0, 1.0]))
    samples = draw_samples(
        [at_once], SCHEMAS, discount=0.5, max_samples=100, bootstrap_on_truncation=True, seed=SEED
    )
    # 0.5 ** 0; terminal; 0.5 ** 1.
    assert samples.lspi.discounts.tolist() == [1.0, 0.0, 0.5]


def test_labels_come_from_the_latest_batch_and_policies_from_all() -> None:
    batches = [rollout(Picking(), RandomPolicy(), 3, np.random.SeedSequence(seed)) for seed in range(3)]
    samples = draw_samples(
        batches, SCHEMAS, discount=0.5, max_samples=1000, bootstrap_on_truncation=True, seed=SEED
    )
    assert len(samples.lspi) == sum(map(len, batches))
    assert len(samples.latest) == len(batches[-1])
    np.testing.assert_array_equal(samples.latest.rewards, batches[-1].rewards)
    np.testing.assert_array_equal(samples.latest.rewards, samples.lspi.rewards[-len(batches[-1]) :])


def test_a_limited_draw_is_without_replacement_and_keeps_the_labels() -> None:
    batches = [rollout(Picking(), RandomPolicy(), 4, np.random.SeedSequence(seed)) for seed in range(2)]
    samples = draw_samples(
        batches, SCHEMAS, discount=0.5, max_samples=7, bootstrap_on_truncation=True, seed=SEED
    )
    assert (len(samples.lspi), len(samples.latest)) == (7, len(batches[-1]))
    pairs = list(zip(samples.lspi.types.tolist(), samples.lspi.rows.tolist(), strict=True))
    assert len(set(pairs)) == 7
    used = {
        (action_type, row) for part in (samples.lspi, samples.latest) for action_type, row in _pairs(part)
    }
    # No feature is computed for a pair that nobody asks for.
    assert len(used) == sum(map(len, samples.scenes))


def _pairs(part: Transitions) -> list[tuple[int, int]]:
    types = np.concatenate([part.types, part.next_types])
    rows = np.concatenate([part.rows, part.next_rows])
    return list(zip(types.tolist(), rows.tolist(), strict=True))
