"""Weights of bags, as classifiers accept them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from relforest.scenes.ids import plain
from relforest.support.errors import InputError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray


def bag_weights(
    sample_weight: ArrayLike | None, codes: NDArray[np.int64], classes: NDArray[Any]
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Check weights of bags.

    Parameters
    ----------
    sample_weight : (n_bags,) array-like or None
        None for equal weights.
    codes : (n_bags,) int64
        Which class each bag belongs to.
    classes : (n_classes,) array
        Names of the classes.

    Returns
    -------
    weights : (n_bags,) float64
        The mean of those above 0 is 1.
    kept : (n_kept,) int64
        Which are above 0.

    Raises
    ------
    InputError
        If there is not one finite number of at least 0 for each bag, or all bags of a class have weight 0.
    """
    if sample_weight is None:
        return np.ones(len(codes)), np.arange(len(codes))
    try:
        weights = np.asarray(sample_weight, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise InputError("sample_weight must contain numbers, one for each bag") from error
    if weights.ndim != 1:
        raise InputError(f"sample_weight must be 1-D, one weight for each bag, got the shape {weights.shape}")
    if len(weights) != len(codes):
        raise InputError(f"got {len(weights)} weights for {len(codes)} bags: give one weight for each")
    allowed = np.isfinite(weights) & (weights >= 0.0)
    if not allowed.all():
        bag = int(np.flatnonzero(~allowed)[0])
        raise InputError(f"sample_weight of bag {bag} is {weights[bag]}: weights are finite and at least 0")
    kept = np.flatnonzero(weights)
    gone = np.setdiff1d(np.arange(len(classes)), codes[kept])
    if len(gone):
        raise InputError(
            f"all bags of class {plain(classes[gone[0]])!r} have zero weight: each class needs one above 0"
        )
    # Divided twice, so that the sum of large weights does not overflow.
    weights = weights / weights.max()
    return weights / weights[kept].mean(), kept
