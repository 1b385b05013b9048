"""The data sets, and what the source reports on them."""

from __future__ import annotations

from dataclasses import dataclass
from types import MappingProxyType
from typing import Final, final


@final
@dataclass(frozen=True, slots=True)
class CovAggSetting:
    """One data set.

    Parameters
    ----------
    data_set : str
        A key of `TITLES`.
    pairs : int
        Independent pairs of a training and a test set.
    n_bags : int
        Bags in each of these sets.
    """

    data_set: str
    pairs: int = 100
    n_bags: int = 100

    def __str__(self) -> str:
        """Return the title of the data set."""
        return TITLES[self.data_set]


@final
@dataclass(frozen=True, slots=True)
class Expected:
    """What is known about a data set.

    Parameters
    ----------
    source : float
        Mean Peirce skill score of Palmer (2015), Table 3.2.
    half_width : float
        Half the width of the source's 95 % interval.
    threshold : float
        What the mean must reach, less one standard error.
    """

    source: float
    half_width: float
    threshold: float


TITLES: Final = MappingProxyType(
    {
        "covariant1-sqrt2": "Covariant 1, means at distance 2",
        "covariant1-printed": "Covariant 1, means as printed",
        "covariant2": "Covariant 2",
        "disjunctive": "Disjunctive",
    }
)

# The two readings of Covariant 1 have one line in the source; the first one reproduces it.
EXPECTED: Final = MappingProxyType(
    {
        "covariant1-sqrt2": Expected(0.76, 0.02, 0.75),
        "covariant1-printed": Expected(0.76, 0.02, 0.91),
        "covariant2": Expected(0.27, 0.02, 0.24),
        "disjunctive": Expected(0.27, 0.02, 0.26),
    }
)

SETTINGS: Final = tuple(CovAggSetting(data_set) for data_set in TITLES)
SMOKE: Final = tuple(CovAggSetting(data_set, pairs=3, n_bags=16) for data_set in TITLES)
