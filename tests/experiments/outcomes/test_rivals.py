from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from relforest.experiments.outcomes.rivals import padded, pooled
from relforest.experiments.outcomes.run import measures
from relforest.experiments.outcomes.scenes import Labelled, write_labelled
from relforest.models import read_training_data
from relforest.scenes import Attribute, Scenes, Schema

SCHEMA = Schema([Attribute("weight", operations=["identity", "difference"])], ["A"])
SCENES = Scenes.from_dicts(
    [
        {
            "objects": [{"id": 1, "weight": 2.0}, {"id": 2, "weight": 10.0}, {"id": 3, "weight": 5.0}],
            "arguments": {"A": 2},
        },
        {"objects": [{"id": 4, "weight": 1.0}], "arguments": {"A": 4}},
    ],
    schema=SCHEMA,
)


def test_values_are_pooled_over_objects() -> None:
    # Objects, weight of A; least, largest and mean of the weights of the others, then of their differences.
    expected = [[3, 10, 2, 5, 3.5, -8, -5, -6.5], [1, 1, *[np.nan] * 6]]

    assert np.array_equal(pooled(SCENES), expected, equal_nan=True)


def test_arguments_come_first_in_padded_vectors() -> None:
    assert padded(SCENES)[:, :4].tolist() == [[10, 2, 5, 0], [1, 0, 0, 0]]


def test_what_the_threshold_loses_is_told_from_what_the_ranking_loses() -> None:
    labels = np.array([False, False, True, True])
    found = measures(labels, np.array([0.1, 0.2, 0.3, 0.4]))

    assert (found["pss"], found["best"], found["auc"]) == (0.0, 1.0, 1.0)
    # Half of the scenes are said to be positive: deviation of the score sqrt(.5 * .5 * (1/2 + 1/2)).
    found = measures(labels, np.array([-1.0, -1.0, 1.0, 1.0]))
    assert found["log10 p"] == pytest.approx(np.log10(0.02275), abs=1e-3)


def test_published_scenes_can_be_learned_from(tmp_path: Path) -> None:
    path = tmp_path / "scenes" / "some.parquet"
    write_labelled(path, Labelled(SCENES, np.array([True, False])))
    data = read_training_data(path, "succeeds")

    assert data.scenes.schema == SCHEMA
    assert data.y.tolist() == [1, 0]
