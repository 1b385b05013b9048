"""Fields of all formats: text, numbers and labels."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Final, final

import numpy as np
from numpy.typing import NDArray

from relforest.support.errors import InputError

_PLAIN: Final = {
    "1": 1,
    "+1": 1,
    "1.0": 1,
    "true": 1,
    "0": 0,
    "0.0": 0,
    "false": 0,
    "-1": -1,
    "-1.0": -1,
}


@final
class FieldError(InputError):
    """A field cannot be used; the reader adds its place."""


@contextmanager
def at_line(origin: str, line_number: int) -> Iterator[None]:
    """Add the place to the message of a `FieldError`."""
    try:
        yield
    except FieldError as error:
        raise InputError(f"{origin}, line {line_number}: {error}") from error


def split_lines(text: str) -> list[str]:
    """Return the lines of a text, which may end with a newline, a carriage return or both."""
    return text.replace("\r\n", "\n").replace("\r", "\n").split("\n")


def number(text: str, decimal: str = ".") -> float:
    """Return the number in a field.

    Raises
    ------
    FieldError
        If it is not a finite number.
    """
    # Python would read 1_0 as 10; with a decimal comma, a point could only divide groups of digits.
    is_plain = "_" not in text and (decimal == "." or "." not in text)
    try:
        value = float(text.replace(decimal, ".")) if is_plain else math.nan
    except ValueError:
        value = math.nan
    if math.isfinite(value):
        return value
    if "," in text and decimal == ".":
        raise FieldError(
            f"{text!r} is not a finite number: if the comma is the decimal mark, pass decimal=','"
        )
    raise FieldError(
        f"{text!r} is not a finite number: correct it, or remove the instance if the value is missing"
    )


def positive_labels(labels: Sequence[str], positive: str | None, origin: str) -> NDArray[np.bool_]:
    """Return which labels are positive.

    Parameters
    ----------
    labels : sequence of str
        1 (positive) or 0, 1 or -1, true or false, or any two others if ``positive`` is given.
    positive : str or None
        The label of positive bags.
    origin : str
        The file, for messages.

    Returns
    -------
    (n,) bool

    Raises
    ------
    InputError
        If there are more than two labels, ``positive`` is not among them, or it is needed and not given.
    """
    distinct = sorted(set(labels))
    listed = ", ".join(map(repr, distinct[:5])) + (", ..." if len(distinct) > 5 else "")
    if positive is not None:
        if len(distinct) > 2 or positive not in distinct:
            raise InputError(
                f"{origin}: positive={positive!r} must be one of two labels, but the file has {listed}"
            )
        return np.array([label == positive for label in labels], dtype=np.bool_)
    values = {label: _PLAIN.get(label.strip().lower()) for label in distinct}
    meanings = set(values.values())
    if len(distinct) > 2 and (None in meanings or len(meanings) > 2):
        raise InputError(f"{origin}: more than two labels, {listed}: only two classes are supported")
    if None in meanings or meanings == {0, -1}:
        choices = " or ".join(f"positive={label!r}" for label in distinct)
        raise InputError(
            f"{origin}: it is ambiguous which of the labels {listed} is positive: give {choices}"
        )
    return np.array([values[label] == 1 for label in labels], dtype=np.bool_)
