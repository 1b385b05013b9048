"""What a decision volume is chosen for: training accuracy or the likelihood of two virtual leaves."""

from __future__ import annotations

import math
from functools import lru_cache
from types import MappingProxyType
from typing import TYPE_CHECKING, Final, Literal

import numpy as np
from scipy.special import xlogy

from relforest.support.jit import inlined, kernel

if TYPE_CHECKING:
    from numpy.typing import NDArray

Objective = Literal["accuracy", "log-likelihood", "weighted-log-likelihood", "squared-error"]

ACCURACY: Final = 0
LOG_LIKELIHOOD: Final = 1
WEIGHTED: Final = 2
SQUARED_ERROR: Final = 3
OBJECTIVES: Final[MappingProxyType[Objective, int]] = MappingProxyType(
    {
        "accuracy": ACCURACY,
        "log-likelihood": LOG_LIKELIHOOD,
        "weighted-log-likelihood": WEIGHTED,
        "squared-error": SQUARED_ERROR,
    }
)


@lru_cache(maxsize=1024)
def entropy_table(n: int) -> NDArray[np.float64]:
    """``k ln k`` for k = 0 .. n, so that no logarithm is taken while volumes are tried; not to be changed."""
    return xlogy(np.arange(n + 1.0), np.arange(n + 1.0))


@kernel
def score_counts(
    objective: int,
    inside_positive: int,
    inside_negative: int,
    totals: tuple[int, int],
    table: NDArray[np.float64],
) -> float:
    """Score of a volume that has these bags inside, of `totals` = (positive, negative) bags.

    "accuracy" (section 3.2.2): the number of correctly labelled bags. "log-likelihood" (section
    4.2): log L of eq. 4.1 for a Yes leaf with the bags inside and a No leaf with those outside;
    minus infinity unless the Yes leaf has the higher probability. Without that condition, which the
    source leaves unsaid, a volume that positives avoid would score just as well.
    """
    positives, negatives = totals
    outside_positive = positives - inside_positive
    outside_negative = negatives - inside_negative
    inside = inside_positive + inside_negative
    outside = outside_positive + outside_negative
    if objective == ACCURACY:
        return float(inside_positive + outside_negative) if inside > 0 else -np.inf
    yes = table[inside_positive] + table[inside_negative] - table[inside]
    no = table[outside_positive] + table[outside_negative] - table[outside]
    admissible = inside_positive * outside > outside_positive * inside
    return float(yes + no) if admissible else -np.inf


@kernel
def score_sums(objective: int, inside: tuple[float, float], totals: tuple[float, float]) -> float:
    """Score of a volume by what the bags inside weigh, and all bags.

    `WEIGHTED`: log L as in `score_counts`, where bags weigh (as a negative, as a positive). `SQUARED_ERROR`:
    bags weigh (weight, weight times value), and the score is the sum of squares that the means inside and
    outside explain; minus infinity unless the mean inside is higher.
    """
    first, second = inside
    other_first, other_second = totals[0] - first, totals[1] - second
    if objective == SQUARED_ERROR:
        if not (first > 0.0 and other_first > 0.0 and second * other_first > other_second * first):
            return -np.inf
        return float(second * second / first + other_second * other_second / other_first)
    all_inside, all_outside = first + second, other_first + other_second
    if not (all_inside > 0.0 and all_outside > 0.0 and second * all_outside > other_second * all_inside):
        return -np.inf
    yes = _log_terms(first, all_inside) + _log_terms(second, all_inside)
    return yes + _log_terms(other_first, all_outside) + _log_terms(other_second, all_outside)


@inlined
def _log_terms(part: float, whole: float) -> float:
    # A difference of sums that should be zero may be a little below.
    return part * math.log(part / whole) if part > 0.0 else 0.0
