"""Makers of schemas, scenes and bags for property tests, and what it means for scenes to be the same."""

from __future__ import annotations

from itertools import permutations
from typing import Any, NamedTuple

import numpy as np
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from numpy.typing import NDArray

from relforest.scenes import Attribute, Relation, Scenes, Schema
from relforest.scenes.batch import scenes_of
from relforest.scenes.relations import with_pairs

NAMES = ("location", "orientation", "color", "extent", "weight", "x_0", "speed mps")


class BagSet(NamedTuple):
    """Labelled bags in the layout that the kernels take."""

    points: NDArray[np.float64]  # (n_points, d)
    starts: NDArray[np.int64]  # (n_bags + 1,)
    labels: NDArray[np.bool_]  # (n_bags,)


def coordinates(low: float = -100.0, high: float = 100.0) -> st.SearchStrategy[float]:
    """Finite numbers that single precision holds exactly, so that sums of squares stay tame."""
    return st.floats(low, high, width=32)


@st.composite
def schemas(
    draw: st.DrawFn, *, max_attributes: int = 3, max_parameters: int = 2, max_relations: int = 0
) -> Schema:
    """Schemas with the default operations; "orientation" is an angle."""
    names = draw(st.lists(st.sampled_from(NAMES), min_size=1, max_size=max_attributes, unique=True))
    dims = [1 if name == "orientation" else draw(st.integers(1, 3)) for name in names]
    parameters = draw(st.integers(0, max_parameters))
    directed = draw(st.lists(st.booleans(), max_size=max_relations))
    relations = map(Relation, ["touches", "is bonded to"], directed)
    return Schema(map(Attribute, names, dims), ["passer", "receiver", "third"][:parameters], relations)


@st.composite
def matrices(draw: st.DrawFn, schema: Schema, n_rows: int, *, undefined: bool = True) -> NDArray[np.float64]:
    """Attribute values of ``n_rows`` objects; some are NaN unless ``undefined`` is false."""
    cells = coordinates() | st.just(np.nan) if undefined else coordinates()
    matrix = draw(hnp.arrays(np.float64, (n_rows, schema.width), elements=cells))
    for attribute in schema.attributes:
        if attribute.kind == "angle":
            matrix[:, schema.offset(attribute.name)] /= 40.0  # at most 2.5 rad: no wrapping on the way in
    return matrix


@st.composite
def scenes_batches(
    draw: st.DrawFn,
    schema: Schema | None = None,
    *,
    max_scenes: int = 5,
    max_objects: int = 4,
    undefined: bool = True,
    shared: bool = True,
    max_relations: int = 0,
) -> Scenes:
    """Scenes of 0 to ``max_objects`` objects; with ``shared``, several scenes may contain the same rows."""
    if schema is None:
        schema = draw(schemas(max_relations=max_relations))
    sizes = st.integers(0, max_objects)
    counts = np.array(draw(st.lists(sizes, min_size=1, max_size=max_scenes)), dtype=np.int64)
    n_scenes, n_refs = len(counts), int(counts.sum())
    starts = np.cumsum(counts) - counts
    if shared and draw(st.booleans()):
        n_rows = max_objects
        chosen = [draw(st.permutations(range(n_rows)))[:count] for count in counts.tolist()]
        rows = np.array([row for scene in chosen for row in scene], dtype=np.int64)
    else:
        n_rows, rows = n_refs, np.arange(n_refs, dtype=np.int64)
    arguments = np.full((n_scenes, schema.n_parameters), -1, dtype=np.int64)
    for scene in range(n_scenes):
        members = rows[starts[scene] : starts[scene] + counts[scene]].tolist()
        for parameter in range(schema.n_parameters):
            arguments[scene, parameter] = draw(st.sampled_from([-1, *members]))
    matrix = draw(matrices(schema, n_rows, undefined=undefined))
    scene_ids, object_ids = draw(_ids("s", n_scenes)), draw(_ids("o", n_rows))
    scenes = Scenes(schema, matrix, rows, starts, counts, arguments, scene_ids, object_ids)
    return scenes_of(with_pairs(scenes.parts, draw(_pairs(scenes)))) if schema.relations else scenes


@st.composite
def _pairs(draw: st.DrawFn, scenes: Scenes) -> list[NDArray[np.int64]]:
    """Some pairs for each relation: scene and two object rows."""
    found = []
    for relation in scenes.schema.relations:
        choices = [
            (scene, one, other)
            for scene in range(len(scenes))
            for one, other in permutations(scenes.objects(scene).tolist(), 2)
            if relation.directed or one < other
        ]
        chosen = draw(st.lists(st.sampled_from(choices), unique=True, max_size=5)) if choices else []
        found.append(np.array(chosen, dtype=np.int64).reshape(-1, 3))
    return found


def _ids(prefix: str, count: int) -> st.SearchStrategy[NDArray[Any]]:
    """All integers (not simply positions), or all strings."""
    strings = np.array([f"{prefix}{number}" for number in range(count)], dtype=object)
    return st.sampled_from([np.arange(count) * 3 - 2, strings])


@st.composite
def bag_sets(
    draw: st.DrawFn, *, dim: int | None = None, min_bags: int = 2, max_bags: int = 6, max_points: int = 4
) -> BagSet:
    """Bags of 1 to ``max_points`` finite points, with at least one label of each class."""
    if dim is None:
        dim = draw(st.integers(1, 3))
    counts = draw(st.lists(st.integers(1, max_points), min_size=min_bags, max_size=max_bags))
    points = draw(hnp.arrays(np.float64, (sum(counts), dim), elements=coordinates()))
    labels = draw(hnp.arrays(np.bool_, len(counts)).filter(lambda each: 0 < each.sum() < len(each)))
    return BagSet(points, np.concatenate([[0], np.cumsum(counts)]), labels)


def assert_same_scenes(found: Scenes, expected: Scenes, *, same_rows: bool = True) -> None:
    """Check that two batches hold the same scenes; with ``same_rows``, also that they share objects alike."""
    assert found.schema == expected.schema
    assert found.scene_ids.tolist() == expected.scene_ids.tolist()
    assert found.counts.tolist() == expected.counts.tolist()
    for position in range(len(expected)):
        rows, wanted = found.objects(position), expected.objects(position)
        assert found.object_ids[rows].tolist() == expected.object_ids[wanted].tolist()
        np.testing.assert_array_equal(found.matrix[rows], expected.matrix[wanted])
        for name in expected.relations:
            assert _related(found, name, position) == _related(expected, name, position)
    is_none = expected.arguments < 0
    np.testing.assert_array_equal(found.arguments < 0, is_none)
    assert (
        found.object_ids[found.arguments[~is_none]].tolist()
        == expected.object_ids[expected.arguments[~is_none]].tolist()
    )
    if same_rows:
        for part, wanted_part in zip(found.compact().parts[1:], expected.compact().parts[1:], strict=True):
            np.testing.assert_array_equal(part, wanted_part)


def _related(scenes: Scenes, name: str, position: int) -> set[tuple[object, object]]:
    """Return the identifiers of the related objects of one scene."""
    here = set(scenes.objects(position).tolist())
    pairs = [pair for pair in scenes.relations[name].tolist() if here.issuperset(pair)]
    return {(scenes.object_ids[one], scenes.object_ids[other]) for one, other in pairs}
