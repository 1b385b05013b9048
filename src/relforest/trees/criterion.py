"""What a tree is to explain: two classes, several classes or a real number, with weights.

A `Target` holds what every scene adds to the leaf that decides it (`Target.sums`). Everything else follows
from the sums of leaves: their values, which also order them, the log likelihood of the tree, and the scores
of volumes.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final, NamedTuple, final

import numpy as np
from scipy.special import xlogy

from relforest.support.errors import InputError
from relforest.trees.nodes import AnyLeaf, ClassLeaf, Leaf, MeanLeaf
from relforest.trees.probabilities import BINARY, CLASSES, REAL, Assignment, assigned

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from relforest.volumes.objectives import Objective

_LEAST: Final = 1e-12
# The variance that a tree leaves unexplained counts as at least this share of all.
_LEAST_VARIANCE: Final = 1e-9


class View(NamedTuple):
    """Bags as covariant aggregation sees them."""

    labels: NDArray[np.bool_]  # (n_bags,) True for those that a volume should hold
    evidence: NDArray[np.float64] | None  # (n_bags, 2) see `aggregate`
    objective: Objective


@final
@dataclass(frozen=True, slots=True, eq=False)
class Target:
    """What is known about each scene.

    Use `binary`, `classes` or `real`.

    Parameters
    ----------
    task : int
        `BINARY`, `CLASSES` or `REAL`.
    sums : (n_scenes, k) float64
        By task: the weight as a negative and as a positive scene; the weight in each class; weight, weight
        times value and weight times squared value, the values being standardised.
    strata : (n_scenes,) int64
        A number for the class, or for whether the value is above the mean; samples are drawn in proportion.
    weighted : bool
        Whether the weights differ.
    scale : (float, float)
        Mean and standard deviation of the values, for leaves; the latter negative if the values are negated.
    """

    task: int
    sums: NDArray[np.float64]
    strata: NDArray[np.int64]
    weighted: bool = False
    scale: tuple[float, float] = (0.0, 1.0)
    common: int = field(init=False)
    """The class with the largest weight, 0 for other tasks."""

    def __post_init__(self) -> None:
        common = int(self.sums.sum(axis=0).argmax()) if self.task == CLASSES else 0
        object.__setattr__(self, "common", common)

    @classmethod
    def binary(cls, labels: NDArray[np.bool_], weights: NDArray[np.float64] | None = None) -> Target:
        """Explain which scenes are positive; the most probably positive leaf decides.

        Parameters
        ----------
        labels : (n_scenes,) bool
        weights : (n_scenes,) float64, optional
            Positive; only their proportions count, see `effective_weights`.
        """
        return cls._of_classes(BINARY, labels.astype(np.int64), 2, weights)

    @classmethod
    def classes(
        cls, codes: NDArray[np.int64], n_classes: int, weights: NDArray[np.float64] | None = None
    ) -> Target:
        """Explain which of several classes scenes belong to.

        Existence needs an order of leaves, and the source has none for more than two classes. Here the
        leaf with the largest share of any class but the most common one decides: what exists in a scene
        speaks for a special class, and scenes where nothing special exists are left to the common one.

        Parameters
        ----------
        codes : (n_scenes,) int64
            Classes from 0 to `n_classes` - 1.
        n_classes : int
        weights : (n_scenes,) float64, optional
            See `binary`.
        """
        return cls._of_classes(CLASSES, codes, n_classes, weights)

    @classmethod
    def real(
        cls,
        values: NDArray[np.float64],
        weights: NDArray[np.float64] | None = None,
        *,
        lowest: bool = False,
    ) -> Target:
        """Explain a number by Gaussian errors around the mean of each leaf.

        Parameters
        ----------
        values : (n_scenes,) float64
        weights : (n_scenes,) float64, optional
            See `binary`.
        lowest : bool
            Whether the leaf with the lowest mean decides, instead of the highest.

        Raises
        ------
        InputError
            If a value is not finite, or all are equal.
        """
        if not np.isfinite(values).all():
            raise InputError("targets contain NaN or infinite values: give each scene a number")
        w = np.ones(len(values)) if weights is None else effective_weights(weights)
        largest = float(np.abs(values).max(initial=0.0)) or 1.0
        small = values / largest
        mean = float(np.average(small, weights=w))
        deviation = float(np.sqrt(np.average((small - mean) ** 2, weights=w)))
        if not deviation > 1e-9 * max(abs(mean), 1e-300):
            raise InputError(f"all targets are {values[0]:g}: there is nothing to explain")
        if lowest:
            deviation = -deviation
        y = (small - mean) / deviation
        sums = np.column_stack([w, w * y, w * y * y])
        scale = (mean * largest, deviation * largest)
        return cls(REAL, sums, (y > 0).astype(np.int64), weighted=True, scale=scale)

    @classmethod
    def _of_classes(
        cls, task: int, codes: NDArray[np.int64], n_classes: int, weights: NDArray[np.float64] | None
    ) -> Target:
        sums = np.zeros((len(codes), n_classes))
        weighted = weights is not None and bool((weights != weights[0]).any())
        each = 1.0 if weights is None or not weighted else effective_weights(weights)
        sums[np.arange(len(codes)), codes] = each
        return cls(task, sums, codes, weighted)

    def __len__(self) -> int:
        """Return the number of scenes."""
        return len(self.sums)

    @property
    def n_values(self) -> int:
        """Free parameters of a leaf."""
        return self.sums.shape[1] - 1 if self.task == CLASSES else 1

    def permuted(self, order: NDArray[np.int64]) -> Target:
        """Return the target with what is known about scene ``order[i]`` given to scene i."""
        return Target(self.task, self.sums[order], self.strata[order], self.weighted, self.scale)

    def assign(self, presence: NDArray[np.bool_]) -> Assignment:
        """Assign the values of leaves; see `Assignment`.

        Parameters
        ----------
        presence : (n_leaves, n_scenes) bool
            Whether any instantiation sequence of the scene arrives at the leaf. Every scene is present
            somewhere.
        """
        value, sums, winner = assigned(presence, self.sums, self.task, self.common)
        return Assignment(value, sums, winner, self._log_likelihood(value, sums))

    def _log_likelihood(self, value: NDArray[np.float64], sums: NDArray[np.float64]) -> float:
        if self.task == BINARY:
            bounded = np.clip(value, _LEAST, 1.0 - _LEAST)
            terms = sums[:, 1] * np.log(bounded) + sums[:, 0] * np.log1p(-bounded)
            return float(terms.sum())
        if self.task == CLASSES:
            return float(xlogy(sums, sums).sum() - xlogy(sums.sum(axis=1), sums.sum(axis=1)).sum())
        weight = sums[:, 0].sum()
        unexplained = (sums[:, 2] - 2.0 * value * sums[:, 1] + value * value * sums[:, 0]).sum()
        return float(-0.5 * weight * np.log(max(unexplained / weight, _LEAST_VARIANCE)))

    def potential(self, presence: NDArray[np.bool_], assignment: Assignment, leaf: int) -> float:
        """Return the log likelihood if a question could separate a leaf's own best scenes from all others.

        The source asks for "the leaf with best potential to improve L" without giving a formula. Here the
        leaf keeps the positive scenes it decides (those above its mean, or of its largest class but the
        common one), and all other scenes present move to an imaginary leaf.
        """
        own = (assignment.winner == leaf) & self._best(assignment, leaf)
        imagined = np.vstack([presence, presence[leaf] & ~own])
        imagined[leaf] = own
        return self.assign(imagined).log_likelihood

    def _best(self, assignment: Assignment, leaf: int) -> NDArray[np.bool_]:
        if self.task == REAL:
            return np.asarray(self.sums[:, 1] > assignment.value[leaf] * self.sums[:, 0])
        special = 1
        if self.task == CLASSES:
            shares = assignment.sums[leaf].copy()
            shares[self.common] = -1.0
            special = int(shares.argmax())
        return np.asarray(self.strata == special)

    def views(self, scenes: NDArray[np.int64]) -> list[View]:
        """Return how volumes may separate scenes: as some of the bags against the others.

        For several classes, there is a view for each of them but the common one.
        """
        if self.task == REAL:
            weight, total = self.sums[scenes, 0], self.sums[scenes, 1]
            above = total > weight * (total.sum() / max(weight.sum(), 1e-300))
            return [View(above, self.sums[scenes, :2], "squared-error")] if above.any() else []
        if self.task == BINARY:
            candidates = [1]
        else:
            candidates = [code for code in range(self.sums.shape[1]) if code != self.common]
        found = []
        for code in candidates:
            labels = self.strata[scenes] == code
            if not labels.any():
                continue
            if not self.weighted:
                found.append(View(labels, None, "log-likelihood"))
                continue
            positive = self.sums[scenes, code]
            evidence = np.column_stack([self.sums[scenes].sum(axis=1) - positive, positive])
            found.append(View(labels, evidence, "weighted-log-likelihood"))
        return found

    def gain(self, view: View, score: float, scenes: NDArray[np.int64]) -> float:
        """Return what a volume with this score adds to the log likelihood of the scenes."""
        if view.evidence is None:
            n, positive = len(view.labels), int(np.count_nonzero(view.labels))
            return score - float(xlogy(positive, positive / n) + xlogy(n - positive, (n - positive) / n))
        weight, total = view.evidence.sum(axis=0).tolist()
        if self.task != REAL:
            both = weight + total
            return score - float(xlogy(total, total / both) + xlogy(weight, weight / both))
        spread = max(float(self.sums[scenes, 2].sum()) - total * total / weight, 1e-300)
        explained = min((score - total * total / weight) / spread, 1.0 - _LEAST_VARIANCE)
        return float(-0.5 * weight * np.log1p(-explained))

    def leaves(self, assignment: Assignment) -> list[AnyLeaf]:
        """Return the leaves with their values in the units of the target, and the scenes that they decide."""
        n_leaves, n_strata = len(assignment.value), max(self.sums.shape[1], 2)
        scenes = np.zeros((n_leaves, n_strata), dtype=np.int64)
        np.add.at(scenes, (assignment.winner, self.strata), 1)
        if self.task == BINARY:
            return [
                Leaf(float(p), int(negatives), int(positives))
                for p, (negatives, positives) in zip(assignment.value, scenes, strict=True)
            ]
        if self.task == REAL:
            return [self._mean_leaf(i, assignment, int(scenes[i].sum())) for i in range(n_leaves)]
        rest = self.sums.sum(axis=0)
        leaves: list[AnyLeaf] = []
        for i in range(n_leaves):
            own = assignment.sums[i] if scenes[i].any() else rest
            shares = tuple((own / own.sum()).tolist())
            common = int(scenes[i, self.common])
            value, counts = float(assignment.value[i]), tuple(scenes[i].tolist())
            leaves.append(ClassLeaf(value, common, sum(counts) - common, shares, counts))
        return leaves

    def _mean_leaf(self, leaf: int, assignment: Assignment, n: int) -> AnyLeaf:
        mean, unit = self.scale
        weight, total, squares = assignment.sums[leaf].tolist()
        variance = max(squares / weight - (total / weight) ** 2, 0.0) if n else 1.0
        value = mean + unit * float(assignment.value[leaf])
        lowest = unit < 0.0
        return MeanLeaf(-value if lowest else value, 0, n, abs(unit) * float(np.sqrt(variance)), lowest)


def effective_weights(weights: NDArray[np.float64]) -> NDArray[np.float64]:
    """Scale weights so that they add up to the number of equally weighted scenes that say as much.

    That is the square of their sum divided by the sum of their squares (Kish), which keeps the tests from
    taking large weights for many scenes.
    """
    scaled = weights / weights.max()
    effective: NDArray[np.float64] = scaled * (scaled.sum() / (scaled * scaled).sum())
    return effective
