from __future__ import annotations

from itertools import combinations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from relforest.reports.tree_layout import ANSWER_GAP, SIDE_GAP, Box, lay_out
from relforest.trees import Tree
from relforest.trees.nodes import children
from reports.drawn_trees import DISC, LEAF, SCHEMA, chain, one_question, question


@st.composite
def trees(draw: st.DrawFn) -> Tree:
    tree = Tree.stub(SCHEMA, LEAF)
    for number in range(draw(st.integers(0, 6))):
        leaf = draw(st.integers(0, tree.n_leaves - 1))
        n_new = 1 if number == 0 else draw(st.integers(0, 2))
        tree = tree.expanded(leaf, n_new, question("identity", "location", (0,), DISC))
    return tree


def overlap(one: Box, other: Box) -> bool:
    side_by_side = one.right <= other.left or other.right <= one.left
    return not side_by_side and one.top < other.bottom and other.top < one.bottom


@given(st.data(), trees())
def test_nodes_never_overlap_and_stand_below_their_parents(data: st.DataObject, tree: Tree) -> None:
    lengths = st.floats(0.2, 3.0)
    sizes = [(data.draw(lengths), data.draw(lengths)) for _ in tree.nodes]
    layout = lay_out(tree.nodes, sizes)

    for one, other in combinations(layout.boxes, 2):
        assert not overlap(one, other)
    for index, node in enumerate(tree.nodes):
        box = layout.boxes[index]
        assert 0.0 <= box.left < box.right <= layout.width + 1e-9
        assert 0.0 <= box.top < box.bottom <= layout.height + 1e-9
        assert all(layout.boxes[child].top > box.bottom for child in children(node))


def test_a_question_stands_in_the_middle_above_its_answers() -> None:
    tree = one_question()
    layout = lay_out(tree.nodes, [(1.0, 0.5)] * len(tree.nodes))
    asked, yes, no, error = layout.boxes[2:]

    # Three boxes of width 1 with two gaps between them, the question above the middle one.
    assert layout.width == pytest.approx(3.0 + 2 * SIDE_GAP)
    assert asked.centre == pytest.approx(no.centre)
    assert yes.left == 0.0
    assert error.right == layout.width
    assert yes.top == pytest.approx(asked.bottom + ANSWER_GAP)


def test_subtrees_use_the_room_below_their_neighbours_leaves() -> None:
    # A chain needs little more width than one question with its answers.
    sizes = {True: (0.8, 0.5), False: (2.0, 0.5)}
    tree = chain(8)
    layout = lay_out(tree.nodes, [sizes[not children(node)] for node in tree.nodes])

    assert layout.width < 4.5
