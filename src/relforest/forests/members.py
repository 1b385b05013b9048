"""The trees of a forest: what they are to predict, and how each grows from its own sample."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, final

import numpy as np

from relforest.forests.growth import grow_tree
from relforest.forests.kernels import Targets
from relforest.forests.tables import searched_tables
from relforest.trees import MeanLeaf, Target, Tree
from relforest.trees.growth import grow_best

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from relforest.forests.scene_tree import SceneTree
    from relforest.forests.settings import GrowthSettings
    from relforest.forests.tables import ConditionTable
    from relforest.scenes import Scenes
    from relforest.trees import TreeSettings


@final
@dataclass(frozen=True, slots=True, eq=False)
class Wanted:
    """What a forest is to predict."""

    numbers: NDArray[np.float64]
    """(n_scenes, n_outputs): real targets (n, 1); whether a scene is of the second of two classes (n, 1); or
    of each class."""
    weights: NDArray[np.float64]  # (n_scenes,)
    of_classes: bool

    @property
    def mean(self) -> NDArray[np.float64]:
        """The best constant, (n_outputs,)."""
        return np.asarray(np.average(self.numbers, axis=0, weights=self.weights))

    def take(self, scenes: NDArray[np.int64]) -> Wanted:
        """Return what is wanted of some of the scenes."""
        return Wanted(self.numbers[scenes], self.weights[scenes], self.of_classes)

    def newton(self, start: NDArray[np.float64]) -> Targets:
        """Return the derivatives of half of the squared error at a constant, for trees of conditions."""
        weights = np.repeat(self.weights[:, None], self.numbers.shape[1], axis=1)
        return Targets(weights * (start - self.numbers), weights)

    def complement(self, negated: NDArray[np.bool_]) -> NDArray[np.float64]:
        """Return what is added to minus each negated tree, (n_trees, n_outputs): 1 for probabilities."""
        return np.repeat(negated[:, None].astype(np.float64), self.numbers.shape[1], axis=1)

    def targets(self, *, negated: bool | None) -> list[Target]:
        """Return the same, or its negation, for SMRF trees.

        Of a real target, the leaf with the lowest mean decides instead of the one with the highest; both are
        returned if `negated` is None.

        Raises
        ------
        InputError
            If all of several real targets are equal.
        """
        if not self.of_classes:
            return [
                Target.real(self.numbers[:, 0], self.weights, lowest=lowest)
                for lowest in (False, True)
                if negated is None or negated == lowest
            ]
        if self.numbers.shape[1] > 1:
            return [Target.classes(self.numbers.argmax(axis=1), self.numbers.shape[1], self.weights)]
        return [Target.binary((self.numbers[:, 0] > 0.5) != bool(negated), self.weights)]


def sampled(pool: NDArray[np.int64], size: int, rng: np.random.Generator) -> NDArray[np.int64]:
    """Return `size` scenes of a pool (n,) without replacement, in its order; all if there are fewer."""
    return pool[np.sort(rng.choice(len(pool), min(size, len(pool)), replace=False))]


def grow_shared(
    tables: tuple[ConditionTable, ...],
    samples: tuple[NDArray[np.int64], NDArray[np.int64]],
    targets: Targets,
    settings: GrowthSettings,
    rng: np.random.Generator,
) -> tuple[SceneTree, NDArray[np.int64]]:
    """Grow a tree of conditions from the first sample; return the leaves of the second one as well."""
    grown = grow_tree(tables, samples[0], targets, settings, rng)
    return grown.tree, grown.leaves(samples[1])


def grow_conditions(
    scenes: Scenes,
    wanted: Wanted,
    start: NDArray[np.float64],
    settings: GrowthSettings,
    rng: np.random.Generator,
) -> tuple[SceneTree, int]:
    """Grow a tree of conditions from all of the scenes; return as well in how many choices were sampled."""
    tables = searched_tables(scenes, settings, rng)
    grown = grow_tree(tables, np.arange(len(scenes)), wanted.newton(start), settings, rng)
    return grown.tree, max((table.n_sampled for table in tables), default=0)


def grow_smrf(
    scenes: Scenes,
    wanted: Wanted,
    negated: bool | None,  # noqa: FBT001 - a task is a tuple of arguments
    settings: TreeSettings,
    rng: np.random.Generator,
) -> tuple[Tree, int, int]:
    """Grow a SMRF tree from all of the scenes; return as well how many expansions were sampled, left out."""
    if not wanted.of_classes and np.ptp(wanted.numbers) == 0.0:
        leaf = MeanLeaf(float(wanted.numbers[0, 0]), 0, len(scenes), 0.0)
        return Tree(scenes.schema, (leaf,)), 0, 0
    growth = grow_best(scenes, wanted.targets(negated=negated), rng=rng, settings=settings)
    return growth.tree, growth.n_sampled, growth.n_left_out
