from __future__ import annotations

import numpy as np
from numpy.testing import assert_array_equal

from relforest.scenes import Attribute, Scenes, Schema
from relforest.scenes.mixing import mixed

SCHEMA = Schema([Attribute("place"), Attribute("size")], ["mover"], relations=["touches"])


def chains() -> Scenes:
    """Return scenes of different sizes; a place tells an object, which touches the next one."""
    records = []
    for scene, n in enumerate((2, 4, 3)):
        objects = [
            {"place": [10.0 * scene + number], "size": [-10.0 * scene - number]} for number in range(n)
        ]
        touching = [(number, number + 1) for number in range(n - 1)]
        records.append(
            {"objects": objects, "arguments": {"mover": n - 1}, "relations": {"touches": touching}}
        )
    return Scenes.from_dicts(records, SCHEMA)


def test_objects_are_exchanged_whole_and_about_half_of_them_stay() -> None:
    scenes = chains()
    found = mixed(scenes, 400, np.random.default_rng(0))
    assert len(found) == 400
    assert set(found.counts.tolist()) == {2, 3, 4}
    # No attribute of an object without the others.
    assert_array_equal(found.matrix[:, 0], -found.matrix[:, 1])
    assert set(found.matrix[:, 0].tolist()) == set(scenes.matrix[:, 0].tolist())
    first = found.matrix[found.starts, 0]
    # Of those exchanged, one in three is the first of its scene too, by chance.
    assert 0.58 < (first % 10.0 == 0.0).mean() < 0.76


def test_relations_and_arguments_keep_their_places() -> None:
    found = mixed(chains(), 50, np.random.default_rng(1))
    assert_array_equal(found.arguments[:, 0], found.starts + found.counts - 1)
    expected = {
        (row, row + 1)
        for start, n in zip(found.starts, found.counts, strict=True)
        for row in range(start, start + n - 1)
    }
    expected |= {(second, first) for first, second in expected}
    assert set(map(tuple, found.relations["touches"].tolist())) == expected


def test_rows_that_scenes_share_become_separate() -> None:
    shared = Scenes(
        Schema([Attribute("place")], ["mover"]),
        np.arange(3.0)[:, None],
        rows=np.array([0, 1, 2]),
        starts=np.array([0, 1]),
        counts=np.array([2, 2]),
        arguments=np.array([[1], [-1]]),
    )
    found = mixed(shared, 20, np.random.default_rng(2))
    assert_array_equal(found.rows, np.arange(40))
    assert set((found.arguments[:, 0] - found.starts)[found.arguments[:, 0] >= 0].tolist()) == {1}
    assert (found.arguments[:, 0] < 0).any()


def test_the_same_seed_gives_the_same_scenes() -> None:
    one, two = (mixed(chains(), 10, np.random.default_rng(3)) for _ in range(2))
    assert one == two
