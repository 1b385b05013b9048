"""Refusing masked values, for which NumPy's conversions use the data under the mask."""

from __future__ import annotations

import numpy as np

from relforest.support.errors import InputError


def refuse_masked(values: object, what: str) -> None:
    """Raise an `InputError` if an array, or one inside a nested list, has masked values."""
    if isinstance(values, np.ma.MaskedArray):
        if np.ma.getmaskarray(values).any():
            raise InputError(f"{what} has masked values: leave them out or fill them in")
    elif isinstance(values, (list, tuple)):
        for entry in values:
            refuse_masked(entry, what)
