"""Checks of options.

Each takes the name of the option, as the user wrote it, and a value of any type. It returns the value as a
plain Python one, or raises an `InputError` that names the option and what it may be. NumPy's numbers are
numbers; booleans are not.
"""

from __future__ import annotations

import math
import numbers
from collections.abc import Sequence
from contextlib import suppress

from relforest.support.errors import InputError


def at_least(name: str, value: object, low: int) -> int:
    """Check that an option is an integer of at least ``low``."""
    if isinstance(value, bool) or not isinstance(value, numbers.Integral) or value < low:
        raise InputError(f"{name} must be an integer of at least {low}, got {value!r}")
    return int(value)


def between(name: str, value: object, low: int, high: int) -> int:
    """Check that an option is an integer from ``low`` to ``high``, both included."""
    if isinstance(value, bool) or not isinstance(value, numbers.Integral) or not low <= int(value) <= high:
        raise InputError(f"{name} must be an integer from {low} to {high}, got {value!r}")
    return int(value)


def in_range(
    name: str,
    value: object,
    low: float,
    high: float,
    *,
    open_low: bool = False,
    open_high: bool = False,
) -> float:
    """Check that an option is a number between two bounds, which `open_low` and `open_high` exclude.

    With ``math.inf`` and ``open_high=True``, any finite number of at least ``low`` is allowed.
    """
    if not isinstance(value, bool) and isinstance(value, numbers.Real):
        # An integer too large for a float is outside all bounds.
        with suppress(OverflowError):
            number = float(value)
            above = number > low if open_low else number >= low
            below = number < high if open_high else number <= high
            if above and below:
                return number
    raise InputError(
        f"{name} must be {_described(low, high, open_low=open_low, open_high=open_high)}, got {value!r}"
    )


def one_of(name: str, value: object, choices: Sequence[str]) -> str:
    """Check that an option is one of several words."""
    if isinstance(value, str) and value in choices:
        return value
    known = ", ".join(repr(choice) for choice in choices)
    raise InputError(f"{name} must be one of {known}, got {value!r}")


def _described(low: float, high: float, *, open_low: bool, open_high: bool) -> str:
    parts = []
    if not math.isinf(low):
        parts.append(f"{'above' if open_low else 'of at least'} {low:g}")
    if not math.isinf(high):
        parts.append(f"{'below' if open_high else 'of at most'} {high:g}")
    finite = "finite " if (math.isinf(low) and open_low) or (math.isinf(high) and open_high) else ""
    return " ".join([f"a {finite}number", " and ".join(parts)]).strip()
