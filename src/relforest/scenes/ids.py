"""Identifiers of scenes, objects and bags: all integers (int64) or all strings (object arrays)."""

from __future__ import annotations

from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from relforest.support.errors import InputError

IdArray = NDArray[Any]


def as_ids(what: str, values: object) -> IdArray:
    """Return integers or strings as a read-only int64 or object (str) array (n,).

    Raises
    ------
    InputError
        If the values are of another type, beyond 64 bits, or integers and strings are mixed.
    """
    if isinstance(values, np.ma.MaskedArray):
        raise InputError(f"{what} must not be a masked array: pass a plain one")
    if isinstance(values, (list, tuple)):
        # NumPy would turn the numbers of a mixed list into strings.
        values = _from_sequence(what, list(values))
    array = np.asarray(values)
    if array.ndim != 1:
        raise InputError(f"{what} must be one-dimensional, got the shape {array.shape}")
    if array.dtype.kind == "i":
        ids: IdArray = array.astype(np.int64, copy=False)
    elif array.dtype.kind in "uOUT":
        ids = _from_sequence(what, array.tolist())
    else:
        raise InputError(f"{what} must be integers or strings, got {array.dtype}: convert them to strings")
    view = ids.view()
    view.flags.writeable = False
    return view


def codes_by_appearance(ids: IdArray) -> tuple[NDArray[np.int64], IdArray]:
    """Number identifiers as they appear; return the number of each entry (n,), and the identifiers (k,)."""
    _, first, inverse = np.unique(ids, return_index=True, return_inverse=True)
    by_appearance = np.argsort(first)
    number = np.empty(len(first), dtype=np.int64)
    number[by_appearance] = np.arange(len(first))
    return number[inverse.ravel()], ids[first[by_appearance]]


def plain(value: object) -> object:
    """Return one identifier as a Python int or str, for messages and JSON."""
    return value.item() if isinstance(value, np.generic) else value


def _from_sequence(what: str, values: list[object]) -> IdArray:
    # Types are compared, not values: a batch has few types and many identifiers.
    types = set(map(type, values))
    integers = {each for each in types if issubclass(each, (int, np.integer)) and each is not bool}
    strings = {each for each in types if issubclass(each, str)}
    if types > integers | strings:
        wrong = next(value for value in values if type(value) not in integers | strings)
        raise InputError(f"{what} must be integers or strings, got {wrong!r}: convert them to strings")
    if integers and strings:
        odd = next(value for value in values if isinstance(value, str))
        raise InputError(f"{what} mix integers and strings (such as {odd!r}): convert all of them to strings")
    if not strings:
        try:
            return np.array([int(cast("int", value)) for value in values], dtype=np.int64)
        except OverflowError as error:
            raise InputError(f"{what} exceed 64-bit integers: convert them to strings") from error
    ids = np.empty(len(values), dtype=object)
    ids[:] = values if strings == {str} else list(map(str, values))
    return ids
