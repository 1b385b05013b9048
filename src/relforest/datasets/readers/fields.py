"""What the fields of all formats have in common: text, numbers and labels."""

from __future__ import annotations

import math
import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Final, final

import numpy as np
from numpy.typing import NDArray

from relforest.support.errors import InputError
from relforest.support.files import read_input, unpacked

__all__ = ["FieldError", "at_line", "number", "positive_labels", "read_lines", "split_lines"]

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
    """A field cannot be used; the reader that knows the place says where it stands."""


@contextmanager
def at_line(path: str | os.PathLike[str], line_number: int) -> Iterator[None]:
    """Say where it is what a `FieldError` complains of."""
    try:
        yield
    except FieldError as error:
        raise InputError(f"{path}, line {line_number}: {error}") from error


def split_lines(text: str) -> list[str]:
    """Return the lines of a text, which may end with a newline, a carriage return or both."""
    return text.replace("\r\n", "\n").replace("\r", "\n").split("\n")


def read_lines(path: str | os.PathLike[str]) -> list[str]:
    """Return the lines of a text file.

    Raises
    ------
    InputError
        If the file cannot be read or unpacked, or is not UTF-8.
    """
    data = unpacked(read_input(path), str(path))
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data[: error.start].count(b"\n") + 1
        raise InputError(f"{path}, line {line}: this is not UTF-8 text; convert the file first") from error
    return split_lines(text)


def number(text: str) -> float:
    """Return the number that a field holds.

    Raises
    ------
    FieldError
        If it holds none, or one that is not finite.
    """
    try:
        # Python would read 1_0 as 10.
        value = math.nan if "_" in text else float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise FieldError(
            f"{text!r} is no finite number: correct it, or leave the instance out if the value is missing"
        )
    return value


def positive_labels(labels: Sequence[str], positive: str | None, origin: str) -> NDArray[np.bool_]:
    """Tell positive labels from negative ones.

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
        raise InputError(f"{origin}: there are more than two labels, {listed}: only two classes can be read")
    if None in meanings or meanings == {0, -1}:
        choices = " or ".join(f"positive={label!r}" for label in distinct)
        raise InputError(
            f"{origin}: it is ambiguous which of the labels {listed} is positive: give {choices}"
        )
    return np.array([values[label] == 1 for label in labels], dtype=np.bool_)
