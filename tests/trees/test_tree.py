"""A tree as a value: what it is made of, what it refuses, and how it is changed into another one."""

from __future__ import annotations

from dataclasses import FrozenInstanceError, replace
from typing import Any

import numpy as np
import pytest

from relforest.mappings import Mapping
from relforest.scenes import Attribute, Schema
from relforest.support.errors import InputError
from relforest.trees import Instantiation, Leaf, Node, Question, Tree, query
from relforest.trees.nodes import children, shifted, variable_name
from relforest.trees.structure import MAX_DEPTH
from relforest.volumes import Arc, Slab, Volume
from small_trees import ball, leaf, near_tree, plane, scenes_in

SCHEMA = plane("passer")
IDENTITY = Mapping("identity", SCHEMA["location"])
DISTANCE = Mapping("distance", SCHEMA["location"])


def identity(variable: int, yes: int, radius: float = 1.0) -> Question:
    """A question whose three children stand one behind the other."""
    return Question(IDENTITY, (variable,), ball([0.0, 0.0], radius), yes, yes + 1, yes + 2)


def two_level_tree() -> Tree:
    """A near the origin? If so, a B within 2 of A?"""
    nodes: tuple[Node, ...] = (
        Instantiation(1),
        Question(IDENTITY, (0,), ball([0.0, 0.0], 1.0), 2, 7, 8),
        Instantiation(3),
        Question(DISTANCE, (0, 1), ball([0.0], 2.0), 4, 5, 6),
        leaf(0.9),
        leaf(0.6),
        leaf(0.5),
        leaf(0.1),
        leaf(0.2),
    )
    return Tree(SCHEMA, nodes)


def test_what_a_tree_knows_about_itself() -> None:
    tree = two_level_tree()

    assert tree.leaves == (4, 5, 6, 7, 8)
    assert tree.questions_above == ((1, 3), (1, 3), (1, 3), (1,), (1,))
    assert tree.n_bound == (0, 1, 1, 2, 2, 2, 2, 1, 1)
    assert (tree.n_leaves, tree.n_variables, tree.depth, tree.is_stub) == (5, 2, 2, False)
    assert tree.leaf_probabilities.tolist() == [0.9, 0.6, 0.5, 0.1, 0.2]


def test_a_stub() -> None:
    stub = Tree.stub(SCHEMA, Leaf(0.25, 3, 1))

    assert stub.nodes == (Leaf(0.25, 3, 1),)
    assert (stub.leaves, stub.n_leaves, stub.n_variables, stub.depth, stub.is_stub) == ((0,), 1, 0, 0, True)
    assert stub.questions_above == ((),)


def test_instantiations_without_a_question_are_allowed() -> None:
    tree = Tree(SCHEMA, (Instantiation(1), Instantiation(2), leaf(0.5)))

    assert (tree.n_variables, tree.depth, tree.is_stub) == (2, 0, True)


def test_a_tree_cannot_be_changed() -> None:
    tree: Any = two_level_tree()
    with pytest.raises(FrozenInstanceError):
        tree.nodes = ()


LEAVES = (leaf(0.5),) * 3


@pytest.mark.parametrize(
    ("nodes", "message"),
    [
        ((), "a tree needs at least one node"),
        ((leaf(0.5), leaf(0.5)), "node 1 has no parent before it: list the nodes in depth-first order"),
        ((Instantiation(0),), "node 0 points to node 0: every node must have one parent"),
        ((Instantiation(2), leaf(0.5)), "node 0 points to node 2"),
        ((Instantiation(-1), leaf(0.5)), "node 0 points to node -1"),
        # A cycle can only be closed by pointing back.
        ((Instantiation(1), Instantiation(0)), "node 1 points to node 0"),
        ((Instantiation(1), replace(identity(0, 2), no=2, error=3), *LEAVES[:2]), "node 1 points to node 2"),
        ((Instantiation(1), replace(identity(0, 2), error=9), *LEAVES), "node 1 points to node 9"),
        ((Instantiation(1), replace(identity(0, 2), yes=3, no=2), *LEAVES), "not in depth-first order"),
        (
            (identity(0, 1), *LEAVES),
            r"node 0: identity\(location\) needs 1 different bound variables, got \(0,\)",
        ),
        ((Instantiation(1), identity(-1, 2), *LEAVES), r"got \(-1,\) with 1 bound"),
        ((Instantiation(1), replace(identity(0, 2), variables=()), *LEAVES), r"got \(\) with 1 bound"),
        ((Instantiation(1), replace(identity(0, 2), variables=(0, 0)), *LEAVES), r"got \(0, 0\)"),
        (
            (
                Instantiation(1),
                Instantiation(2),
                Question(DISTANCE, (1, 1), ball([0.0], 1.0), 3, 4, 5),
                *LEAVES,
            ),
            r"distance\(location\) needs 2 different bound variables, got \(1, 1\) with 2 bound",
        ),
    ],
)
def test_nodes_that_are_no_tree_are_refused(nodes: tuple[Node, ...], message: str) -> None:
    with pytest.raises(InputError, match=message):
        Tree(SCHEMA, nodes)


def test_a_variable_of_another_branch_is_not_bound() -> None:
    # B is bound below Yes; the No branch asks for it.
    nodes = (
        Instantiation(1),
        replace(identity(0, 2), yes=2, no=4, error=8),
        Instantiation(3),
        leaf(0.5),
        identity(1, 5),
        *LEAVES,
        leaf(0.5),
    )
    with pytest.raises(InputError, match=r"node 4: .* got \(1,\) with 1 bound"):
        Tree(SCHEMA, nodes)


@pytest.mark.parametrize(
    ("mapping", "volume", "message"),
    [
        (
            Mapping("identity", Attribute("location", 3)),
            ball([0, 0, 0], 1.0),
            "that attribute is not in the schema",
        ),
        (Mapping("identity", Attribute("weight")), ball([0.0], 1.0), r"node 1 asks about identity\(weight\)"),
        (IDENTITY, Slab(ball([0.0], 1.0), 0, 3), r"node 1: identity\(location\) needs an ellipsoid in 2 dim"),
        (IDENTITY, ball([0.0], 1.0), r"node 1: identity\(location\) needs an ellipsoid in 2 dimension"),
        (IDENTITY, Arc(0.0, 1.0, 1.0), "needs an ellipsoid in 2 dimension"),
    ],
)
def test_questions_that_do_not_fit_are_refused(mapping: Mapping, volume: Volume, message: str) -> None:
    with pytest.raises(InputError, match=message):
        Tree(SCHEMA, (Instantiation(1), Question(mapping, (0,), volume, 2, 3, 4), *LEAVES))


def test_angles_need_an_arc() -> None:
    schema = Schema((Attribute("orientation"),))
    mapping = Mapping("identity", schema["orientation"])
    with pytest.raises(InputError, match=r"identity\(orientation\) needs an arc in 1 dimension"):
        Tree(schema, (Instantiation(1), Question(mapping, (0,), ball([0.0], 1.0), 2, 3, 4), *LEAVES))


def chain(n_questions: int) -> tuple[Node, ...]:
    """Questions one below the other, along the Yes branch."""
    last = 1 + n_questions
    questions = (
        replace(identity(0, i + 2), no=last + 2 * (n_questions - i) - 1, error=last + 2 * (n_questions - i))
        for i in range(n_questions)
    )
    return (Instantiation(1), *questions, *(leaf(0.5),) * (2 * n_questions + 1))


def test_the_deepest_tree_allowed() -> None:
    assert Tree(SCHEMA, chain(3)).depth == 3
    assert Tree(SCHEMA, chain(MAX_DEPTH)).depth == MAX_DEPTH
    with pytest.raises(InputError, match="node 1001 is question number 1001 of its branch: at most 1000"):
        Tree(SCHEMA, chain(MAX_DEPTH + 1))


def test_other_leaves() -> None:
    tree = two_level_tree()
    changed = tree.with_leaves([Leaf(0.1 * i, i, i) for i in range(5)])

    assert changed.leaf_probabilities.tolist() == pytest.approx([0, 0.1, 0.2, 0.3, 0.4])
    assert changed.nodes[:4] == tree.nodes[:4]
    assert tree.leaf_probabilities[0] == 0.9
    with pytest.raises(ValueError, match=r"shorter|longer"):
        tree.with_leaves([leaf(0.5)])


def test_expanding_a_leaf_moves_the_nodes_behind_it() -> None:
    tree = two_level_tree()
    question = Question(DISTANCE, (1, 2), ball([0.0], 4.0), 0, 0, 0)
    # Leaf 1 is node 5; Instantiation 5, question 6, leaves 7, 8, 9; what stood behind 5 moves by 4.
    grown = tree.expanded(1, 1, question)

    assert grown.nodes[:1] == tree.nodes[:1]
    assert isinstance(grown.nodes[1], Question)
    assert (grown.nodes[1].yes, grown.nodes[1].no, grown.nodes[1].error) == (2, 11, 12)
    assert isinstance(grown.nodes[3], Question)
    assert (grown.nodes[3].yes, grown.nodes[3].no, grown.nodes[3].error) == (4, 5, 10)
    assert grown.nodes[5] == Instantiation(6)
    assert grown.nodes[6] == replace(question, yes=7, no=8, error=9)
    assert grown.nodes[7:10] == (leaf(0.6),) * 3
    assert grown.nodes[10:] == tree.nodes[6:]
    assert grown.leaves == (4, 7, 8, 9, 10, 11, 12)
    assert grown.n_variables == 3


def test_expanding_a_stub_without_new_variables_is_refused() -> None:
    # Nothing is bound yet that the question could be about.
    with pytest.raises(InputError, match="with 0 bound"):
        Tree.stub(SCHEMA, leaf(0.5)).expanded(0, 0, identity(0, 0))


def test_an_expansion_with_equal_leaves_decides_as_before() -> None:
    tree = two_level_tree()
    rng = np.random.default_rng(0)
    places = [
        [tuple(place) for place in rng.normal(size=(rng.integers(1, 5), 2)).tolist()] for _ in range(20)
    ]
    scenes = scenes_in(SCHEMA, places, [[0]] * 20)
    before = tree.leaf_probabilities[query(tree, scenes).leaf]
    for ordinal in range(tree.n_leaves):
        grown = tree.expanded(ordinal, 2, identity(0, 0))
        after = grown.leaf_probabilities[query(grown, scenes).leaf]
        np.testing.assert_array_equal(after, before)


def test_children_and_shifting() -> None:
    question = identity(0, 2)

    assert children(leaf(0.5)) == ()
    assert children(Instantiation(1)) == (1,)
    assert children(question) == (2, 3, 4)
    assert shifted(leaf(0.5), 0, 9) == leaf(0.5)
    assert shifted(Instantiation(1), 0, 9) == Instantiation(10)
    assert children(shifted(question, 2, 5)) == (2, 8, 9)


def test_names_of_variables() -> None:
    assert [variable_name(variable) for variable in (0, 1, 25, 26, 100)] == ["A", "B", "Z", "V26", "V100"]


def test_packed_sizes() -> None:
    packed = two_level_tree().packed

    assert (packed.n_variables, packed.n_asked, packed.n_dims) == (2, 2, 2)
    assert near_tree(plane()).packed.boxed == (1, 2)
    # Only B is free, and searched for once.
    assert near_tree(plane("passer")).packed.boxed == (0, 1)
    # Squared radius, sharpness, mean and precision: 2 + 2 + 4 and 2 + 1 + 1 numbers.
    assert len(packed.numbers) == 12
    assert packed.numbers[:4].tolist() == [1, 1, 0, 0]
    stub = Tree.stub(SCHEMA, leaf(0.5)).packed
    assert (stub.n_variables, stub.n_asked, stub.n_dims, len(stub.numbers)) == (0, 0, 1, 0)


def test_a_near_tree_for_other_tests() -> None:
    assert near_tree(plane()).leaf_probabilities.tolist() == [0.9, 0.1, 0.3]
