from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from interpreted import compiled_only
from relforest.mappings import catalogue
from relforest.trees import Leaf, Tree, TreeSettings
from relforest.trees.candidates import Arrivals, Candidate, OpenLeaf
from relforest.trees.criterion import Target
from relforest.trees.permutation import _shuffled, permutation_p
from relforest.trees.search import SEARCHES, LeafSearch
from relforest.trees.sequences import Sequences, argument_places
from small_trees import plane, scenes_in

pytestmark = compiled_only

Booleans = NDArray[np.bool_]

N = 24
RNG_SEED = 3


SETTINGS = TreeSettings(attempts=1, search="exhaustive")


def problem() -> tuple[LeafSearch, Booleans, Candidate]:
    """Half of the scenes hold an object near the origin; the best question finds it."""
    rng = np.random.default_rng(0)
    places = rng.uniform(3, 9, size=(N, 2, 2))
    places[: N // 2, 0] = rng.uniform(-1, 1, size=(N // 2, 2))
    scenes = scenes_in(plane(operations=("identity",)), places.tolist())
    labels = np.arange(N) < N // 2
    arrivals = Arrivals(scenes, argument_places(scenes), catalogue(scenes.schema), Sequences.empty(N))
    search = SEARCHES[SETTINGS.search].at(arrivals, SETTINGS, np.random.default_rng(0))
    found = search.best(Target.binary(labels), root(labels), np.random.default_rng(RNG_SEED))
    assert found is not None
    return search, labels, found


def root(labels: Booleans) -> OpenLeaf:
    presence = np.ones((1, N), dtype=np.bool_)
    stub = Tree.stub(plane(operations=("identity",)), Leaf(0.0, 0, 0))
    return OpenLeaf(stub, 0, presence, Target.binary(labels).assign(presence))


def p_value(found: Candidate, *, permutations: int = 39, alpha: float = 0.05) -> float:
    search, labels, _ = problem()
    settings = replace(SETTINGS, alpha=alpha, permutations=permutations)
    return permutation_p(
        found, search, Target.binary(labels), root(labels), settings, np.random.default_rng(0)
    )


def test_what_no_shuffle_equals_has_the_smallest_p_value() -> None:
    _, _, found = problem()

    assert p_value(found) == 1 / 40
    assert p_value(found, permutations=19) == 1 / 20


@pytest.mark.parametrize(
    ("permutations", "alpha", "expected"),
    [
        # At most one of 39 shuffles may be as good: the second one ends the test.
        (39, 0.05, 3 / 40),
        # None of 19.
        (19, 0.05, 2 / 20),
        # Four of 49 (.1 * 50 - 1).
        (49, 0.1, 6 / 50),
    ],
)
def test_what_every_shuffle_beats_is_given_up_early(permutations: int, alpha: float, expected: float) -> None:
    _, _, found = problem()
    worthless = replace(found, p_value=1.0, gain=-1e9)

    assert p_value(worthless, permutations=permutations, alpha=alpha) == pytest.approx(expected)
    # Given up: not significant.
    assert expected > alpha


def test_equally_good_shuffles_count_against_it() -> None:
    # As if the observed search had found just what a certain shuffle finds.
    search, labels, found = problem()
    shuffled = labels[_shuffled(np.zeros(N, dtype=np.int64), np.random.default_rng(0))]
    null = search.best(Target.binary(shuffled), root(shuffled), np.random.default_rng(0))
    assert null is not None
    typical = replace(found, p_value=null.p_value, gain=null.gain)

    assert p_value(typical) > p_value(found)


def test_labels_are_shuffled_within_each_group() -> None:
    labels = np.array([True] * 4 + [False] * 4 + [True, False] * 4)
    groups = np.array([0] * 8 + [5] * 8)
    seen = set()
    for seed in range(20):
        shuffled = labels[_shuffled(groups, np.random.default_rng(seed))]
        assert shuffled[:8].sum() == 4
        assert shuffled[8:].sum() == 4
        seen.add(tuple(shuffled.tolist()))
    assert len(seen) > 15
