"""The tasks, and how many scenes and trees there are."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final, Literal, final

Part = Literal["models", "networks", "protocol"]

BALANCE: Final = "balance"
DROP_ON: Final = "drop-on"
KEEPAWAY: Final = "keepaway"
TASKS: Final[Mapping[str, str]] = {
    BALANCE: "balance scale",
    DROP_ON: "dropOn",
    KEEPAWAY: "keepaway pass",
}
SMALL: Final = "small"
LARGE: Final = "large"
SIZES: Final = (SMALL, LARGE)


@final
@dataclass(frozen=True, slots=True)
class OutcomeSetting:
    """A task and a draw of its scenes."""

    task: str  # a key of `TASKS`
    draw: int  # number of the draw
    part: Part = "models"
    """All models on the same scenes, neural networks on these, or the source's experiment with forests of
    SMRF trees."""
    n_scenes: int = 500  # scenes to learn from
    n_test: int = 5000  # scenes of each size to be tested on; in the source's experiment its second set
    smrf_trees: int = 50  # SMRF trees of a forest
    repeats: int = 0  # draws of trees from the forest, in the source's experiment

    def __str__(self) -> str:
        """Return part, task and draw."""
        return f"{self.part}: {TASKS[self.task]}, draw {self.draw}"


N_DRAWS: Final = 5

OURS: Final = "outcome forest"
SMRF: Final = "SMRF trees"
OF_2012: Final = "SMRF trees, 2012"
DEEP_SETS: Final = "Deep Sets"
ATTENTION: Final = "attention"
POOLED: Final = ("boosting, pooled", "forest, pooled", "SVM, padded")
RIVALS: Final = (*POOLED, DEEP_SETS, ATTENTION)

CURVE: Final = (1, 2, 3, 5, 8, 12, 18, 25)
"""Trees for either labelling that are drawn, of 50 each; the last is the source's forest."""

_EVERY: Final = tuple((task, draw) for draw in range(N_DRAWS) for task in TASKS)
SETTINGS: Final = (
    *(OutcomeSetting(*each, part) for each in _EVERY for part in ("models", "networks")),
    *(OutcomeSetting(task, 0, "protocol", n_test=500, smrf_trees=100, repeats=20) for task in TASKS),
)
SMOKE: Final = (
    OutcomeSetting(BALANCE, 0, n_scenes=40, n_test=60, smrf_trees=2),
    OutcomeSetting(BALANCE, 1, n_scenes=40, n_test=60, smrf_trees=2),
    OutcomeSetting(BALANCE, 0, "protocol", n_scenes=40, n_test=60, smrf_trees=4, repeats=2),
)
