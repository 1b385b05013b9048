"""Statements as rows of numbers: what they say about one or two numbers of a choice of objects."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

import numpy as np

from relforest.mappings.kernels import wrap_angle
from relforest.support.jit import inlined

if TYPE_CHECKING:
    from numpy.typing import NDArray

# A statement as a row of numbers, by these columns. It is true where its value is at most the limit.
FORM: Final = 0
FIRST: Final = 1  # where the number is found
SECOND: Final = 2  # where another one is, -1 = none
CENTRE: Final = 3  # two numbers
WEIGHT: Final = 5  # two numbers, 1 / radius^2
LIMIT: Final = 7
N_NUMBERS: Final = 8

AT_MOST: Final = 0
AT_LEAST: Final = 1
SMALL: Final = 2  # the absolute value is at most ...
LARGE: Final = 3
NEAR: Final = 4
NEAR_ANGLE: Final = 5
IS: Final = 6
IS_NOT: Final = 7


@inlined
def value(statement: NDArray[np.float64], x: float, y: float) -> float:
    """The value of a statement about the number x, and y if it is about two (else 0); NaN where undefined."""
    form = statement[FORM]
    result = x
    if form >= IS:
        same = x == statement[CENTRE]
        result = np.nan if math.isnan(x) else (0.0 if same == (form == IS) else 1.0)
    elif form >= NEAR:
        away = x - statement[CENTRE]
        if form == NEAR_ANGLE:
            away = wrap_angle(away)
        result = statement[WEIGHT] * away * away
        away = y - statement[CENTRE + 1]
        result += statement[WEIGHT + 1] * away * away
    elif form == AT_LEAST:
        result = -x
    elif form == SMALL:
        result = abs(x)
    elif form == LARGE:
        result = -abs(x)
    return float(result)
