from __future__ import annotations

import xml.etree.ElementTree as ET
from typing import Any

import gymnasium
import numpy as np
import pytest

import forest_scenes
from relforest import SMRFTreeClassifier
from relforest.forests import Ensemble
from relforest.forests.scene_tree import SceneTree, Split, Value
from relforest.models import Model
from relforest.reports.notebook import MOST_NODES, as_html
from relforest.rl import Evaluation
from relforest.scenes import Attribute, Scenes, Schema
from relforest.trees import Leaf, Question, Tree
from relforest.volumes import Aggregation, Arc, Ellipsoid, Slab
from reports.drawn_trees import one_question, scenes_of
from small_trees import plane, scenes_in

BALL = Ellipsoid(np.zeros(3), np.eye(3), 2.0, 3, 0.1)


def ensemble() -> Ensemble:
    rng = np.random.default_rng(0)
    split = Split(forest_scenes.random_condition(rng, 1), 1, 2, 1.0)
    tree = SceneTree((split, Value((0.5,), 3), Value((-0.25,), 4)))
    schema = forest_scenes.random_scenes(rng, 1, 1).schema
    return Ensemble(schema, np.zeros(1), (tree,), np.ones(1))


def parsed(html: str) -> ET.Element:
    """The elements of HTML that is also XML; scripts and handlers of events are not allowed."""
    assert "<script" not in html
    root = ET.fromstring(html)  # noqa: S314 - our own text
    assert not any(name.startswith("on") for each in root.iter() for name in each.attrib)
    return root


@pytest.mark.parametrize(
    ("value", "told"),
    [
        (scenes_of([[0, 0], [1, 0]]), "scene 0: 2 objects"),
        (one_question(), "Yes"),
        (ensemble(), "1 tree with 1 question"),
        (Model(ensemble(), "boosting", "done", (False, True), None), "a yes adds"),
        (BALL, "Ellipsoid"),
        (Arc(1.0, 0.5, 3.0), "kappa"),
        (Slab(Ellipsoid(np.ones(1), np.eye(1), 2.0, 3, 0.1), 1, 4), "Slab"),
        (Aggregation(BALL, 12.0, 34), "the best of 34 volumes"),
        (Evaluation(np.arange(3.0), np.ones(3)), "3 episodes"),
    ],
)
def test_values_are_drawn_with_words_and_without_scripts(value: Any, told: str) -> None:
    html = value._repr_html_()
    root = parsed(html)

    assert told in html
    assert any(each.tag.endswith("svg") for each in root.iter())


def test_names_are_text() -> None:
    team = Attribute("team", kind="category", categories=["<b>", "&"])
    schema = Schema((Attribute("location", 2), team), ["<i>"])
    matrix = np.array([[0.0, 0.0, 0.0], [1.0, np.nan, np.nan]])
    arrays = (np.arange(2), np.array([0]), np.array([2]), np.array([[0]]))
    scenes = Scenes(schema, matrix, *arrays, object_ids=np.array(["<u>", "x"], dtype=object))

    html = scenes._repr_html_()
    assert "&lt;i&gt;" in html
    assert not any(each.tag in {"b", "i", "u"} for each in parsed(html).iter())


def test_scenes_without_objects_or_places_are_told() -> None:
    nothing = scenes_in(plane(), [[]])
    names = Schema([Attribute("team", kind="category", categories=["home"])])
    placeless = Scenes(names, np.zeros((1, 1)), np.zeros(1, np.int64), np.array([0]), np.array([1]))

    assert "scene 0: 0 objects" in as_html(nothing)
    assert "scene 0: 1 object" in as_html(placeless)
    assert parsed(as_html(placeless[:0])) is not None


def test_large_trees_are_told_in_words() -> None:
    tree = one_question()
    while len(tree.nodes) <= MOST_NODES:
        question = next(node for node in tree.nodes if isinstance(node, Question))
        tree = tree.expanded(0, 0, question)

    assert "<svg" not in as_html(tree)
    assert "SMRF tree with" in as_html(tree)
    assert "<svg" in as_html(Tree.stub(plane(), Leaf(0.5, 1, 1)))


def test_estimators_keep_the_diagram_of_their_library() -> None:
    assert "sk-top-container" in SMRFTreeClassifier()._repr_html_()


def test_unknown_values_are_told_as_they_are() -> None:
    assert as_html("<a>") == '<pre style="white-space: pre-wrap">&#x27;&lt;a&gt;&#x27;</pre>'


def test_blocks_have_their_shapes_and_colors() -> None:
    env = gymnasium.make("relforest/HighTowers-v0")
    _, info = env.reset(seed=0)

    drawn = [each for each in parsed(as_html(info["scene"])).iter() if each.tag == "polygon"]
    assert len(drawn) == 5
    assert len({each.attrib["style"].partition(";")[0] for each in drawn}) == 5
