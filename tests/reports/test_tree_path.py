from __future__ import annotations

import numpy as np
import pytest

from relforest.reports.tree_path import path_in_words, tree_path, witness_names
from relforest.support.errors import InputError
from relforest.trees import Question
from relforest.trees.text import introduced
from reports.drawn_trees import chain, five_questions, one_question, scenes_of


def test_a_path_names_leaf_nodes_witnesses_and_points() -> None:
    path = tree_path(one_question(), scenes_of([[0, 0], [5, 5], [1.5, 0.2]]))

    # Object c lies in the ellipse, and the Yes leaf is the most probable one.
    assert path.scene_id == "scene 0"
    assert path.leaf == 0
    assert path.nodes == (0, 1, 2, 3)
    assert path.witnesses == ("a0", "c0")
    assert {node: point.tolist() for node, point in path.points.items()} == {2: [1.5, 0.2]}


def test_where_no_object_is_left_the_witness_is_none() -> None:
    path = tree_path(one_question(), scenes_of([[0, 0]]))

    assert path.witnesses == ("a0", None)
    assert np.isnan(path.points[2]).all()
    assert witness_names(one_question(), path) == ("A (passer) = a0", "B = no object")


def test_only_the_variables_of_the_deciding_branch_are_witnesses() -> None:
    tree = chain(1)

    assert tree_path(tree, scenes_of([[1, 0], [2, 0]])).witnesses == ("a0",)


def test_a_path_in_words_tells_every_answer() -> None:
    tree = one_question()
    words = path_in_words(tree, tree_path(tree, scenes_of([[0, 0], [7, 7]])))

    assert words.splitlines()[0] == "scene scene 0: probability 0.20, leaf 1"
    assert "    A (passer) = a0" in words
    assert "    there is a B at larger x than A: in the ellipse around (1, 0)" in words
    assert " -> no\n" in words
    assert words.endswith("0.20  (2 of 10 scenes positive)")


def test_questions_introduce_their_new_variables_but_no_arguments() -> None:
    tree = five_questions()
    new = introduced(tree.schema, tree.nodes)

    assert list(new) == [i for i, node in enumerate(tree.nodes) if isinstance(node, Question)]
    # A is the passer; B is new at the root, and C at the question about colors.
    assert sorted(new.values()) == [(), (), (), (1,), (2,)]


def test_a_path_is_of_one_scene() -> None:
    with pytest.raises(InputError, match="expected a single scene, got 2"):
        tree_path(one_question(), scenes_of([[0, 0]], [[1, 1]]))
