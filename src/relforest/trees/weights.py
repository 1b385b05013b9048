"""Real targets, and weights of scenes and classes, as scikit-learn's users give them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from relforest.support.errors import InputError
from relforest.support.masks import refuse_masked

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

ClassWeight = Mapping[Any, float] | Literal["balanced"] | None


def real_values(y: ArrayLike, n_expected: int, *, otherwise: str = "") -> NDArray[np.float64]:
    """Return real targets as float64, finite or not.

    Raises
    ------
    InputError
        If their number is wrong, one is missing or no number; then the message says what to do `otherwise`.
    """
    refuse_masked(y, "y")
    try:
        values = np.asarray(y, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise InputError(f"targets must be numbers: {otherwise or error}") from error
    if values.shape != (n_expected,):
        raise InputError(
            f"got targets of shape {values.shape} for {n_expected} scenes: give one number for each"
        )
    return values


def scene_weights(sample_weight: ArrayLike | None, n_expected: int) -> NDArray[np.float64] | None:
    """Check the weights of scenes.

    Raises
    ------
    InputError
        If their number is wrong, one is negative, NaN or infinite, or all are zero.
    """
    if sample_weight is None:
        return None
    refuse_masked(sample_weight, "sample_weight")
    try:
        weights = np.asarray(sample_weight, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise InputError("weights must be numbers") from error
    if weights.shape != (n_expected,):
        raise InputError(
            f"got weights of shape {weights.shape} for {n_expected} scenes: give one number for each"
        )
    # The negated test also catches NaN.
    if not ((weights >= 0.0) & (weights < np.inf)).all():
        raise InputError("weights must be finite numbers of at least 0")
    if not weights.any():
        raise InputError("all weights are 0: give some scenes a positive weight")
    return weights


def class_weights(
    class_weight: ClassWeight,
    classes: NDArray[Any],
    codes: NDArray[np.int64],
    weights: NDArray[np.float64] | None,
) -> NDArray[np.float64] | None:
    """Return the weight of each class, None if all weigh the same.

    With "balanced", scenes count with their weights (n_scenes,); `codes` (n_scenes,) are their classes.

    Raises
    ------
    InputError
        If a key of the mapping is no class, or the argument is something else.
    """
    if class_weight is None:
        return None
    if isinstance(class_weight, str) and class_weight == "balanced":
        counts = np.bincount(codes, weights, minlength=len(classes))
        shares: NDArray[np.float64] = counts / counts.sum()
        return np.divide(1.0 / len(classes), shares, out=np.zeros(len(classes)), where=shares > 0)
    if not isinstance(class_weight, Mapping):
        raise InputError(f'class_weight must be "balanced", a mapping or None, got {class_weight!r}')
    known = classes.tolist()
    unknown = [label for label in class_weight if label not in known]
    if unknown:
        listed = ", ".join(map(repr, known))
        raise InputError(f"class_weight names {unknown[0]!r}, which is no class: the classes are {listed}")
    return np.array([float(class_weight.get(label, 1.0)) for label in known])
