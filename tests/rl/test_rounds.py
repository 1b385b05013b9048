from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from interpreted import compiled_only
from relforest.rl.bellman import error_labels, look_ahead
from relforest.rl.lspi import LSPIResult, lspi
from relforest.rl.lstdq import LSTDQ
from relforest.rl.policy import RandomPolicy
from relforest.rl.rollout import rollout
from relforest.rl.rounds import improve
from relforest.rl.samples import Samples, draw_samples
from relforest.rl.selection import fit_of
from relforest.rl.settings import RPISettings
from relforest.rl.value import ValueFunction, action_schemas, forest_features
from relforest.trees import TreeSettings
from relforest.worlds.corridor.env import CorridorEnv

pytestmark = compiled_only

SEED = np.random.SeedSequence(0)
SETTINGS = RPISettings(trees_per_label=1, max_rounds=2, max_scenes=40)
NOTHING = ValueFunction.zero(CorridorEnv.schema, CorridorEnv.action_types, "densities+bits")


@pytest.fixture(scope="module")
def samples() -> Samples:
    batch = rollout(CorridorEnv(), RandomPolicy(), 10, np.random.SeedSequence(3))
    return draw_samples(
        [batch],
        action_schemas(CorridorEnv.schema, CorridorEnv.action_types),
        discount=0.9,
        max_samples=1000,
        bootstrap_on_truncation=True,
        seed=SEED,
    )


def tables_of(value: ValueFunction, samples: Samples) -> list[np.ndarray]:
    return [
        forest_features(trees, scenes, value.features)
        for trees, scenes in zip(value.forests, samples.scenes, strict=True)
    ]


def fitted_to(value: ValueFunction, samples: Samples) -> LSPIResult:
    problem = LSTDQ.of(tables_of(value, samples), samples.lspi, SETTINGS.lspi.max_condition)
    return lspi(problem, value.weights)


def as_plain(value: ValueFunction) -> tuple[object, ...]:
    return (
        [[tree.to_dict() for tree in trees] for trees in value.forests],
        [weights.tolist() for weights in value.weights],
    )


@pytest.fixture(scope="module")
def learned(samples: Samples) -> ValueFunction:
    return improve(NOTHING, samples, settings=SETTINGS, seed=SEED)


def test_at_most_one_tree_per_type_and_round(learned: ValueFunction) -> None:
    assert learned.n_trees > 0
    assert all(len(trees) <= SETTINGS.max_rounds for trees in learned.forests)
    assert not any(tree.is_stub for trees in learned.forests for tree in trees)


def test_the_weights_are_those_of_policy_iteration(learned: ValueFunction, samples: Samples) -> None:
    again = fitted_to(learned, samples)
    np.testing.assert_allclose(
        np.concatenate(again.weights), np.concatenate(learned.weights), rtol=1e-6, atol=1e-9
    )


def test_trees_reduce_the_scaled_error_of_the_fit(learned: ValueFunction, samples: Samples) -> None:
    before = fitted_to(NOTHING, samples)
    after = look_ahead(tables_of(learned, samples), learned.weights, samples.lspi)
    assert fit_of(after, 3).squared_error < fit_of(before.lookahead, 2).squared_error


def test_results_do_not_depend_on_the_number_of_workers(learned: ValueFunction, samples: Samples) -> None:
    parallel = improve(NOTHING, samples, settings=SETTINGS, seed=SEED, n_jobs=2)
    assert as_plain(parallel) == as_plain(learned)


def test_trees_are_added_to_those_that_are_there(learned: ValueFunction, samples: Samples) -> None:
    more = improve(learned, samples, settings=SETTINGS, seed=np.random.SeedSequence(1))
    for old, new in zip(learned.forests, more.forests, strict=True):
        assert new[: len(old)] == old


def test_labels_of_one_class_grow_nothing(samples: Samples) -> None:
    # Without any reward all errors are 0, so none lies above the mean.
    free = replace(
        samples,
        lspi=replace(samples.lspi, rewards=np.zeros(len(samples.lspi))),
        latest=replace(samples.latest, rewards=np.zeros(len(samples.latest))),
    )
    errors = look_ahead(tables_of(NOTHING, free), NOTHING.weights, free.latest).errors
    assert not error_labels(errors, free.latest.types).any()
    assert improve(NOTHING, free, settings=SETTINGS, seed=SEED).n_trees == 0


def test_no_significant_tree_leaves_the_representation_and_still_fits_the_policy(samples: Samples) -> None:
    strict = replace(SETTINGS, tree=TreeSettings(alpha=1e-300))
    found = improve(NOTHING, samples, settings=strict, seed=SEED)
    assert found.n_trees == 0
    fitted = fitted_to(NOTHING, samples)
    np.testing.assert_array_equal(np.concatenate(found.weights), np.concatenate(fitted.weights))


def test_a_drawn_part_without_both_labels_grows_nothing(samples: Samples) -> None:
    # Two scenes are often of the same class, and never enough for a significant question.
    assert improve(NOTHING, samples, settings=replace(SETTINGS, max_scenes=2), seed=SEED).n_trees == 0


def test_without_the_wrapper_every_round_keeps_the_most_significant_trees(samples: Samples) -> None:
    found = improve(NOTHING, samples, settings=replace(SETTINGS, wrapper=False), seed=SEED)
    # Section 7.3.2: the loop only ends at its limit.
    assert [len(trees) for trees in found.forests] == [2, 2]
