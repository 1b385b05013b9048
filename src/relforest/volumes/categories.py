"""The decision volume of a category: an interval around its number that contains no other."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from relforest.volumes.ellipsoid import Ellipsoid
from relforest.volumes.objectives import (
    OBJECTIVES,
    WEIGHTED,
    Objective,
    entropy_table,
    score_counts,
    score_sums,
)

if TYPE_CHECKING:
    from numpy.typing import NDArray

# So many key points make the density of all other categories vanish.
_N_KEYS: Final = 10_000


def category_volume(category: int) -> Ellipsoid:
    """Return the volume that contains one category only."""
    return Ellipsoid(np.array([float(category)]), np.eye(1), 0.5, _N_KEYS, 0.0)


def best_category(
    points: NDArray[np.float64],
    starts: NDArray[np.int64],
    known: tuple[NDArray[np.bool_], NDArray[np.float64] | None],
    objective: Objective,
) -> tuple[int, float, int]:
    """Try every category of the positive bags.

    Parameters
    ----------
    points : (n_points, 1) float64
        Numbers of categories, grouped by bag.
    starts : (n_bags + 1,) int64
        Where each bag begins.
    known : labels (n_bags,) and evidence (n_bags, 2) or None
        As for `aggregate`.
    objective : str

    Returns
    -------
    category : int
        The first of the best; -1 if there is no positive bag.
    score : float
        Minus infinity if no category is admissible.
    n_tried : int
    """
    labels, evidence = known
    best, highest = -1, -np.inf
    present = np.unique(points[np.repeat(labels, np.diff(starts)), 0]).astype(np.int64)
    for category in present.tolist():
        inside = np.logical_or.reduceat(points[:, 0] == category, starts[:-1])
        score = _score(inside, labels, evidence, objective)
        if score > highest:
            best, highest = category, score
    return best, highest, len(present)


def _score(
    inside: NDArray[np.bool_],
    labels: NDArray[np.bool_],
    evidence: NDArray[np.float64] | None,
    objective: Objective,
) -> float:
    code = OBJECTIVES[objective]
    if evidence is not None and code >= WEIGHTED:
        within, total = evidence[inside].sum(axis=0), evidence.sum(axis=0)
        return float(score_sums(code, (within[0], within[1]), (total[0], total[1])))
    positives = int(np.count_nonzero(labels))
    own, others = int(np.count_nonzero(inside & labels)), int(np.count_nonzero(inside & ~labels))
    totals = (positives, len(labels) - positives)
    return float(score_counts(code, own, others, totals, entropy_table(len(labels))))
