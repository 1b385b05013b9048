"""An exact test: the whole search is repeated on shuffled labels."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from relforest.support.progress import part

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from relforest.trees.candidates import Candidate, OpenLeaf
    from relforest.trees.criterion import Target
    from relforest.trees.search import LeafSearch
    from relforest.trees.settings import TreeSettings


def permutation_p(
    found: Candidate,
    search: LeafSearch,
    target: Target,
    at: OpenLeaf,
    settings: TreeSettings,
    rng: np.random.Generator,
) -> float:
    """Return the p-value of the best candidate under shuffled labels.

    Labels (or values, with their weights) are shuffled among scenes decided by the same leaf, so that what
    the tree already explains stays explained. Each shuffle goes through the same search over all expansions;
    the p-value is the share of shuffles, including the observed labels, with a best candidate as significant
    as the observed one. No further correction for multiple comparisons is needed. At the root the test is
    exact; deeper down it is conditional on the tree so far.

    Shuffling stops as soon as significance is out of reach; the p-value returned is then a lower bound
    that already exceeds alpha.

    References
    ----------
    Besag and Clifford (1991), Sequential Monte Carlo p-values, Biometrika 78(2), for the early stop.
    """
    allowed = math.floor(settings.alpha * (settings.permutations + 1) + 1e-9) - 1
    as_good = 0
    for number in range(1, settings.permutations + 1):
        shuffled = target.permuted(_shuffled(at.assignment.winner, rng))
        with part(f"shuffle {number} of {settings.permutations}"):
            null = search.best(shuffled, at.retargeted(shuffled), rng)
        as_good += null is not None and null.beats(found)
        if as_good > allowed:
            break
    return (1 + as_good) / (1 + settings.permutations)


def _shuffled(groups: NDArray[np.int64], rng: np.random.Generator) -> NDArray[np.int64]:
    """Return the positions of `groups`, shuffled within each group."""
    order = np.arange(len(groups))
    for group in np.unique(groups):
        members = np.flatnonzero(groups == group)
        order[members] = rng.permutation(members)
    return order
