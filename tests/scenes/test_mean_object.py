from __future__ import annotations

import numpy as np
import pytest

from relforest.scenes import Attribute, Scenes, Schema
from relforest.scenes.mean_object import without_mean

SCHEMA = Schema(
    [
        Attribute("location", 2),
        Attribute("heading", kind="angle"),
        Attribute("team", kind="category", categories=["a"]),
    ],
    ["A"],
)
SCENES = Scenes.from_dicts(
    [
        {
            "objects": [
                {"id": 1, "location": [9.0, 9.0], "heading": 1.0, "team": "a"},
                {"id": 2, "location": [1.0, None], "heading": 3.0, "team": "a"},
                {"id": 3, "location": [3.0, 4.0], "heading": -3.0, "team": "a"},
            ],
            "arguments": {"A": 1},
        },
        {"objects": [{"id": 4, "location": [5.0, 5.0]}], "arguments": {"A": 4}},
    ],
    schema=SCHEMA,
)


def test_the_mean_object_is_the_mean_of_what_is_not_an_argument() -> None:
    found = SCENES.with_mean_object()
    means = found.matrix[found.arguments[:, -1]]

    assert found.schema.parameters == ("A", "mean object")
    assert found.counts.tolist() == [4, 2]
    assert means[0, :2].tolist() == [2.0, 4.0]
    # 3 and -3 on the circle.
    assert abs(means[0, 2]) == pytest.approx(np.pi)
    assert np.isnan(means[0, 3])
    assert np.isnan(means[1]).all()
    assert np.array_equal(found.arguments[:, 0], SCENES.arguments[:, 0])


def test_scenes_get_a_mean_object_where_a_model_has_one() -> None:
    schema = SCENES.with_mean_object().schema

    assert SCENES.recoded(schema) == SCENES.with_mean_object()
    assert SCENES.recoded(schema).recoded(schema) == SCENES.with_mean_object()
    assert (without_mean(schema), without_mean(SCHEMA)) == (SCHEMA, SCHEMA)
