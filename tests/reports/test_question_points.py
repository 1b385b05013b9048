from __future__ import annotations

import sys
from itertools import permutations

import numpy as np
import pytest
from hypothesis import given

from relforest.mappings import Mapping
from relforest.reports.question_points import QuestionPoints, question_points
from relforest.scenes import Attribute, Scenes, Schema
from relforest.support.errors import InputError
from relforest.trees import Instantiation, Leaf, Question, Tree
from reports.drawn_trees import DISC, NEAR, chain, five_questions, one_question, scenes_of
from strategies import scenes_batches

PAIRS = Schema([Attribute("location", 2)])


def test_points_are_those_of_the_sequences_that_arrive() -> None:
    scenes = scenes_of([[0, 0], [1, 0], [5, 5]], [[1, 1], [0, 0]])
    found = question_points(one_question(), scenes, np.array([True, False]))[2]

    # A is the first object: B - A in scene 0 is (1, 0) and (5, 5), in scene 1 (-1, -1).
    assert found.points.tolist() == [[1, 0], [5, 5], [-1, -1]]
    assert found.positive.tolist() == [True, True, False]


def test_later_questions_see_only_what_their_branch_lets_through() -> None:
    scenes = scenes_of([[1, 0]], [[9, 9]])
    tree = chain(2)
    found = question_points(tree, scenes, np.array([True, False]))

    # (1, 0) lies in the ellipse of the first question, so only (9, 9) goes on to the second.
    first, second = (i for i, node in enumerate(tree.nodes) if isinstance(node, Question))
    assert found[first].points.tolist() == [[1, 0], [9, 9]]
    assert found[second].points.tolist() == [[9, 9]]


def test_undefined_points_are_left_out() -> None:
    scenes = scenes_of([[0, 0]], [[np.nan, 0], [1, 1]])

    # One scene has no B, the other no location of A.
    assert len(question_points(one_question(), scenes, np.array([True, True]))[2]) == 0


@given(scenes_batches(PAIRS))
def test_pairs_are_those_of_a_plain_loop(scenes: Scenes) -> None:
    mapping = Mapping("difference", PAIRS["location"])
    question = Question(mapping, (0, 1), DISC, 0, 0, 0)
    tree = Tree.stub(PAIRS, Leaf(0.5, 1, 1)).expanded(0, 2, question)
    expected = []
    for scene in range(len(scenes)):
        for a, b in permutations(scenes.objects(scene), 2):
            point = scenes.matrix[b] - scenes.matrix[a]
            if not np.isnan(point).any():
                expected.append((scene, *point.tolist()))
    labels = np.arange(len(scenes)) % 2 == 0
    found = question_points(tree, scenes, labels)[2]

    assert sorted(found.points.tolist()) == sorted(point for _, *point in expected)
    assert found.positive.sum() == sum(bool(labels[scene]) for scene, *_ in expected)


def test_every_question_of_a_tree_is_listed() -> None:
    tree = five_questions()
    scenes = scenes_of([[0, 0], [1, 0], [0.5, 0]], [[0, 0], [3, 0]])
    found = question_points(tree, scenes, np.array([True, False]))

    assert sorted(found) == [i for i, node in enumerate(tree.nodes) if isinstance(node, Question)]
    assert {node: points.points.shape[1] for node, points in found.items()} == {
        i: node.mapping.dim for i, node in enumerate(tree.nodes) if isinstance(node, Question)
    }


def test_too_many_sequences_are_thinned_out(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys.modules[question_points.__module__], "MOST_SEQUENCES", 20)
    scenes = scenes_of(*[[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]]] * 50)
    found = question_points(one_question(), scenes, np.ones(50, dtype=bool))[2]

    # 50 scenes would give 100 sequences; 10 evenly spaced scenes are left, with 2 each.
    assert len(found) == 20


def test_thinning_keeps_both_classes_and_the_order() -> None:
    points = QuestionPoints(np.arange(10.0)[:, None], np.arange(10) < 8)

    # In one dimension what lies inside does not matter: NEAR reaches from -2 to 2.
    assert points.thinned(3, NEAR).points[:, 0].tolist() == [0, 4, 7, 8, 9]
    assert points.thinned(100, NEAR).points.tolist() == points.points.tolist()


def test_thinning_keeps_a_small_ellipse_from_looking_empty() -> None:
    # DISC is the ellipse around (1, 0) with half axes 1 and 0.5.
    outside = [[10.0, float(number)] for number in range(50)]
    inside = [[1.0, 0.01 * number] for number in range(10)]
    points = QuestionPoints(np.array(outside + inside), np.ones(60, dtype=bool))

    assert points.thinned(8, DISC).points[:, 0].tolist() == [10.0] * 4 + [1.0] * 4
    # Fewer inside than their share: the rest goes to those outside, and the other way round.
    assert points.thinned(30, DISC).points[:, 0].tolist() == [10.0] * 20 + [1.0] * 10
    few = QuestionPoints(np.array(outside[:1] + inside), np.ones(11, dtype=bool))
    assert len(few.thinned(8, DISC)) == 8


def test_wrong_scenes_and_labels_are_refused() -> None:
    scenes = scenes_of([[0, 0]])
    other = Tree.stub(PAIRS, Leaf(0.5, 1, 1))

    with pytest.raises(InputError, match="the model is for scenes with"):
        question_points(other, scenes, np.array([True]))
    with pytest.raises(InputError, match="one label per scene"):
        question_points(one_question(), scenes, np.array([True, False]))


def test_instantiations_without_questions_are_harmless() -> None:
    tree = Tree(PAIRS, (Instantiation(1), Leaf(0.5, 1, 1)))

    assert question_points(tree, Scenes.from_dicts([{"objects": []}], PAIRS), np.array([True])) == {}
