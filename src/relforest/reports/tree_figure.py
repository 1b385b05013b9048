"""A SMRF tree as a picture: its nodes, and beside them the decision volume of each question.

Compare Figures 4.1 and 7.6 of Palmer (2015).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import ArrayLike

from relforest.reports.node_drawing import draw_tree, node_texts
from relforest.reports.question_points import QuestionPoints, question_points
from relforest.reports.style import GREY, INK, NEGATIVE, POSITIVE, styled
from relforest.reports.text_size import line_height, shortened, text_width
from relforest.reports.tree_layout import Layout, lay_out
from relforest.reports.tree_path import TreePath, leaf_node, tree_path, witness_names
from relforest.reports.volume_panel import draw_volume
from relforest.scenes import Scenes
from relforest.support.errors import InputError
from relforest.trees import Question, Tree
from relforest.trees.nodes import variable_name
from relforest.volumes import Arc, Volume

_MARGIN: Final = 0.25
_PANEL_WIDTH: Final = 2.75
_PLOT: Final = (2.05, 1.75)
_PLOT_LEFT: Final = 0.55
_TITLE: Final = 9.5
_TABLE: Final = 7.5
_SHAPE: Final = 1.5
_MOST_AXES: Final = 3
_MOST_NUMBERS: Final = 4


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
        Scenes whose points are drawn behind each volume.
    labels : (n_scenes,) bool, optional
        True for the positive ones of them.
    points : mapping of int to QuestionPoints, optional
        The points themselves, by node index, where there are no scenes.
    highlight : Scenes, optional
        One scene whose way through the tree is marked, with the objects that decided.
    title : str
        Above the picture.

    Returns
    -------
    matplotlib.figure.Figure
        As large as the tree needs.

    Raises
    ------
    InputError
        If scenes come without labels or do not fit the tree, or more than one scene is to be highlighted.
    """
    if (scenes is None) != (labels is None):
        raise InputError("scenes and labels belong together: pass both or neither")
    if scenes is not None:
        points = question_points(tree, scenes, np.asarray(labels, dtype=np.bool_))
    path = None if highlight is None else tree_path(tree, highlight)
    questions = [index for index, node in enumerate(tree.nodes) if isinstance(node, Question)]
    names = {index: f"Q{number}" for number, index in enumerate(questions, start=1)}
    texts = node_texts(tree, names, path)
    layout = lay_out(tree.nodes, [text.size for text in texts])
    heads = _head_lines(tree, path, title)
    with styled():
        return _compose(tree, layout, names, dict(points or {}), (texts, path, heads))
