"""Numbers for people: rounded no further than what is said about them stays true."""

from __future__ import annotations

import math
from collections.abc import Iterable
from decimal import Context, Decimal
from typing import Final

LONGEST_VECTOR: Final = 8
"""Vectors of more components are cut."""

# Wide enough for every digit of the largest floating point number.
_WIDE: Final = Context(prec=400)
_LARGEST: Final = math.nextafter(math.inf, 0.0)
_DIGITS: Final = 3
# A plain number may be this much longer than its scientific notation.
_PATIENCE: Final = 4
# An end of an interval this close to 0, relative to the width, is 0 but for rounding errors.
_NOTHING: Final = 1e-12
# Where a probability says something else than its neighbours: impossible, even, certain.
_TURNING_POINTS: Final = frozenset({0.0, 0.5, 1.0})


def rounded(value: float, step: float) -> str:
    """Write `value` with an error of at most half of `step`; not more digits than it has.

    Examples
    --------
    >>> rounded(26.6309, 0.001), rounded(123456.0, 1000.0), rounded(-0.001, 0.1), rounded(0.5, 0.0)
    ('26.631', '123000', '0', '0.5')
    """
    exact = _decimal(value)
    if step > 0.0:
        # A power of ten just below `step` is at most `step`, whatever log10 rounds.
        place = _decimal(step).adjusted()
        if place > int(exact.as_tuple().exponent):
            exact = exact.quantize(Decimal((0, (1,), place)), context=_WIDE)
    if exact.is_zero():
        return "0"
    exact = exact.normalize(_WIDE)
    plain, scientific = f"{exact:f}", f"{exact:e}"
    return plain if len(plain) <= len(scientific) + _PATIENCE else scientific


def number(value: float) -> str:
    """Write `value` with three significant digits.

    Examples
    --------
    >>> number(0.0714285), number(1000.0), number(1.768e200)
    ('0.0714', '1000', '1.77e+200')
    """
    return rounded(value, _own_step(value))


def vector(values: Iterable[float], step: float) -> str:
    """Write a vector in parentheses, every component rounded to `step`; long ones are cut.

    Examples
    --------
    >>> vector([0.498, -0.0073], 0.01)
    '(0.5, -0.01)'
    """
    texts = [rounded(float(value), step) for value in values]
    if len(texts) > LONGEST_VECTOR:
        texts = [*texts[:4], "..."]
    return f"({', '.join(texts)})"


def ends(low: float, high: float) -> tuple[str, str]:
    """Write the two ends of an interval so that they differ as the numbers do.

    Either end is off by at most half a percent of the width, and keeps three significant digits.

    Examples
    --------
    >>> ends(26.57047, 26.63093), ends(3.0, 2e6), ends(-1e-17, 2.0)
    (('26.5705', '26.6309'), ('3', '2000000'), ('0', '2'))
    """
    width = min(high - low, _LARGEST)
    low_text, high_text = (
        "0" if abs(end) <= _NOTHING * width else rounded(end, min(width / 100, _own_step(end)))
        for end in (low, high)
    )
    return low_text, high_text


def probability(value: float) -> str:
    """Write a probability with two decimals, or with more if two would claim 0, 1/2 or 1 wrongly.

    Examples
    --------
    >>> probability(0.25), probability(1.0), probability(0.996), probability(0.499)
    ('0.25', '1.00', '0.996', '0.499')
    """
    for decimals in range(2, 18):
        text = f"{value:.{decimals}f}"
        if float(text) == value or float(text) not in _TURNING_POINTS:
            return text
    return f"{value:.0e}"


def finite(value: float) -> float:
    """Return `value`, or the largest number of its sign if it is infinite."""
    return max(-_LARGEST, min(value, _LARGEST))


def _own_step(value: float) -> float:
    """Return the power of ten of the last of three significant digits."""
    return float(Decimal((0, (1,), _decimal(value).adjusted() - _DIGITS + 1)))


def _decimal(value: float) -> Decimal:
    return Decimal(repr(float(value)))
