from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from matplotlib.patches import FancyBboxPatch, Polygon, Rectangle

from relforest.mappings import Mapping
from relforest.reports import question_points, save_figure, tree_figure
from relforest.reports.style import BLUE
from relforest.reports.tree_figure import MOST_NODES, MOST_PANELS
from relforest.scenes import Attribute, Schema
from relforest.support.errors import InputError
from relforest.trees import Question, Tree
from reports.drawn_trees import DISC, LEAF, SCHEMA, chain, five_questions, one_question, scenes_of, texts_of

SCENES = scenes_of([[0, 0], [1, 0.1], [0.5, 0]], [[0, 0], [4, 4]], [[1, 1], [2.5, 1]])
LABELS = np.array([True, False, True])


def test_instantiations_questions_and_leaves_have_their_shapes() -> None:
    tree_axes = tree_figure(five_questions()).axes[0]

    # Three variables on the branches: A and B at the root, C before the color.
    assert len(tree_axes.findobj(Polygon, include_self=False)) == 3
    assert len(tree_axes.findobj(FancyBboxPatch, include_self=False)) == 5
    # Eleven leaves and the (invisible) background.
    leaves = [patch for patch in tree_axes.patches if isinstance(patch, Rectangle)]
    assert len(leaves) == 11


def test_a_tree_is_told_by_its_texts() -> None:
    texts = texts_of(tree_figure(one_question()))
    sentence = " ".join(texts)

    assert {"A: passer", "B: any object", "Yes", "No", "Error"} <= set(texts)
    assert {"0.90", "9 of 10", "0.20", "2 of 10", "0.30", "no scenes", "leaf 0", "leaf 1", "leaf 2"} <= set(
        texts
    )
    assert "there is a B at larger x than A: see Q1" in sentence
    assert "SMRF tree: 1 question, 3 leaves" in texts


def test_a_volume_is_told_by_mean_and_scaled_eigenvectors() -> None:
    texts = texts_of(tree_figure(one_question()))

    # V = diag(4, 1) and radius 0.5: semi-axes of length 0.5 * 2 and 0.5 * 1.
    assert "(1, 0)" in texts
    assert any(text in {"(1, 0)", "(-1, 0)"} for text in texts[texts.index("extent 1") :])
    assert any(text in {"(0, 0.5)", "(0, -0.5)"} for text in texts)


def test_every_question_has_a_panel() -> None:
    figure = tree_figure(five_questions(), SCENES, LABELS)

    assert len(figure.axes) == 6
    assert {f"Q{number}" for number in range(1, 6)} == {
        text.split()[0] for text in texts_of(figure) if text.startswith("Q")
    }


def test_points_are_drawn_by_class() -> None:
    _, panel = tree_figure(one_question(), SCENES, LABELS).axes
    negative, positive = panel.collections

    # B - A: (1, 0.1) and (0.5, 0) of scene 0, (4, 4) of the negative scene 1, (1.5, 0) of scene 2.
    assert np.asarray(negative.get_offsets()).tolist() == [[4, 4]]
    assert np.asarray(positive.get_offsets()).tolist() == [[1, 0.1], [0.5, 0], [1.5, 0]]


def test_stored_points_are_drawn_like_those_of_scenes() -> None:
    points = question_points(one_question(), SCENES, LABELS)
    _, panel = tree_figure(one_question(), points=points).axes

    assert len(panel.collections) == 2
    assert "positive scenes" in texts_of(tree_figure(one_question(), points=points))
    assert "positive scenes" not in texts_of(tree_figure(one_question()))


def test_the_way_of_a_scene_is_marked_with_its_objects() -> None:
    figure = tree_figure(one_question(), highlight=SCENES.take([0]), title="completed")
    texts = texts_of(figure)
    tree_axes, panel = figure.axes
    lit = [patch for patch in tree_axes.patches if patch.get_linewidth() > 2]

    assert {"A = a0", "B = b0", "completed"} <= set(texts)
    assert "scene scene 0: probability 0.90 (leaf 0)" in texts
    assert "A (passer) = a0, B = b0" in texts
    # Two instantiations, the question and its Yes leaf.
    assert len(lit) == 4
    assert [line.get_marker() for line in panel.lines] == ["*"]
    assert [line.get_color() for line in tree_axes.lines].count(BLUE) == 3


def test_an_undefined_witness_is_not_marked() -> None:
    figure = tree_figure(one_question(), highlight=scenes_of([[0, 0]]))

    assert "B = no object" in texts_of(figure)
    assert list(figure.axes[1].lines) == []


@pytest.mark.parametrize("tree", [Tree.stub(SCHEMA, LEAF), chain(8), five_questions()], ids=["1", "17", "11"])
def test_every_text_lies_on_the_page(tree: Tree) -> None:
    figure = tree_figure(tree, SCENES, LABELS, highlight=SCENES.take([0]))
    figure.draw_without_rendering()
    page = figure.bbox

    for text in [*figure.axes[0].texts, *figure.texts]:
        box = text.get_window_extent()
        assert page.x0 <= box.x0 < box.x1 <= page.x1
        assert page.y0 <= box.y0 < box.y1 <= page.y1


def test_a_stub_is_a_single_leaf() -> None:
    figure = tree_figure(Tree.stub(SCHEMA, LEAF), SCENES, LABELS, highlight=SCENES.take([1]))

    assert len(figure.axes) == 1
    assert "SMRF tree: 0 questions, 1 leaf" in texts_of(figure)


@pytest.mark.parametrize("suffix", [".png", ".svg"])
def test_equal_trees_give_equal_bytes(tmp_path: Path, suffix: str) -> None:
    for name in "ab":
        save_figure(tree_figure(five_questions(), SCENES, LABELS), tmp_path / f"{name}{suffix}")

    assert (tmp_path / f"a{suffix}").read_bytes() == (tmp_path / f"b{suffix}").read_bytes()


def test_scenes_need_labels() -> None:
    with pytest.raises(InputError, match="scenes and labels belong together"):
        tree_figure(one_question(), SCENES)


def named(name: str) -> Tree:
    """One question about an attribute of this name."""
    schema = Schema([Attribute(name, 2)])
    question = Question(Mapping("difference", schema[name]), (0, 1), DISC, 0, 0, 0)
    return Tree.stub(schema, LEAF).expanded(0, 2, question)


@pytest.mark.parametrize("suffix", [".png", ".svg"])
@pytest.mark.parametrize("name", ["x" * 10_000, "many words " * 900, "\N{CJK UNIFIED IDEOGRAPH-4E2D}" * 40])
def test_long_and_foreign_names_are_drawn(tmp_path: Path, name: str, suffix: str) -> None:
    figure = tree_figure(named(name), title=f"{name} \x00\x1b\ud800\n")
    save_figure(figure, tmp_path / f"tree{suffix}")

    assert max(figure.get_size_inches()) < 60
    if suffix == ".svg":
        text = (tmp_path / "tree.svg").read_text("utf-8")
        assert all(letter.isprintable() or letter == "\n" for letter in text)


def test_of_many_questions_the_first_have_panels() -> None:
    figure = tree_figure(chain(MOST_PANELS + 2))

    assert len(figure.axes) == 1 + MOST_PANELS
    assert f"decision volumes of the first {MOST_PANELS} of {MOST_PANELS + 2} questions" in texts_of(figure)


def test_a_tree_that_fits_no_page_is_refused() -> None:
    with pytest.raises(InputError, match=r"the tree has \d+ nodes, but a picture can show at most"):
        tree_figure(chain(200))


def test_the_largest_tree_is_drawn(tmp_path: Path) -> None:
    tree = chain((MOST_NODES - 2) // 3)
    save_figure(tree_figure(tree), tmp_path / "tree.png")

    assert MOST_NODES - 3 <= len(tree.nodes) <= MOST_NODES
