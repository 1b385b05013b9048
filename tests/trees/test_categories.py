"""Questions about categories: one name at a time, or whether two objects share it."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from relforest import SMRFTreeClassifier, Tree
from relforest.mappings import Mapping
from relforest.scenes import Attribute, Scenes, Schema
from relforest.support.errors import ModelFormatError
from relforest.trees.significance import added_parameters
from relforest.volumes import aggregate
from relforest.volumes.categories import best_category

TEAM = Attribute("team", kind="category", categories=["home", "guest", "referee", "coach"])
SCHEMA = Schema([TEAM])


def teams(rng: np.random.Generator, n: int, n_objects: int = 3) -> Scenes:
    matrix = rng.integers(0, 4, (n * n_objects, 1)).astype(np.float64)
    starts = np.arange(n) * n_objects
    return Scenes(SCHEMA, matrix, np.arange(len(matrix)), starts, np.full(n, n_objects))


def has_guest(scenes: Scenes) -> NDArray[np.bool_]:
    return np.array([(scenes.matrix[scenes.objects(i), 0] == 1).any() for i in range(len(scenes))])


def has_pair(scenes: Scenes) -> NDArray[np.bool_]:
    return np.array([len(set(scenes.matrix[scenes.objects(i), 0])) < 3 for i in range(len(scenes))])


@pytest.mark.parametrize("search", ["screened", "exhaustive"])
@pytest.mark.parametrize(
    ("label", "words"),
    [
        (has_guest, "there is an A with team guest"),
        (has_pair, "there are A and B such that B has the same team as A"),
    ],
)
def test_the_category_that_matters_is_found(search: Any, label: Any, words: str) -> None:
    rng = np.random.default_rng(0)
    scenes, others = teams(rng, 60), teams(rng, 60)
    model = SMRFTreeClassifier(search=search, random_state=0).fit(scenes, label(scenes))

    assert words in str(model.tree_)
    assert (model.predict(others) == label(others)).all()
    assert Tree.from_dict(model.tree_.to_dict()).to_dict() == model.tree_.to_dict()


def test_the_best_category_by_hand() -> None:
    # Positive bags {2, 0}, {2, 1}, {2}; negative bags {0}, {3}, {2, 3}.
    points = np.array([[2.0], [0], [2], [1], [2], [0], [3], [2], [3]])
    starts, labels = np.array([0, 2, 4, 5, 6, 7, 9]), np.arange(6) < 3

    assert best_category(points, starts, (labels, None), "accuracy") == (2, 5.0, 3)
    found = aggregate(
        points, starts, labels, rng=np.random.default_rng(0), space="category", objective="log-likelihood"
    )
    assert found is not None
    # Inside 3 positive and 1 negative bag, outside 2 negative ones.
    assert found.score == pytest.approx(3 * np.log(3 / 4) + np.log(1 / 4))
    assert found.volume.contains(np.arange(4.0)[:, None]).tolist() == [False, False, True, False]


def test_a_category_costs_one_parameter() -> None:
    assert added_parameters(Mapping("identity", TEAM), has_errors=False) == 2


@pytest.mark.parametrize("mean", [0.5, 4.0, -1.0])
def test_a_volume_of_no_category_is_refused(mean: float) -> None:
    rng = np.random.default_rng(0)
    scenes = teams(rng, 60)
    document = SMRFTreeClassifier(random_state=0).fit(scenes, has_guest(scenes)).tree_.to_dict()
    question = next(node for node in document["nodes"] if node["kind"] == "question")
    question["volume"]["mean"] = [mean]

    with pytest.raises(ModelFormatError, match="must contain one category and no other"):
        Tree.from_dict(document)
