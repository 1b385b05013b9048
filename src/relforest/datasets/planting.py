"""Bags that hide one positive point each: how all synthetic bags are put together."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from relforest.datasets.bag_set import BagSet

__all__ = ["plant"]


def plant(rng: np.random.Generator, positives: NDArray[np.float64], bags: NDArray[np.float64]) -> BagSet:
    """Label half of the bags positive and put one positive point into each of those.

    Parameters
    ----------
    rng : numpy.random.Generator
        Source of the order of the labels and of the places.
    positives : (n_bags, d) float64
        A positive point for every bag, used in the positive ones.
    bags : (n_bags, size, d) float64
        Negative points; one in each positive bag is overwritten.

    Returns
    -------
    BagSet
        ``n_bags // 2`` of the bags are positive.

    References
    ----------
    Palmer (2015), section 3.3.1.
    """
    n_bags, size, _ = bags.shape
    labels = np.arange(n_bags) < n_bags // 2
    rng.shuffle(labels)
    places = rng.integers(size, size=(n_bags,))
    bags[labels, places[labels]] = positives[labels]
    return BagSet(list(bags), labels)
