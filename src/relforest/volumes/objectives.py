"""What a decision volume is chosen for: training accuracy or the likelihood of two virtual leaves."""

from __future__ import annotations

from functools import lru_cache
from types import MappingProxyType
from typing import TYPE_CHECKING, Final, Literal

import numpy as np
from scipy.special import xlogy

from relforest.support.jit import kernel

if TYPE_CHECKING:
    from numpy.typing import NDArray

Objective = Literal["accuracy", "log-likelihood"]

ACCURACY: Final = 0
LOG_LIKELIHOOD: Final = 1
OBJECTIVES: Final = MappingProxyType({"accuracy": ACCURACY, "log-likelihood": LOG_LIKELIHOOD})


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
