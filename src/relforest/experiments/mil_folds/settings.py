"""The data sets and the methods whose accuracy on test folds is measured."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, final

from relforest.experiments.mil.data import DATA_SETS, N_FOLDS
from relforest.experiments.mil.methods import BAG_MARGIN, COVAGG, EM_DD, IMPROVED, METHODS, MILES

N_REPETITIONS: Final = 5
COMPARED: Final = ("musk1", "elephant", "fox", "tiger")
TRIED: Final = (IMPROVED, MILES, BAG_MARGIN, EM_DD, COVAGG)


@final
@dataclass(frozen=True, slots=True)
class FoldsSetting:
    """One repetition of 10-fold cross-validation.

    Parameters
    ----------
    data_set : str
        A standard one of `relforest.experiments.mil.data.DATA_SETS`.
    method : str
        A key of `relforest.experiments.mil.methods.METHODS`.
    repetition : int
        Which of the divisions into folds; they are the same for all methods.
    n_folds : int
        How many of the folds are tested.
    """

    data_set: str
    method: str
    repetition: int
    n_folds: int = N_FOLDS

    def __str__(self) -> str:
        """Return the titles of the data set and the method, and the repetition."""
        title = f"{DATA_SETS[self.data_set].title}, {METHODS[self.method].title}"
        return f"{title}, repetition {self.repetition}"


SETTINGS: Final = tuple(
    FoldsSetting(data_set, method, repetition)
    for data_set in COMPARED
    for method in TRIED
    for repetition in range(N_REPETITIONS)
)
SMOKE: Final = tuple(
    FoldsSetting("musk1", method, repetition, 2) for method in (EM_DD, COVAGG) for repetition in (0, 1)
)
