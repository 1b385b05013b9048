"""The data sets that the committee was designed with, and its variants."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final, final

from relforest.experiments.mil.data import DATA_SETS
from relforest.experiments.mil.settings import REPRODUCED
from relforest.mil.volume_panels import PANELS


@final
@dataclass(frozen=True, slots=True)
class AblationSetting:
    """One data set."""

    data_set: str  # a key of `TITLES`
    draws: int = 10
    """Pairs of a training and a test set; of Musk 1, folds of repeated 10-fold cross validation."""
    n_bags: int = 0  # bags in each synthetic set; 0 for as many as its generator draws by default
    is_whole: bool = True  # whether all variants are run, or just the published algorithm and the committee

    @property
    def variants(self) -> tuple[str, ...]:
        """Keys of `VARIANTS`."""
        return tuple(VARIANTS) if self.is_whole else (PUBLISHED, COMMITTEE)

    def __str__(self) -> str:
        """Return the title of the data set."""
        return TITLES[self.data_set]


MUSK: Final = "musk1"
TITLES: Final[Mapping[str, str]] = {
    **{name: DATA_SETS[name].title for name in ("color", *REPRODUCED)},
    "three-parts": "three parts",
    "rare": "rare",
    "wide": "wide",
    "elements": "elements",
    "digits": "digits",
    "digit-mixture": "digit mixture",
    MUSK: DATA_SETS[MUSK].title,
}
MODELLED: Final = ("rare", "wide", "elements")
"""Made-up sets that imitate facts of published ones, on which `mil` should compare independently."""

PUBLISHED: Final = "CovAgg"
COMMITTEE: Final = "committee"
# Name -> options of the committee; None stands for the published algorithm.
VARIANTS: Final[Mapping[str, Mapping[str, Any] | None]] = {
    PUBLISHED: None,
    COMMITTEE: {},
    "all panels alike": {"n_splits": 1},
    **{f"only {name}": {"panels": (name,)} for name in PANELS},
    **{f"without {name}": {"panels": tuple(other for other in PANELS if other != name)} for name in PANELS},
}

# Two repetitions of cross validation, since its folds share most of their bags.
SETTINGS: Final = tuple(
    AblationSetting(data_set, draws=20 if data_set == MUSK else 10) for data_set in TITLES
)
SMOKE: Final = tuple(
    AblationSetting(data_set, draws=2, n_bags=12, is_whole=False)
    for data_set in ("color", "covariant1", "disjunctive", "digits")
)
