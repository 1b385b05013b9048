"""A picture of a SMRF tree: its nodes, and the decision volume of each question.

Compare Figures 4.1 and 7.6 of Palmer (2015).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import islice
from typing import Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import ArrayLike

from relforest.reports.node_drawing import draw_tree, node_texts
from relforest.reports.page_layout import MARGIN, Page, arrange
from relforest.reports.question_panel import PANEL_WIDTH, draw_panel, panel_height
from relforest.reports.question_points import QuestionPoints, question_points
from relforest.reports.style import GREY, NEGATIVE, POSITIVE, styled
from relforest.reports.text_size import Weight, line_height, shortened, text_width
from relforest.reports.tree_layout import Layout, lay_out
from relforest.reports.tree_path import TreePath, tree_path, witness_names
from relforest.scenes import Scenes
from relforest.support.errors import InputError
from relforest.trees import Question, Tree

_TITLE: Final = 11.0
_SUBTITLE: Final = 8.5
_LEGEND_HEIGHT: Final = 0.22
_WIDEST_HEAD: Final = 14.0
MOST_NODES: Final = 400
"""Largest number of nodes of a tree that is drawn."""
MOST_PANELS: Final = 24
"""Largest number of decision volumes that are drawn: those of the first questions."""


def tree_figure(
    tree: Tree,
    scenes: Scenes | None = None,
    labels: ArrayLike | None = None,
    *,
    points: Mapping[int, QuestionPoints] | None = None,
    highlight: Scenes | None = None,
    title: str = "",
) -> Figure:
    """Draw a tree.

    Parameters
    ----------
    tree : Tree
    scenes : Scenes, optional
        Scenes; their points are drawn behind each volume.
    labels : (n_scenes,) bool, optional
        True for positive scenes.
    points : mapping of int to QuestionPoints, optional
        Points by node index, as an alternative to scenes.
    highlight : Scenes, optional
        A scene; its path through the tree is marked, with the objects that decided.
    title : str
        Title. Default: the size of the tree.

    Returns
    -------
    matplotlib.figure.Figure
        As large as necessary. At most `MOST_PANELS` decision volumes are drawn.

    Raises
    ------
    InputError
        If the tree has more than `MOST_NODES` nodes, scenes come without labels or do not fit the tree, or
        more than one scene is to be highlighted.
    """
    if len(tree.nodes) > MOST_NODES:
        raise InputError(
            f"the tree has {len(tree.nodes)} nodes, but a picture can show at most {MOST_NODES}: "
            "print the tree as text instead"
        )
    if (scenes is None) != (labels is None):
        raise InputError("scenes and labels belong together: pass both or neither")
    if scenes is not None:
        points = question_points(tree, scenes, np.asarray(labels, dtype=np.bool_))
    points = points or {}
    path = None if highlight is None else tree_path(tree, highlight)
    questions = {index: node for index, node in enumerate(tree.nodes) if isinstance(node, Question)}
    names = {index: f"Q{number}" for number, index in enumerate(questions, start=1)}
    texts = node_texts(tree, names, path)
    shown = dict(islice(questions.items(), MOST_PANELS))
    layout = lay_out(tree.nodes, [text.size for text in texts])
    head = _head(tree, title, path)
    if len(shown) < len(questions):
        head.append((f"decision volumes of the first {len(shown)} of {len(questions)} questions", _SUBTITLE))
    panel = (PANEL_WIDTH, panel_height([question.volume for question in shown.values()]))
    page = arrange((layout.width, layout.height), panel, len(shown), head=_size(head, legend=bool(points)))
    with styled():
        figure = Figure(figsize=(page.width, page.height))
        _draw_head(figure, page, head, legend=bool(points))
        draw_tree(_tree_axes(figure, page, layout), tree, texts, layout, path)
        for (index, question), place in zip(shown.items(), page.panels, strict=True):
            witness = None if path is None else path.points.get(index)
            draw_panel(figure, page, place, (names[index], question), points.get(index), witness)
    return figure


def _head(tree: Tree, title: str, path: TreePath | None) -> list[tuple[str, float]]:
    """Return the lines above the tree, each with its font size."""
    n_questions = sum(isinstance(node, Question) for node in tree.nodes)
    counted = f"{n_questions} question{'' if n_questions == 1 else 's'}"
    leaves = "1 leaf" if tree.is_stub else f"{tree.n_leaves} leaves"
    lines = [(title or f"SMRF tree: {counted}, {leaves}", _TITLE)]
    if path is not None:
        lines.append((f"scene {path.scene_id}: {path.says} (leaf {path.leaf})", _SUBTITLE))
        if path.witnesses:
            lines.append((", ".join(witness_names(tree, path)), _SUBTITLE))
    return [(shortened(text, _WIDEST_HEAD, size, _weight(size)), size) for text, size in lines]


def _size(head: Sequence[tuple[str, float]], *, legend: bool) -> tuple[float, float]:
    width = max(text_width(text, size, _weight(size)) for text, size in head)
    return width, sum(line_height(size) for _, size in head) + (_LEGEND_HEIGHT if legend else 0.0)


def _weight(size: float) -> Weight:
    return "bold" if size == _TITLE else "normal"


def _draw_head(figure: Figure, page: Page, head: Sequence[tuple[str, float]], *, legend: bool) -> None:
    y = MARGIN
    for text, size in head:
        place = page.at((MARGIN, y))
        figure.text(*place, text, va="top", fontsize=size, fontweight=_weight(size), parse_math=False)
        y += line_height(size)
    if legend:
        marks = [
            Line2D([], [], ls="", marker=marker, color=color, ms=4, label=f"{side} scenes")
            for side, marker, color in (("positive", "^", POSITIVE), ("negative", "o", NEGATIVE))
        ]
        figure.legend(
            handles=marks,
            loc="upper left",
            bbox_to_anchor=page.at((MARGIN, y)),
            ncols=2,
            borderpad=0.1,
            borderaxespad=0.0,
            handletextpad=0.2,
            labelcolor=GREY,
        )


def _tree_axes(figure: Figure, page: Page, layout: Layout) -> Axes:
    """Add axes in inches, with y pointing down from the top of the tree."""
    axes = figure.add_axes(page.bounds(page.tree, layout.width, layout.height))
    axes.set_xlim(0.0, layout.width)
    axes.set_ylim(layout.height, 0.0)
    axes.set_axis_off()
    return axes
