from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from relforest.experiments.concepts.run import SCENES, compute
from relforest.experiments.concepts.settings import ConceptSetting, Learner
from relforest.experiments.study import Context

SIZES = {"same": (5, 8), "15 objects": (15, 15), "20 more objects": (25, 28)}


@pytest.mark.parametrize("concept", SCENES)
def test_scenes_have_the_size_that_their_name_says(concept: str) -> None:
    for test, draw in SCENES[concept]:
        scenes, labels = draw(np.random.default_rng(0), 30)
        fewest, most = SIZES["20 more objects" if concept == "between-crowded" else test]
        assert scenes.counts.min() >= fewest
        assert scenes.counts.max() <= most
        assert labels.sum() == 15


def test_a_tree_that_finds_the_concept_carries_over(tmp_path: Path) -> None:
    setting = ConceptSetting("yellow", 0, 40, alpha=0.05, max_points=300)
    rows = compute(setting, Context(0, 3, tmp_path))

    assert [row["test"] for row in rows] == ["same", "15 objects"]
    assert all(float(str(row["pss"])) > 0.8 for row in rows)
    assert "there is an A with color " in str(rows[0]["words"])
    assert rows == compute(setting, Context(0, 3, tmp_path))


@pytest.mark.parametrize(("learner", "most"), [("boosting", 200), ("forest", 4000), ("rules", 2000)])
def test_forests_are_learners_too(learner: Learner, most: int, tmp_path: Path) -> None:
    rows = compute(ConceptSetting("between", 0, 100, learner=learner), Context(0, 3, tmp_path))

    assert [row["method"] for row in rows] == [learner] * 3
    assert all(float(str(row["pss"])) > 0.6 for row in rows)
    assert 2 <= int(str(rows[0]["leaves"])) <= most
    assert "the way from A" in str(rows[0]["words"]) or "the line from A" in str(rows[0]["words"])
