from .corridor_figure import BellmanErrors, LeafBand, corridor_figure
from .figure_files import save_figure
from .learning_figure import leaves_figure, reward_figure
from .policy_figure import policy_figure
from .question_points import QuestionPoints, question_points
from .run_report import run_report
from .tree_figure import tree_figure

__all__ = [
    "BellmanErrors",
    "LeafBand",
    "QuestionPoints",
    "corridor_figure",
    "leaves_figure",
    "policy_figure",
    "question_points",
    "reward_figure",
    "run_report",
    "save_figure",
    "tree_figure",
]
