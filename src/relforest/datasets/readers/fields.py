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

__all__ = ["FieldError", "at_line", "number", "positive_labels", "read_text"]

_POSITIVE: Final = frozenset({"1", "+1", "1.0", "true"})
_NEGATIVE: Final = frozenset({"0", "-1", "0.0", "-1.0", "false"})


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


def read_text(path: str | os.PathLike[str]) -> str:
    """Return the text of a file with newlines as line ends.

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
    return text.replace("\r\n", "\n").replace("\r", "\n")


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
        1 or 0, 1 or -1, true or false, or any two others if ``positive`` is given.
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
    meanings = {label: label.strip().lower() for label in distinct}
    negatives = {meaning for meaning in meanings.values() if meaning not in _POSITIVE}
    if not negatives <= _NEGATIVE:
        raise InputError(
            f"{origin}: the labels are {listed}, not 0 and 1: say which one is positive, for instance "
            f"positive={distinct[-1]!r}"
        )
    if len({meaning.removesuffix(".0") for meaning in negatives}) > 1:
        raise InputError(f"{origin}: there are more than two labels, {listed}: only two classes can be read")
    return np.array([meanings[label] in _POSITIVE for label in labels], dtype=np.bool_)
