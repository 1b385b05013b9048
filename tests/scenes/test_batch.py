from __future__ import annotations

import copy
import pickle
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from sklearn.base import BaseEstimator, ClassifierMixin, clone
from sklearn.model_selection import GridSearchCV, cross_val_score, train_test_split
from sklearn.utils import _safe_indexing

from relforest.scenes import Attribute, Scenes, Schema, extent_ratio
from relforest.support.errors import InputError
from strategies import assert_same_scenes, scenes_batches

PLANE = Schema([Attribute("location", 2), Attribute("orientation")], ["passer"])
FIELDS = ("schema", "matrix", "rows", "starts", "counts", "arguments", "scene_ids", "object_ids")


def three_scenes() -> Scenes:
    """Objects 0 to 3 on a diagonal; scenes {0, 1, 2}, {} and {2, 3}, so that object 2 is shared."""
    matrix = np.array([[0.0, 0.0, 0.0], [1.0, 1.0, 0.1], [2.0, 2.0, 0.2], [3.0, 3.0, 0.3]])
    return Scenes(
        PLANE,
        matrix,
        rows=np.array([0, 1, 2, 2, 3]),
        starts=np.array([0, 3, 3]),
        counts=np.array([3, 0, 2]),
        arguments=np.array([[1], [-1], [2]]),
        scene_ids=np.array([10, 20, 30]),
        object_ids=np.array(["a", "b", "c", "d"], dtype=object),
    )


def test_scenes_know_their_objects() -> None:
    scenes = three_scenes()

    assert len(scenes) == 3
    assert scenes.shape == (3,)
    assert [scenes.objects(position).tolist() for position in (0, 1, -1)] == [[0, 1, 2], [], [2, 3]]
    assert scenes.values["location"].shape == (4, 2)
    assert scenes.values["orientation"][:, 0].tolist() == [0.0, 0.1, 0.2, 0.3]


def test_values_are_views_and_nothing_can_be_changed() -> None:
    scenes = three_scenes()

    assert np.shares_memory(scenes.values["location"], scenes.matrix)
    for array in [*scenes.parts[1:], *scenes.values.values(), *scenes.take([0]).parts[1:]]:
        assert not array.flags.writeable
    with pytest.raises(AttributeError):
        scenes.matrix = np.zeros((4, 3))  # type: ignore[misc]


def test_the_constructor_leaves_the_arrays_it_is_given_alone() -> None:
    matrix = np.array([[4.0]])
    scenes = Scenes(Schema([Attribute("orientation")]), matrix, *map(np.array, ([0], [0], [1])))

    assert matrix.flags.writeable
    assert matrix.tolist() == [[4.0]]
    np.testing.assert_allclose(scenes.matrix, [[4.0 - 2 * np.pi]])


def test_ids_and_arguments_have_defaults() -> None:
    scenes = Scenes(Schema([Attribute("x")]), np.zeros((2, 1)), *map(np.array, ([0, 1], [0, 1], [1, 1])))

    assert scenes.scene_ids.tolist() == [0, 1]
    assert scenes.object_ids.tolist() == [0, 1]
    assert scenes.arguments.shape == (2, 0)


def test_there_may_be_no_scenes_at_all() -> None:
    none = np.empty(0, dtype=np.int64)
    scenes = Scenes(Schema([Attribute("x")]), np.empty((0, 1)), none, none, none)

    assert len(scenes) == 0
    assert repr(scenes) == "Scenes(0 scenes, no objects; attributes x (1))"
    assert len(scenes.compact()) == 0
    assert list(scenes) == []


def test_repr_is_one_informative_line() -> None:
    scenes = three_scenes()

    assert repr(scenes) == (
        "Scenes(3 scenes, 0 to 3 objects each; attributes location (2), orientation (angle); arguments "
        "passer)"
    )
    assert repr(scenes[2]).startswith("Scenes(1 scene, 2 objects;")


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (
            {"matrix": np.zeros((4, 2))},
            r"shape \(n_rows, 3\), the columns of location, orientation, got \(4, 2\)",
        ),
        ({"matrix": np.zeros(12)}, r"matrix must have shape \(n_rows, 3\)"),
        ({"matrix": np.full((4, 3), "x")}, "matrix of scenes must contain numbers"),
        ({"matrix": np.full((4, 3), -np.inf)}, r"object 'a' \(row 0\) has an infinite location"),
        ({"rows": np.array([0, 1, 2, 2, 4])}, "rows must be row numbers of the matrix, 0 to 3"),
        ({"rows": np.array([-1, 1, 2, 2, 3])}, "rows must be row numbers"),
        ({"rows": np.array([0.0, 1, 2, 2, 3])}, "rows must be integers, got float64"),
        ({"rows": np.zeros((1, 5), int)}, r"rows must have 1 dimension, got the shape \(1, 5\)"),
        ({"starts": np.array([0, 3])}, "one entry per scene, got 2 and 3"),
        ({"starts": np.array([0, 3, 4])}, "must lie inside the 5 entries of rows"),
        ({"starts": np.array([0, 3, -1])}, "must lie inside"),
        ({"counts": np.array([3, -1, 2])}, "must lie inside"),
        ({"counts": np.array([2**63 - 1, 0, 2])}, "must lie inside"),
        ({"arguments": np.array([1, -1, 2])}, r"arguments must have 2 dimensions, got the shape \(3,\)"),
        ({"arguments": None}, r"arguments must have shape \(3, 1\).* got \(3, 0\)"),
        ({"arguments": np.array([[1], [-2], [2]])}, "0 to 3, or -1 for none"),
        ({"arguments": np.array([[1], [4], [2]])}, "0 to 3, or -1 for none"),
        ({"rows": np.array([0, 1, 0, 2, 3])}, "scene 0 contains object row 0 twice"),
        ({"arguments": np.array([[3], [-1], [2]])}, "scene 0 contains object row 3 twice, or binds it to an"),
        ({"scene_ids": np.arange(2)}, "scene_ids must have one entry per scene, 3, got 2"),
        ({"object_ids": np.arange(3)}, "object_ids must have one entry per row of the matrix, got 3"),
        ({"object_ids": np.zeros(4)}, "object_ids must be integers or strings, got float64"),
    ],
)
def test_arrays_that_do_not_fit_are_refused(change: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        Scenes(**({name: getattr(three_scenes(), name) for name in FIELDS} | change))


def test_take_keeps_the_order_asked_for_and_shares_the_objects() -> None:
    scenes = three_scenes()
    taken = scenes.take([2, 0, 2])

    assert taken.scene_ids.tolist() == [30, 10, 30]
    assert [taken.objects(position).tolist() for position in range(3)] == [[2, 3], [0, 1, 2], [2, 3]]
    assert taken.arguments.tolist() == [[2], [1], [2]]
    assert np.shares_memory(taken.matrix, scenes.matrix)
    assert len(scenes.take([])) == 0


def test_indexing_follows_numpy() -> None:
    scenes = three_scenes()

    def ids(chosen: Scenes) -> list[int]:
        result: list[int] = chosen.scene_ids.tolist()
        return result

    assert ids(scenes[1]) == [20]
    assert ids(scenes[-1]) == [30]
    assert ids(scenes[np.int64(0)]) == [10]
    assert ids(scenes[::-1]) == [30, 20, 10]
    assert ids(scenes[1:]) == [20, 30]
    assert ids(scenes[[0, -1]]) == [10, 30]
    assert ids(scenes[[True, False, True]]) == [10, 30]
    assert [ids(each) for each in scenes] == [[10], [20], [30]]


@pytest.mark.parametrize("key", [3, -4, [0, 3], [True, False], [0.5], [[0]], "a"])
def test_positions_that_do_not_exist_are_index_errors(key: Any) -> None:
    with pytest.raises(IndexError, match="scene"):
        three_scenes()[key]


@given(scenes=scenes_batches(max_relations=2), data=st.data())
def test_taking_twice_is_taking_what_was_taken(scenes: Scenes, data: st.DataObject) -> None:
    positions = st.lists(st.integers(0, len(scenes) - 1), min_size=1, max_size=6)
    first = np.array(data.draw(positions))
    second = np.array(data.draw(st.lists(st.integers(0, len(first) - 1), max_size=6)), dtype=np.int64)

    assert_same_scenes(scenes.take(first).take(second), scenes.take(first[second]))


@given(scenes=scenes_batches(max_relations=2))
def test_compact_changes_no_scene_and_keeps_only_rows_in_use(scenes: Scenes) -> None:
    compact = scenes.compact()

    assert_same_scenes(compact, scenes, same_rows=False)
    assert sorted(set(compact.rows.tolist())) == list(range(len(compact.matrix)))
    assert len(compact.matrix) == len(set(scenes.rows.tolist()))


@given(scenes=scenes_batches(max_relations=2))
def test_copies_are_equal_and_read_only(scenes: Scenes) -> None:
    pickled = pickle.loads(pickle.dumps(scenes))  # noqa: S301 - our own bytes, as joblib sends them
    for other in (pickled, copy.deepcopy(scenes), clone(scenes, safe=False)):
        assert_same_scenes(other, scenes)
        assert not other.matrix.flags.writeable


def test_scenes_do_not_become_an_array_by_accident() -> None:
    with pytest.raises(TypeError, match=r"use scenes\.matrix"):
        np.asarray(three_scenes())


def test_scikit_learn_indexes_scenes_like_samples() -> None:
    scenes = three_scenes()

    for key in ([0, 2], np.array([0, 2]), slice(0, 3, 2), np.array([True, False, True]), [True, False, True]):
        assert _safe_indexing(scenes, key).scene_ids.tolist() == [10, 30]
    train, test, y_train, y_test = train_test_split(scenes, scenes.scene_ids, random_state=0)
    assert train.scene_ids.tolist() == y_train.tolist()
    assert test.scene_ids.tolist() == y_test.tolist()


class CountingClassifier(ClassifierMixin, BaseEstimator):  # type: ignore[misc] # scikit-learn ships no types
    """Predicts that a scene is positive if it has more than ``threshold`` objects."""

    def __init__(self, threshold: int = 0) -> None:
        self.threshold = threshold

    def fit(self, X: Scenes, y: Any) -> CountingClassifier:
        assert len(X) == len(y)
        self.classes_ = np.array([0, 1])
        return self

    def predict(self, X: Scenes) -> Any:
        return (X.counts > self.threshold).astype(int)


def test_cross_validation_and_grid_search_work_on_scenes() -> None:
    counts = np.array([1, 3] * 10)
    ends = np.cumsum(counts)
    matrix, rows = np.zeros((ends[-1], 1)), np.arange(ends[-1])
    scenes = Scenes(Schema([Attribute("x")]), matrix, rows, ends - counts, counts)
    labels = (counts > 2).astype(int)

    assert cross_val_score(CountingClassifier(2), scenes, labels, cv=5).tolist() == [1.0] * 5
    assert cross_val_score(CountingClassifier(0), scenes, labels, cv=5).tolist() == [0.5] * 5
    search = GridSearchCV(CountingClassifier(), {"threshold": [0, 2, 5]}, cv=2).fit(scenes, labels)
    assert search.best_params_ == {"threshold": 2}


def test_a_derived_attribute_stands_after_the_others() -> None:
    derived = three_scenes().derive("radius", lambda xy: np.hypot(xy[:, 0], xy[:, 1]), of="location")

    assert derived.schema.names == ("location", "orientation", "radius")
    assert derived.schema.parameters == ("passer",)
    np.testing.assert_allclose(derived.values["radius"][:, 0], np.sqrt(2) * np.arange(4))
    np.testing.assert_array_equal(derived.rows, three_scenes().rows)


def test_extent_ratio_is_the_second_extent_over_the_first() -> None:
    schema = Schema([Attribute("extent", 2)])
    extents = np.array([[4.0, 1.0], [2.0, 2.0], [0.0, 1.0], [np.nan, 1.0]])
    scenes = Scenes(schema, extents, np.arange(4), np.array([0]), np.array([4]))
    derived = scenes.derive("extent_ratio", extent_ratio, of="extent")

    assert derived.schema["extent_ratio"].operations == ("identity",)
    np.testing.assert_array_equal(derived.values["extent_ratio"][:, 0], [0.25, 1.0, np.nan, np.nan])


def test_a_derived_attribute_may_use_several_and_may_be_an_angle() -> None:
    derived = three_scenes().derive(
        Attribute("heading", kind="angle"),
        lambda xy, theta: xy[:, :1] + theta + 6.0,
        of=["location", "orientation"],
    )

    # 0 + 0 + 6 = 6 rad is 6 - 2 pi
    np.testing.assert_allclose(derived.values["heading"][0], [6.0 - 2 * np.pi])


@pytest.mark.parametrize(
    ("name", "function", "of", "message"),
    [
        ("location", lambda xy: xy, "location", "already have an attribute 'location'"),
        ("new", lambda xy: xy, "place", "no attribute 'place'"),
        ("new", lambda: 3, [], "name at least one"),
        ("new", lambda xy: xy[:2], "location", r"shape \(4,\) or \(4, dim\), got \(2, 2\)"),
        ("new", lambda xy: xy[0, 0], "location", r"got \(\)"),
        ("new", lambda xy: ["a"] * len(xy), "location", "'new' must return numbers"),
        ("new", lambda xy: xy[:, 0] + np.inf, "location", "infinite new"),
        (Attribute("new", 3), lambda xy: xy, "location", "returned 2 columns, but its dim is 3"),
        ("new", lambda xy: xy[:, :0], "location", "returned 0 columns"),
    ],
)
def test_functions_that_do_not_derive_an_attribute_are_refused(
    name: Any, function: Any, of: Any, message: str
) -> None:
    with pytest.raises(InputError, match=message):
        three_scenes().derive(name, function, of=of)


def test_extent_ratio_needs_two_extents() -> None:
    with pytest.raises(InputError, match=r"shape \(n, 2\), got \(1, 3\)"):
        extent_ratio(np.zeros((1, 3)))
