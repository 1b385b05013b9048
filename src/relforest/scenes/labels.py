"""Binary labels as classifiers accept them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, final

import numpy as np
from sklearn.utils.multiclass import check_classification_targets
from sklearn.utils.validation import column_or_1d

from relforest.support.errors import InputError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray


@final
@dataclass(frozen=True, slots=True, eq=False)
class BinaryLabels:
    """Two classes and who belongs to the second one.

    Parameters
    ----------
    classes : ndarray (2,)
        The labels in sorted order; ``classes[1]`` is the positive class.
    positive : bool ndarray (n,)
        True where the label is ``classes[1]``.
    """

    classes: NDArray[Any]
    positive: NDArray[np.bool_]


def binary_labels(y: ArrayLike, n_expected: int, *, what: str) -> BinaryLabels:
    """Check labels and tell positive from negative.

    Parameters
    ----------
    y : array-like (n_expected,)
        0 and 1, -1 and +1, booleans, or two strings.
    n_expected : int
        How many labels there should be.
    what : str
        What is labelled, for messages: "scenes" or "bags".

    Raises
    ------
    InputError
        If the number of labels is wrong, one is NaN or infinite, or there are not exactly two classes.
    """
    labels = column_or_1d(y, warn=True)
    if len(labels) != n_expected:
        msg = f"got {len(labels)} labels for {n_expected} {what}: give one label for each"
        raise InputError(msg)
    if labels.dtype.kind == "f" and not np.isfinite(labels).all():
        msg = f"labels hold NaN or infinite values: give each of the {what} one of two classes"
        raise InputError(msg)
    check_classification_targets(labels)
    classes = np.unique(labels)
    if len(classes) > 2:
        listed = ", ".join(map(str, classes[:5]))
        msg = (
            "Only binary classification is supported. The type of the target is multiclass: "
            f"{len(classes)} classes ({listed}...); label each of the {what} positive or negative"
        )
        raise InputError(msg)
    if len(classes) < 2:
        listed = ", ".join(map(str, classes)) or "none"
        msg = f"labels of 2 classes are needed, but {len(labels)} {what} have only 1 class: {listed}"
        raise InputError(msg)
    return BinaryLabels(classes, labels == classes[1])
