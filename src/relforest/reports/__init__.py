"""Pictures and texts about what was learned; nothing here learns or decides.

`tree_figure` draws a tree with its decision volumes, `reward_figure` and `leaves_figure` show how learning
went on, `corridor_figure` the action values of a one-dimensional world, and `run_report` tells about a run in
words. `save_figure` writes any figure as PNG or SVG, always with the same bytes; `style` is the common look.
"""

from __future__ import annotations

from relforest.reports.corridor_figure import BellmanErrors, LeafBand, corridor_figure
from relforest.reports.figure_files import save_figure
from relforest.reports.learning_figure import leaves_figure, reward_figure
from relforest.reports.question_points import QuestionPoints, question_points
from relforest.reports.run_report import run_report
from relforest.reports.tree_figure import tree_figure

__all__ = [
    "BellmanErrors",
    "LeafBand",
    "QuestionPoints",
    "corridor_figure",
    "leaves_figure",
    "question_points",
    "reward_figure",
    "run_report",
    "save_figure",
    "tree_figure",
]
