"""Labels as classifiers accept them."""

from __future__ import annotations

import warnings
from numbers import Real
from typing import TYPE_CHECKING, Any

import numpy as np
from sklearn.exceptions import DataConversionWarning

from relforest.support.errors import InputError
from relforest.support.masks import refuse_masked

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray


_NUMBERS = (Real, np.bool_)


def class_labels(y: ArrayLike, n_expected: int, *, what: str) -> tuple[NDArray[Any], NDArray[np.int64]]:
    """Check the labels of two or more classes.

    Parameters
    ----------
    y : (n_expected,) array-like
        Numbers, booleans or strings.
    n_expected : int
        How many labels there should be.
    what : str
        The labelled things, for error messages: "scenes" or "bags".

    Returns
    -------
    classes : (n_classes,) array
        The labels in sorted order.
    codes : (n_expected,) int64
        Which of them each label is.

    Raises
    ------
    InputError
        If the number of labels is wrong, a label is missing, masked, NaN or infinite, there is only one class
        or more than one for two labels. Messages use scikit-learn's wording where possible.
    """
    classes, codes = _coded_labels(y, n_expected, what=what)
    if len(classes) > 2 and 2 * len(classes) > n_expected:
        raise InputError(
            f"{n_expected} {what} have {len(classes)} classes: give at least two {what} a class on average, "
            "or learn a number by regression"
        )
    return classes, codes


def _coded_labels(y: ArrayLike, n_expected: int, *, what: str) -> tuple[NDArray[Any], NDArray[np.int64]]:
    """Return the classes in sorted order, at least two, and which one each label is."""
    labels = _checked_labels(y, n_expected, what=what)
    classes, codes = np.unique(labels, return_inverse=True)
    if len(classes) < 2:
        if not len(classes):
            raise InputError(f"there are no {what} to learn from: labels of 2 classes are needed")
        raise InputError(
            f"labels of 2 classes are needed, but {len(labels)} {what} have only 1 class: {classes[0]}"
        )
    return classes, codes.astype(np.int64)


def _checked_labels(y: ArrayLike, n_expected: int, *, what: str) -> NDArray[Any]:
    """Return labels of one type, all of them known, as a one-dimensional array."""
    labels = _column(y)
    if isinstance(y, (list, tuple)) and labels.dtype.kind == "U" and not all(isinstance(v, str) for v in y):
        # NumPy has converted numbers to strings.
        labels = np.array(y, dtype=object)
    if len(labels) != n_expected:
        raise InputError(f"got {len(labels)} labels for {n_expected} {what}: give one label for each")
    if labels.dtype.kind == "O":
        labels = _of_one_type(labels, what)
    code = labels.dtype.kind
    if code == "f":
        if not np.isfinite(labels).all():
            raise InputError(
                f"labels contain NaN or infinite values: give each of the {what} one of the classes"
            )
        if (labels != np.floor(labels)).any():
            raise InputError(
                "Unknown label type: continuous. The labels must be of two classes, such as 0 and 1: compare "
                "your values with a threshold"
            )
    elif code not in "biuUOT":
        raise InputError(_unknown(labels[0], what))
    return labels


def _column(y: ArrayLike) -> NDArray[Any]:
    """Return labels as a one-dimensional array."""
    refuse_masked(y, "y")
    try:
        labels = np.asarray(y)
    except ValueError as error:
        raise InputError("y should be a 1d array, got a nested sequence of unequal lengths") from error
    if labels.ndim == 2 and labels.shape[1] == 1:
        warnings.warn(
            "A column-vector y was passed when a 1d array was expected. Please change the shape of y to "
            "(n_samples,), for example using ravel().",
            DataConversionWarning,
            stacklevel=5,
        )
        labels = labels.ravel()
    if labels.ndim != 1:
        raise InputError(f"y should be a 1d array, got an array of shape {labels.shape} instead.")
    return labels


def _of_one_type(labels: NDArray[Any], what: str) -> NDArray[Any]:
    """Return an object array unchanged if all labels are strings, and as numbers if all are numbers."""
    if all(isinstance(label, str) for label in labels):
        return labels
    # NumPy's time differences are instances of its integers.
    odd = [label for label in labels if not isinstance(label, _NUMBERS) or isinstance(label, np.timedelta64)]
    if odd:
        raise InputError(_unknown(odd[0], what))
    return np.array(labels.tolist())


def _unknown(label: object, what: str) -> str:
    return (
        f"Unknown label type: the labels contain {label!r}; give each of the {what} one of two classes, both "
        "numbers, booleans or strings"
    )
