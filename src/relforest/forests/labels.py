"""Labels, targets and weights of scenes, checked before anything is learned."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from relforest.scenes.labels import class_labels
from relforest.support.errors import InputError
from relforest.trees.weights import ClassWeight, class_weights, real_values, scene_weights

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray


class ClassTargets(NamedTuple):
    """The class of each scene."""

    classes: NDArray[Any]  # (n_classes,) in sorted order
    numbers: NDArray[np.int64]  # (n,) place of the label of each scene among them
    weights: NDArray[np.float64]  # (n,) with a mean of 1


def class_targets(
    y: ArrayLike, n: int, sample_weight: ArrayLike | None, class_weight: ClassWeight
) -> ClassTargets:
    """Check labels and weights.

    Raises
    ------
    InputError
        If the labels are not of at least two classes, or a class has no weight; see `scene_weights` as well.
    """
    classes, numbers = class_labels(y, n, what="scenes")
    given = scene_weights(sample_weight, n)
    of_classes = class_weights(class_weight, classes, numbers, given)
    weights = np.ones(n) if given is None else given
    if of_classes is not None:
        weights = weights * of_classes[numbers]
    totals = np.bincount(numbers, weights, len(classes))
    if not (totals > 0).all():
        lost = classes.tolist()[int(np.flatnonzero(totals <= 0)[0])]
        raise InputError(f"all scenes of class {lost!r} have weight 0: give at least one a positive weight")
    return ClassTargets(classes, numbers, weights / weights.mean())


def real_targets(y: ArrayLike, n: int) -> NDArray[np.float64]:
    """Return real targets as float64.

    Raises
    ------
    InputError
        If their number is wrong, one is missing, NaN or infinite, or all are equal.
    """
    values = real_values(y, n)
    wrong = np.flatnonzero(~np.isfinite(values))
    if wrong.size:
        raise InputError(f"target {wrong[0]} is {values[wrong[0]]}: targets must be finite numbers")
    if np.abs(values).max() > 1e50:
        raise InputError("targets exceed 1e50: use other units")
    if values.min() == values.max():
        raise InputError(f"all targets are {values[0]:g}: there is nothing to learn")
    return values


def weights_of(sample_weight: ArrayLike | None, n: int) -> NDArray[np.float64]:
    """Return the weights of scenes, scaled to a mean of 1; see `scene_weights`."""
    weights = scene_weights(sample_weight, n)
    return np.ones(n) if weights is None else weights / weights.mean()
