"""Identifiers of scenes, objects and bags: all integers (int64) or all strings (object arrays)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from relforest.support.errors import InputError

__all__ = ["IdArray", "as_ids", "codes_by_appearance", "plain"]

IdArray = NDArray[Any]


def as_ids(what: str, values: Sequence[object] | IdArray) -> IdArray:
    """Return identifiers as a read-only int64 or object (str) array of shape (n,).

    Parameters
    ----------
    what : str
        Name for error messages, such as ``"scene_ids"``.
    values : sequence or array
        Integers or strings; an object array is taken to hold one of the two already.

    Raises
    ------
    InputError
        If the values are of another type, or integers and strings are mixed.
    """
    array = values if isinstance(values, np.ndarray) else _from_sequence(what, list(values))
    if array.ndim != 1:
        raise InputError(f"{what} must be one-dimensional, got the shape {array.shape}")
    if array.dtype.kind in "iu":
        ids: IdArray = array.astype(np.int64, copy=False)
    elif array.dtype.kind in "UO":
        ids = array.astype(object, copy=False)
    else:
        raise InputError(f"{what} must be integers or strings, got {array.dtype}: convert them to strings")
    view = ids.view()
    view.flags.writeable = False
    return view


def codes_by_appearance(ids: IdArray) -> tuple[NDArray[np.int64], IdArray]:
    """Return the distinct identifiers in order of first appearance, and which one each entry is.

    Returns
    -------
    codes : (n,) int64 array
        The number of each entry's identifier.
    distinct : (k,) array
        The identifiers, by number.
    """
    _, first, inverse = np.unique(ids, return_index=True, return_inverse=True)
    by_appearance = np.argsort(first)
    number = np.empty(len(first), dtype=np.int64)
    number[by_appearance] = np.arange(len(first))
    return number[inverse.ravel()], ids[first[by_appearance]]


def plain(value: object) -> object:
    """Return one identifier as a Python int or str, for messages and JSON."""
    return value.item() if isinstance(value, np.generic) else value


def _from_sequence(what: str, values: list[object]) -> IdArray:
    is_integer = [isinstance(value, (int, np.integer)) and not isinstance(value, bool) for value in values]
    if all(is_integer):
        try:
            return np.array(values, dtype=np.int64)
        except OverflowError as error:
            raise InputError(f"{what} exceed 64-bit integers: convert them to strings") from error
    odd = [value for value, integer in zip(values, is_integer, strict=True) if not integer]
    wrong = [value for value in odd if not isinstance(value, str)]
    if wrong:
        raise InputError(f"{what} must be integers or strings, got {wrong[0]!r}: convert them to strings")
    if len(odd) < len(values):
        raise InputError(
            f"{what} mix integers and strings (such as {odd[0]!r}): convert all of them to strings"
        )
    return np.array([str(value) for value in values], dtype=object)
