"""The two searches: what each tries, samples and leaves out, and that they find what is there."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from relforest.mappings import catalogue
from relforest.scenes import Attribute, Scenes, Schema
from relforest.trees import Leaf, Tree, TreeSettings
from relforest.trees.candidates import Arrivals, Candidate, OpenLeaf, PreparedQuestion
from relforest.trees.criterion import Target
from relforest.trees.expansions import Expansion
from relforest.trees.search import SEARCHES, Exhaustive, Round, Screened, stratified
from relforest.trees.sequences import Sequences, argument_places
from relforest.trees.settings import SearchName
from relforest.trees.structure import MAX_VARIABLES
from relforest.volumes import Aggregation, CovAggSettings, aggregate
from small_trees import NOWHERE, Place, plane, scenes_in

Booleans = NDArray[np.bool_]

LITTLE = CovAggSettings(window=4, restarts=2, sampled=2)


def arrivals_at_root(scenes: Scenes) -> Arrivals:
    sequences = Sequences.empty(len(scenes))
    return Arrivals(scenes, argument_places(scenes), catalogue(scenes.schema), sequences)


def at_root(scenes: Scenes, max_points: int = 10**6) -> tuple[list[PreparedQuestion], int]:
    settings = TreeSettings(max_points=max_points)
    leaf = Exhaustive.at(arrivals_at_root(scenes), settings, np.random.default_rng(0))
    return leaf.questions, leaf.n_left_out


# Two objects 5 apart; one object alone; one of unknown place next to one at (0, 2); nothing.
PLACES: list[list[Place]] = [[(0, 0), (3, 4)], [(1, 0)], [NOWHERE, (0, 2)], []]


def test_every_expansion_is_prepared() -> None:
    rng = np.random.default_rng(0)
    scenes = scenes_in(
        plane(), [[tuple(place) for place in rng.normal(size=(3, 2)).tolist()] for _ in range(2)]
    )
    questions, left_out = at_root(scenes)

    assert left_out == 0
    assert [question.expansion.n_new for question in questions] == [1] + [2] * 2 + [3] * 9


@pytest.mark.parametrize(
    ("max_points", "n_prepared", "n_left_out"),
    [
        # 2 scenes of 4 objects: 8 single objects, 24 pairs, 48 triples; 1, 2 and 9 expansions.
        (7, 0, 12),
        (8, 1, 11),
        (23, 1, 11),
        (24, 3, 9),
        (47, 3, 9),
        (48, 12, 0),
    ],
)
def test_expansions_with_too_many_points_are_counted(
    max_points: int, n_prepared: int, n_left_out: int
) -> None:
    rng = np.random.default_rng(0)
    scenes = scenes_in(
        plane(), [[tuple(place) for place in rng.normal(size=(4, 2)).tolist()] for _ in range(2)]
    )
    questions, left_out = at_root(scenes, max_points)

    assert (len(questions), left_out) == (n_prepared, n_left_out)


def test_arguments_do_not_multiply_points() -> None:
    # Two arguments and a third object: one sequence per scene for A, for A and B, and for C.
    rng = np.random.default_rng(0)
    schema = plane("passer", "receiver")
    places = [[tuple(place) for place in rng.normal(size=(3, 2)).tolist()] for _ in range(2)]
    questions, _ = at_root(scenes_in(schema, places, [[0, 1], [2, 0]]), 2)

    assert {question.expansion.n_new for question in questions} == {1, 2, 3}
    assert {len(question.sequences) for question in questions} == {2}


def test_questions_without_a_point_are_dropped() -> None:
    # Single objects have no distances; objects without a place nothing at all.
    questions, left_out = at_root(scenes_in(plane(), [[(0, 0)], [(1, 1)]]))
    assert [question.expansion.mapping.name for question in questions] == ["identity(location)"]
    assert left_out == 0
    assert at_root(scenes_in(plane(), [[NOWHERE], []])) == ([], 0)


def test_a_mapping_of_many_objects_needs_no_mapping_of_few() -> None:
    # No expansion binds just one variable, which once hid all the others.
    scenes = scenes_in(plane(operations=("distance",)), [[(0, 0), (3, 4)], [(1, 0), (1, 1)]])
    questions, left_out = at_root(scenes)

    assert [(question.expansion.n_new, len(question.bags.points)) for question in questions] == [(2, 4)]
    assert left_out == 0


def test_a_branch_that_binds_all_it_may_is_not_extended() -> None:
    scenes = scenes_in(plane(operations=("identity",)), PLACES)
    full = Sequences(np.arange(4), np.full((4, MAX_VARIABLES), -1))
    arrivals = Arrivals(scenes, argument_places(scenes), catalogue(scenes.schema), full)
    for search in SEARCHES.values():
        leaf = search.at(arrivals, TreeSettings(), np.random.default_rng(0))
        labels = np.array([True, False, True, False])
        presence = np.ones((1, 4), dtype=np.bool_)
        at = OpenLeaf(
            Tree.stub(scenes.schema, Leaf(0.0, 0, 0)), 0, presence, Target.binary(labels).assign(presence)
        )

        # Nothing is bound, so that there is nothing to ask without another variable either.
        assert leaf.best(Target.binary(labels), at, np.random.default_rng(0)) is None
        assert leaf.n_left_out > 0


def search(scenes: Scenes, labels: Booleans, name: SearchName, *, attempts: int = 1) -> Candidate | None:
    presence = np.ones((1, len(scenes)), dtype=np.bool_)
    root = OpenLeaf(
        Tree.stub(scenes.schema, Leaf(0.0, 0, 0)), 0, presence, Target.binary(labels).assign(presence)
    )
    rng = np.random.default_rng(0)
    leaf = SEARCHES[name].at(arrivals_at_root(scenes), TreeSettings(attempts=attempts), rng)
    return leaf.best(Target.binary(labels), root, rng)


@pytest.mark.parametrize("name", SEARCHES)
def test_the_best_candidate_of_an_obvious_concept(name: SearchName) -> None:
    rng = np.random.default_rng(0)
    far = rng.uniform(5, 9, size=(20, 2))
    far[:10] = rng.uniform(-1, 1, size=(10, 2))
    labels = np.arange(20) < 10
    scenes = scenes_in(plane(), [[tuple(place)] for place in far.tolist()])
    found = search(scenes, labels, name)

    assert found is not None
    assert found.question.expansion.mapping.name == "identity(location)"
    # 10 against 10 explained completely: 20 ln 2.
    assert found.gain == pytest.approx(20 * np.log(2))
    assert found.presence.tolist() == [labels.tolist(), (~labels).tolist(), [False] * 20]
    assert found.n_tried == 1
    again = search(scenes, labels, name, attempts=3)
    assert again is not None
    assert again.n_tried == 3


@pytest.mark.parametrize("name", SEARCHES)
def test_nothing_to_find(name: SearchName) -> None:
    scenes = scenes_in(plane(), [[(0, 0)], [(0, 0)]])

    assert search(scenes, np.array([True, False]), name) is None
    assert search(scenes, np.array([True, True]), name) is None


def test_few_scenes_suffice_to_find_the_best_question() -> None:
    # The objects' places are alike, but their distance is not.
    rng = np.random.default_rng(0)
    n = 40
    labels = np.arange(n) % 2 == 0
    first = rng.uniform(0, 9, size=(n, 2))
    places = np.stack(
        [first, first + np.where(labels[:, None], 0.5, 5.0) * rng.choice([-1, 1], (n, 2))], axis=1
    )
    scenes = scenes_in(plane(operations=("identity", "distance")), places.tolist())
    presence = np.ones((1, n), dtype=np.bool_)
    root = OpenLeaf(
        Tree.stub(scenes.schema, Leaf(0.0, 0, 0)), 0, presence, Target.binary(labels).assign(presence)
    )
    search = Screened.at(arrivals_at_root(scenes), TreeSettings(), rng)
    found = replace(search, rounds=(Round(10, 3_000, 1, LITTLE),)).best(Target.binary(labels), root, rng)

    assert found is not None
    assert found.question.expansion.mapping.name == "distance(location)"
    # All scenes were aggregated at the end, and all questions count.
    assert found.gain == pytest.approx(n * np.log(2))
    assert found.n_tried == 2 * 3


def promising(scenes: Scenes, labels: Booleans, presence: Booleans, *rounds: Round) -> list[Expansion]:
    """Which questions stay at the last leaf of a tree whose leaves have these scenes."""
    target = Target.binary(labels)
    stub = Tree.stub(scenes.schema, Leaf(0.0, 0, 0))
    at = OpenLeaf(stub, len(presence) - 1, presence, target.assign(presence))
    rng = np.random.default_rng(0)
    search = Screened.at(arrivals_at_root(scenes), TreeSettings(), rng)
    return replace(search, rounds=rounds).screened(target, at, rng)[0]


def test_what_another_leaf_explains_is_not_screened_for() -> None:
    # Weights tell 12 of 18 positive scenes, which another leaf has, places the other 6.
    rng = np.random.default_rng(0)
    n = 36
    labels = np.arange(n) < n // 2
    is_heavy, is_near = np.arange(n) < 12, (np.arange(n) >= 12) & labels
    schema = Schema([Attribute(name, 1, operations=("identity",)) for name in ("weight", "place")])
    matrix = np.column_stack(
        [
            np.where(is_heavy, 5.0, 0.0) + rng.uniform(size=n),
            np.where(is_near, 0.0, 5.0) + rng.uniform(size=n),
        ]
    )
    own = np.arange(n)
    scenes = Scenes(schema, matrix, own, own, np.ones(n, dtype=np.int64), np.empty((n, 0), dtype=np.int64))
    everywhere = np.ones(n, dtype=np.bool_)
    only = Round(n, 100, 1, LITTLE)

    def best(presence: Booleans) -> list[str]:
        return [expansion.mapping.name for expansion in promising(scenes, labels, presence, only)]

    assert best(everywhere[np.newaxis]) == ["identity(weight)"]
    assert best(np.stack([is_heavy, everywhere])) == ["identity(place)"]


def test_rounds_keep_fewer_and_fewer() -> None:
    rng = np.random.default_rng(0)
    n = 12
    scenes = scenes_in(plane(), rng.uniform(size=(n, 3, 2)).tolist())
    labels, presence = np.arange(n) % 2 == 0, np.ones((1, n), dtype=np.bool_)
    # Twelve questions. A first round that would keep all of them is left out.
    for first, last, n_kept in [(5, 2, 2), (12, 3, 3), (1, 3, 1)]:
        rounds = (Round(8, 100, first, LITTLE), Round(12, 100, last, LITTLE))
        assert len(promising(scenes, labels, presence, *rounds)) == n_kept


def test_questions_with_the_same_points_are_screened_once() -> None:
    # Where both of two objects are bound, either may be asked for.
    scenes = scenes_in(
        plane(operations=("identity",)), np.random.default_rng(0).uniform(size=(8, 2, 2)).tolist()
    )
    labels, presence = np.arange(8) % 2 == 0, np.ones((1, 8), dtype=np.bool_)
    pairs = arrivals_at_root(scenes).drawn(2, 100, np.random.default_rng(0))[2]
    arrivals = Arrivals(scenes, argument_places(scenes), catalogue(scenes.schema), pairs)
    target = Target.binary(labels)
    at = OpenLeaf(Tree.stub(scenes.schema, Leaf(0.0, 0, 0)), 0, presence, target.assign(presence))
    rng = np.random.default_rng(0)
    leaf = Screened.at(arrivals, TreeSettings(), rng)
    kept, n_questions = leaf.screened(target, at, rng)

    assert [expansion.variables for expansion in kept] == [(0,)]
    # But both are counted.
    assert n_questions == 2


def test_questions_that_exchange_new_objects_are_screened_once() -> None:
    rng = np.random.default_rng(0)
    n = 8
    scenes = scenes_in(plane(operations=("reframe",)), rng.uniform(size=(n, 3, 2)).tolist())
    labels, presence = np.arange(n) % 2 == 0, np.ones((1, n), dtype=np.bool_)
    target = Target.binary(labels)
    at = OpenLeaf(Tree.stub(scenes.schema, Leaf(0.0, 0, 0)), 0, presence, target.assign(presence))
    leaf = Screened.at(arrivals_at_root(scenes), TreeSettings(), rng)
    kept, n_questions = leaf.screened(target, at, rng)

    # The six orders of three new objects ask the same, but all are counted.
    assert [expansion.variables for expansion in kept] == [(0, 1, 2)]
    assert n_questions == 6


def test_a_hopeless_leaf_costs_one_try_for_each_promising_question(monkeypatch: pytest.MonkeyPatch) -> None:
    rng = np.random.default_rng(0)
    n, n_aggregated = 20, 0
    places = rng.uniform(0, 9, size=(n, 3, 2))
    scenes = scenes_in(
        plane(operations=("identity", "difference", "reframe", "scaled_reframe")), places.tolist()
    )

    def counted(*args: Any, **options: Any) -> Aggregation | None:
        nonlocal n_aggregated
        n_aggregated += 1
        return aggregate(*args, **options)

    monkeypatch.setattr("relforest.trees.search.aggregate", counted)
    gap = np.linalg.norm(places[:, 0] - places[:, 1], axis=1)
    # Four questions differ; all are tried thrice, and the best twice more. A single positive scene can add no
    # more than 4 to the likelihood, whose p-value is .24.
    for labels, n_tries in [(gap < np.median(gap), 4 * 3 + 2), (np.arange(n) == 0, 4)]:
        n_aggregated = 0
        assert search(scenes, labels, "screened", attempts=3) is not None
        assert n_aggregated == n_tries


def test_too_many_sequences_are_sampled_or_left_out() -> None:
    rng = np.random.default_rng(0)
    n = 10
    labels = np.arange(n) % 2 == 0
    places = rng.uniform(0, 9, size=(n, 6, 2))
    places[labels, 1] = places[labels, 0] + 0.2
    scenes = scenes_in(plane(operations=("distance",)), places.tolist())
    # 10 scenes of 30 pairs.
    for max_points, counts in [(300, [0, 0]), (299, [1, 0]), (3, [1, 0]), (2, [0, 1])]:
        settings = TreeSettings(max_points=max_points)
        leaf = Screened.at(arrivals_at_root(scenes), settings, rng)
        assert [leaf.n_sampled, leaf.n_left_out] == counts

    presence = np.ones((1, n), dtype=np.bool_)
    root = OpenLeaf(
        Tree.stub(scenes.schema, Leaf(0.0, 0, 0)), 0, presence, Target.binary(labels).assign(presence)
    )
    leaf = Screened.at(arrivals_at_root(scenes), TreeSettings(max_points=200), rng)
    found = leaf.best(Target.binary(labels), root, rng)
    assert found is not None
    # The sample has 20 of 30 pairs of each scene, but who arrives where is exact.
    assert len(found.question.sequences) == 200
    complete = PreparedQuestion(
        scenes, found.question.expansion, arrivals_at_root(scenes).drawn(2, 10**6, rng)[2]
    )
    np.testing.assert_array_equal(found.presence, complete.presence(found.volume))


def test_sizes_by_hand() -> None:
    # Two arguments, then 3 * 2 objects in the first scene, one in the second, none in the third.
    places: list[list[Place]] = [[(0, float(i)) for i in range(n)] for n in (5, 3, 2)]
    scenes = scenes_in(plane("passer", "receiver"), places, [[0, 1]] * 3)
    arrivals = arrivals_at_root(scenes)

    assert [arrivals.size(n) for n in range(5)] == [3, 3, 3, 3 + 1 + 1, 6 + 1 + 1]
    assert arrivals.only(np.array([0, 2])).size(4) == 6 + 1
    assert arrivals.size(MAX_VARIABLES + 1) == np.inf


def test_scenes_are_drawn_by_label() -> None:
    strata = (np.arange(100) < 90).astype(np.int64)
    drawn = stratified(np.arange(0, 100, 2), strata, 10, np.random.default_rng(0))

    assert (np.diff(drawn) > 0).all()
    assert (drawn % 2 == 0).all()
    # All five of the rare stratum, and of two as many as possible.
    assert np.bincount(strata[drawn]).tolist() == [5, 5]
    assert np.bincount(
        strata[stratified(np.arange(88, 99), strata, 10, np.random.default_rng(0))]
    ).tolist() == [8, 2]
    assert len(stratified(np.arange(85, 91), strata, 1, np.random.default_rng(0))) == 2
    assert stratified(np.arange(5), strata, 5, np.random.default_rng(0)).tolist() == [0, 1, 2, 3, 4]
