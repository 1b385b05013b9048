"""Checks of options; each returns a plain Python value, or raises an error that names the option."""

from __future__ import annotations

import math
import numbers
from collections.abc import Sequence
from contextlib import suppress

from relforest.support.errors import InputError


def at_least(name: str, value: object, low: int) -> int:
    """Check that an option is an integer of at least ``low``.

    Parameters
    ----------
    name : str
        Name of the option, for error messages.
    value : object
        Any integer, including NumPy's, but not a boolean or float.
    low : int
        The smallest value allowed.

    Returns
    -------
    int
        ``value`` as a Python integer.

    Raises
    ------
    InputError
        If ``value`` is not an integer, or is less than ``low``.
    """
    if isinstance(value, bool) or not isinstance(value, numbers.Integral) or value < low:
        raise InputError(f"{name} must be an integer of at least {low}, got {value!r}")
    return int(value)


def between(name: str, value: object, low: int, high: int) -> int:
    """Check that an option is an integer from ``low`` to ``high``, both included.

    Parameters
    ----------
    name : str
        The name of the option, as the user wrote it.
    value : object
        Any integer, NumPy's included; booleans and floats are refused.
    low, high : int
        The smallest and the largest value allowed.

    Returns
    -------
    int
        ``value`` as a Python integer.

    Raises
    ------
    InputError
        If ``value`` is not an integer, or lies outside the bounds.
    """
    if not isinstance(value, bool) and isinstance(value, numbers.Integral):
        number = int(value)
        if low <= number <= high:
            return number
    raise InputError(f"{name} must be an integer from {low} to {high}, got {value!r}")


def in_range(
    name: str,
    value: object,
    low: float,
    high: float,
    *,
    open_low: bool = False,
    open_high: bool = False,
) -> float:
    """Check that an option is a number between two bounds.

    Parameters
    ----------
    name : str
        Name of the option, for error messages.
    value : object
        Any real number, including NumPy's, but not a boolean or NaN.
    low, high : float
        The bounds; use ``math.inf`` and ``open_high=True`` for any finite number of at least ``low``.
    open_low, open_high : bool
        Whether to exclude the bound itself.

    Returns
    -------
    float
        ``value`` as a Python float.

    Raises
    ------
    InputError
        If ``value`` is not a number, or is out of bounds.
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
    """Check that an option is one of several words.

    Parameters
    ----------
    name : str
        Name of the option, for error messages.
    value : object
        The word to check.
    choices : sequence of str
        The allowed words.

    Returns
    -------
    str
        ``value``.

    Raises
    ------
    InputError
        If ``value`` is not in ``choices``.
    """
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
