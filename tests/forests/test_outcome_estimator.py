"""Outcome forests: what they add to their trees, and what they refuse."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import relforest
from forests.team_scenes import guest_on_the_left, nearest, scenes_of
from interpreted import compiled_only
from relforest import OutcomeForestClassifier
from relforest.forests.linear_machine import weighed
from relforest.metrics import peirce_skill_score
from relforest.models import Model
from relforest.scenes import Attribute, Scenes, Schema
from relforest.support.errors import InputError
from relforest.trees import TreeSettings

PLACE = Schema([Attribute("location", 2)], ["A"])


def placed(rng: np.random.Generator, n: int, n_objects: int) -> Scenes:
    """Objects at random places; the first one is the argument."""
    starts = np.arange(n) * n_objects
    places = rng.uniform(-5, 5, (n * n_objects, 2))
    return Scenes(PLACE, places, np.arange(len(places)), starts, np.full(n, n_objects), starts[:, np.newaxis])


def leans_right(scenes: Scenes) -> NDArray[np.bool_]:
    """Is the mean x of all objects but the argument positive?"""
    x = scenes.matrix[:, 0].reshape(len(scenes), -1)
    return np.asarray(x[:, 1:].mean(axis=1) > 0.0)


def test_columns_are_weighed_by_what_they_tell() -> None:
    rng = np.random.default_rng(0)
    positive = rng.random(400) < 0.2
    columns = np.column_stack([positive + rng.standard_normal(400), rng.standard_normal(400), np.ones(400)])
    found = weighed(columns, positive, np.ones(400), rng)
    probability = 1 / (1 + np.exp(-(found.start + columns @ found.weights)))

    assert found.weights[0] > 5 * abs(found.weights[1])
    assert probability.mean() == pytest.approx(positive.mean(), abs=0.02)
    said = found.start + columns @ found.weights >= found.boundary
    assert peirce_skill_score(positive, said) == pytest.approx(found.skill, abs=0.1)
    assert found.losses.mean() < -(0.2 * np.log(0.2) + 0.8 * np.log(0.8))


def test_columns_that_tell_nothing_leave_the_share() -> None:
    positive = np.arange(60) % 3 == 0
    found = weighed(np.ones((60, 2)), positive, np.ones(60), np.random.default_rng(1))

    assert found.weights.tolist() == [0.0, 0.0]
    assert found.start == pytest.approx(np.log(0.5), abs=0.1)


@compiled_only
def test_rare_outcomes_are_predicted_with_calibrated_probabilities() -> None:
    rng = np.random.default_rng(2)
    scenes, others = scenes_of(rng, 300), scenes_of(rng, 600, 6)
    rare = guest_on_the_left(scenes) & (rng.random(300) < 0.5)
    truth = guest_on_the_left(others) & (rng.random(600) < 0.5)
    model = OutcomeForestClassifier(n_trees=30, random_state=0).fit(scenes, rare)

    assert model.threshold_ == pytest.approx(rare.mean())
    assert model.predict_proba(scenes)[:, 1].mean() == pytest.approx(rare.mean(), abs=0.05)
    assert model.predict_proba(others)[:, 1].max() < 0.8
    assert peirce_skill_score(truth, model.predict(others)) > 0.5


@compiled_only
def test_a_sum_over_objects_is_found_by_their_mean_also_among_more(tmp_path: Path) -> None:
    rng = np.random.default_rng(3)
    scenes, others = placed(rng, 250, 4), placed(rng, 300, 8)
    model = OutcomeForestClassifier(n_trees=30, random_state=0).fit(scenes, leans_right(scenes))
    without = OutcomeForestClassifier(n_trees=30, mean_object=False, random_state=0)
    without.fit(scenes, leans_right(scenes))
    skills = [peirce_skill_score(leans_right(others), each.predict(others)) for each in (model, without)]

    assert skills[0] > 0.95 > skills[1]
    assert model.ensemble_.schema.parameters == ("A", "mean object")
    assert "the mean object has x at" in model.describe(most=3)
    assert "mean object" in str(model.explain(others[:1])[0])
    assert "mean object" not in without.ensemble_.schema.parameters
    relforest.save(model, tmp_path / "model.json")
    read = relforest.load(tmp_path / "model.json")
    assert isinstance(read, Model)
    assert (read.schema, read.threshold) == (PLACE, model.threshold_)
    assert np.array_equal(read.predictions(others).predicted.astype(bool), model.predict(others))


@compiled_only
def test_smrf_trees_are_weighed_one_by_one() -> None:
    rng = np.random.default_rng(4)
    scenes, others = scenes_of(rng, 150, 3), scenes_of(rng, 200, 3)
    settings = TreeSettings(attempts=1)
    model = OutcomeForestClassifier(n_trees=6, growth=settings, random_state=0)
    model.fit(scenes, nearest(scenes) < 2.5)

    assert model.ensemble_.is_smrf
    assert len(model.ensemble_.trees) == 6
    assert peirce_skill_score(nearest(others) < 2.5, model.predict(others)) > 0.6


@pytest.mark.parametrize(
    ("labels", "said"),
    [
        (["yes"] * 9 + ["no"] * 31, "only 9 scenes are of class 'yes': at least 10 of each"),
        (["yes"] * 40, "only 1 class: yes"),
        ([1] * 20 + [2] * 10 + [3] * 10, "outcomes are two classes, got 3"),
    ],
)
def test_labels_that_cannot_be_learned_are_refused(labels: list[Any], said: str) -> None:
    with pytest.raises(InputError, match=said):
        OutcomeForestClassifier(n_trees=2).fit(scenes_of(np.random.default_rng(5), 40), labels)


def test_no_scenes_are_refused() -> None:
    with pytest.raises(InputError, match="there are no scenes to learn from"):
        OutcomeForestClassifier().fit(scenes_of(np.random.default_rng(6), 3).take([]), [])


@compiled_only
def test_scenes_of_another_action_are_refused() -> None:
    rng = np.random.default_rng(7)
    scenes = placed(rng, 40, 3)
    model = OutcomeForestClassifier(n_trees=2, random_state=0).fit(scenes, np.arange(40) % 2)
    other = Scenes(
        Schema(PLACE.attributes, ["A", "B"]), *scenes.parts[1:5], scenes.arguments.repeat(2, axis=1)
    )

    with pytest.raises(InputError, match="the model is for scenes with"):
        model.predict(other)
