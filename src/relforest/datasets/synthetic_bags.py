"""The synthetic bags in the plane of Palmer (2015), section 3.3.1, Table 3.1; `color` is in its own module.

Half of the bags are positive. A positive bag holds exactly one point of a positive distribution, at a random
place among points of the negative distribution; a negative bag holds points of the negative distribution
only.
"""

from __future__ import annotations

from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray

from relforest.datasets.bag_set import BagSet
from relforest.support.options import at_least, one_of

# Square root of [[.52, .48], [.48, .52]]: standard deviations 1 along (1, 1) and 1/5 along (1, -1).
_DIAGONAL_ROOT: Final = np.array([[0.6, 0.4], [0.4, 0.6]])
_SMALL_BAG: Final = 3
_LARGE_BAG: Final = 10
_NEGATIVE_MEANS: Final = {"sqrt2": np.sqrt(2.0), "printed": 2.0}


def covariant1(
    rng: np.random.Generator, *, reading: Literal["sqrt2", "printed"] = "sqrt2", n_bags: int = 100
) -> BagSet:
    """Draw bags of 3 points in the plane: positives on a diagonal between two clouds of negatives.

    Parameters
    ----------
    rng : numpy.random.Generator
        Source of randomness.
    reading : {"sqrt2", "printed"}
        Coordinates of the means of the negatives, (-c, c) and (c, -c): c is the square root of 2, so that
        they lie at distance 2 from the origin, or 2 as printed in Table 3.1.
    n_bags : int
        Number of bags, at least 2; ``n_bags // 2`` of them are positive.

    Returns
    -------
    BagSet
        Bags (3, 2).

    Raises
    ------
    InputError
        If ``reading`` is neither of the two, or ``n_bags`` is less than 2.

    Notes
    -----
    Negatives: 1/2 N((-c, c), I) + 1/2 N((c, -c), I). Positives: N(0, S), S = [[.52, .48], [.48, .52]], whose
    eigenvalues are 1 along (1, 1) and 1/25 along (1, -1). The printed means do not reproduce the scores of
    Table 3.2; means at distance 2 do.

    References
    ----------
    Palmer (2015), section 3.3.1, Table 3.1.
    """
    offset = _NEGATIVE_MEANS[one_of("reading", reading, tuple(_NEGATIVE_MEANS))]
    n_bags = at_least("n_bags", n_bags, 2)
    sides = rng.choice([-1.0, 1.0], size=(n_bags, _SMALL_BAG, 1))
    negatives = rng.standard_normal((n_bags, _SMALL_BAG, 2)) + sides * np.array([offset, -offset])
    return plant(rng, _diagonal(rng, n_bags), negatives)


def covariant2(rng: np.random.Generator, *, n_bags: int = 100) -> BagSet:
    """Draw bags (3, 2) in the plane: positives on a diagonal, inside one cloud of negatives.

    Negatives: N(0, I). Positives, parameters, errors and source: as for `covariant1`.
    """
    n_bags = at_least("n_bags", n_bags, 2)
    negatives = rng.standard_normal((n_bags, _SMALL_BAG, 2))
    return plant(rng, _diagonal(rng, n_bags), negatives)


def disjunctive(rng: np.random.Generator, *, n_bags: int = 100) -> BagSet:
    """Draw bags (10, 2) in the plane: positives in either of two clouds next to the negatives.

    Negatives: N(0, I). Positives: 1/2 N((3, 0), I/2) + 1/2 N((-3, 0), I/2). Parameters, errors and source: as
    for `covariant1`.
    """
    n_bags = at_least("n_bags", n_bags, 2)
    negatives = rng.standard_normal((n_bags, _LARGE_BAG, 2))
    sides = rng.choice([-1.0, 1.0], size=(n_bags, 1))
    positives = np.sqrt(0.5) * rng.standard_normal((n_bags, 2)) + sides * np.array([3.0, 0.0])
    return plant(rng, positives, negatives)


def _diagonal(rng: np.random.Generator, n: int) -> NDArray[np.float64]:
    points: NDArray[np.float64] = rng.standard_normal((n, 2)) @ _DIAGONAL_ROOT
    return points


def plant(rng: np.random.Generator, positives: NDArray[np.float64], bags: NDArray[np.float64]) -> BagSet:
    """Label half of the bags positive and put one positive point into each of those.

    There is a positive point (n_bags, d) for every bag, used in the positive ones; bags (n_bags, size, d) are
    negative points, of which one in each positive bag is overwritten.

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
