"""Labels written as text: converted to values where that loses nothing, otherwise kept."""

from __future__ import annotations

from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

# One spelling at a time: if spellings are mixed, they are different labels.
_BOOLEANS: Final = (
    {"false": False, "true": True},
    {"False": False, "True": True},
    {"FALSE": False, "TRUE": True},
)


def parsed_labels(labels: NDArray[Any]) -> NDArray[Any]:
    """Return strings as integers, booleans or floats if each is the usual spelling of its value.

    Labels (n,) are returned unchanged unless all are such strings, which ``01`` is not.
    """
    texts = set(labels.tolist())
    if not texts or not all(isinstance(text, str) for text in texts):
        return labels
    integers = _spelled(texts, int)
    numbers = integers | _spelled(texts, float)
    for values in (*_BOOLEANS, integers, numbers):
        # "1" and "1.0" are one number, but two labels.
        if texts <= values.keys() and len(set(values.values())) == len(values):
            return np.array([values[text] for text in labels])
    return labels


def parsed_label(text: str) -> bool | int | float | str:
    """Return one label as `parsed_labels` reads it."""
    label: bool | int | float | str = parsed_labels(np.array([text], dtype=object)).tolist()[0]
    return label


def _spelled(texts: set[str], number_type: type[int | float]) -> dict[str, int | float]:
    """Return the numbers among texts that are spelled as Python spells them."""
    numbers = {}
    for text in texts:
        try:
            number = number_type(text)
        except ValueError:
            continue
        if str(number) == text and abs(number) < 2**63:
            numbers[text] = number
    return numbers
