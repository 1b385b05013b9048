from __future__ import annotations

import re

import numpy as np
import pytest
from numpy.typing import NDArray

from relforest.explaining import decision_map, explain_prediction, explanation_page, row_named
from relforest.forests import SMRFBoostingClassifier, SMRFForestRegressor
from relforest.models import Model, as_model
from relforest.scenes import Attribute, Scenes, Schema
from relforest.support.errors import InputError
from small_trees import near_tree, plane, scenes_in

PAIRS = plane("A")
NEAR = Model(near_tree(PAIRS), "tree", "meets", (False, True), None)
SCENE = scenes_in(PAIRS, [[(0.0, 0.0), (5.0, 0.0)]], [[0]])


def pairs(n: int) -> tuple[Scenes, NDArray[np.float64]]:
    places = np.random.default_rng(0).uniform(0, 10, (n, 2, 2))
    scenes = scenes_in(PAIRS, places.tolist(), [[0]] * n)
    return scenes, np.linalg.norm(places[:, 0] - places[:, 1], axis=1)


def test_a_map_shows_the_volume() -> None:
    # The grid goes from -10 to 10 in steps of 2; B within 3 of A.
    drawn = decision_map(NEAR, SCENE, 1, within=[[-10, -10], [10, 10]], cells=11)

    x, y = np.meshgrid(drawn.x, drawn.y)
    assert np.array_equal(drawn.values == 0.9, np.hypot(x, y) <= 3.0)
    assert drawn.boundary == 0.5


def test_everything_is_told() -> None:
    told = str(explain_prediction(NEAR, SCENE))

    assert "scene 0: meets = False" in told
    assert "The probability of meets = True is 0.10, and it is predicted from 0.50 on." in told
    assert re.search(r"If (A \(0\)|1) were 2 away, at .* meets = True would be predicted.", told)


def test_questions_about_the_same_are_told_together() -> None:
    scenes, distances = pairs(120)
    model = SMRFBoostingClassifier(n_trees=20, random_state=0).fit(scenes, distances < 4)
    explanation = explain_prediction(as_model(model), scenes.take([0]))

    (score,) = model.ensemble_.scores(scenes.take([0]))[0] - model.ensemble_.start
    assert sum(reason.n_questions for reason in explanation.reasons) > len(explanation.reasons)
    # What all answers add, and what the average scene has, is the score.
    every = model.explain(scenes.take([0]), most=1000)[0].reasons
    assert sum(each.contribution for each in every) == pytest.approx(
        sum(
            each.contribution
            for each in explain_prediction(as_model(model), scenes.take([0]), most=1000).reasons
        )
    )
    assert np.sign(score) == np.sign(explanation.value - 0.5)


def test_numbers_have_a_map_and_no_move() -> None:
    scenes, distances = pairs(60)
    model = as_model(SMRFForestRegressor(n_trees=3, random_state=0).fit(scenes, distances))
    explanation = explain_prediction(model, scenes.take([0]))

    assert explanation.move is None
    assert explanation.turning == ""
    assert explanation.map is not None
    assert explanation.map.boundary == explanation.value == explanation.predicted


def test_a_page_marks_objects_and_works_offline() -> None:
    page = explanation_page(explain_prediction(NEAR, SCENE), title="<1 & 2>")

    assert "<title>&lt;1 &amp; 2&gt;</title>" in page
    assert re.findall(r'<g data-key="(\d+)">', page) == ["0", "1"]
    assert 'data-rows="0 1"' in page
    assert "data:image/png;base64," in page
    assert "http" not in page.replace('http-equiv="Content-Security-Policy"', "")
    assert "@@" not in page


def test_objects_are_named_by_argument_or_id() -> None:
    assert [row_named(SCENE, name) for name in ("A", "1")] == [0, 1]
    with pytest.raises(InputError, match="no object 'B': choose one of A, 0, 1"):
        row_named(SCENE, "B")


def test_only_scenes_in_the_plane_are_drawn() -> None:
    schema = Schema([Attribute("location", 3)])
    scene = Scenes.from_dicts([{"objects": [{"location": [0.0, 1.0, 2.0]}]}], schema=schema)
    model = Model(near_tree(schema), "tree", "meets", (False, True), None)
    with pytest.raises(InputError, match="location has 3 dimensions: only scenes in the plane"):
        decision_map(model, scene, 0)
    with pytest.raises(InputError, match="cells must be"):
        decision_map(NEAR, SCENE, 0, cells=1)
