"""Boosting: a sum of small trees of conditions, each fitted to the gradient of the loss."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple, final

import numpy as np

from relforest.forests.growth import GrownTree, grow_tree
from relforest.support.options import at_least, in_range
from relforest.support.progress import report

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from relforest.forests.losses import Loss
    from relforest.forests.settings import GrowthSettings
    from relforest.forests.tables import ConditionTable


@final
@dataclass(frozen=True, slots=True)
class BoostingSettings:
    """How many trees are added up, and how.

    Raises
    ------
    InputError
        If a value is outside its range.
    """

    n_trees: int = 100  # most trees
    learning_rate: float = 0.1  # factor on every tree
    max_scenes: int = 256  # each tree is fitted to a random sample of so many scenes, without replacement
    validation: float = 0.0
    """Share of the scenes held out to decide when to stop; 0 to use all scenes and all trees."""
    patience: int = 30  # trees without an improvement on the held-out scenes, after which boosting stops

    def __post_init__(self) -> None:
        at_least("n_trees", self.n_trees, 1)
        in_range("learning_rate", self.learning_rate, 0.0, 1.0, open_low=True)
        at_least("max_scenes", self.max_scenes, 2)
        in_range("validation", self.validation, 0.0, 1.0, open_high=True)
        at_least("patience", self.patience, 1)


class Boosted(NamedTuple):
    """The result of boosting; the losses are those of the held-out scenes if there are any."""

    start: NDArray[np.float64]  # (n_outputs,) the constant that the trees are added to
    trees: tuple[GrownTree, ...]
    losses: NDArray[np.float64]  # (n_trees + 1,) mean loss before the first and after every tree


def boost(
    tables: tuple[ConditionTable, ...],
    n_scenes: int,
    loss: Loss,
    settings: tuple[BoostingSettings, GrowthSettings],
    rng: np.random.Generator,
) -> Boosted:
    """Fit trees to the gradient of a loss, one after the other.

    References
    ----------
    Friedman (2002), Stochastic gradient boosting, Computational Statistics & Data Analysis 38(4).
    """
    how, growth = settings
    everything = np.arange(n_scenes)
    shuffled = rng.permutation(n_scenes)
    n_held = int(how.validation * n_scenes)
    held, training = np.sort(shuffled[:n_held]), np.sort(shuffled[n_held:])
    judged = held if n_held else training
    start = loss.start()
    scores = np.tile(start, (n_scenes, 1))
    losses, trees = [loss.value(scores, judged)], []
    best = 0
    for number in range(how.n_trees):
        report("trees", number, how.n_trees)
        sample = training
        if len(training) > how.max_scenes:
            sample = np.sort(rng.choice(training, how.max_scenes, replace=False))
        grown = grow_tree(tables, sample, loss.targets(scores), growth, rng)
        scores += how.learning_rate * grown.tree.values[grown.leaves(everything)]
        trees.append(grown)
        losses.append(loss.value(scores, judged))
        best = number + 1 if losses[-1] < losses[best] else best
        if n_held and number + 1 - best >= how.patience:
            break
    n_kept = best if n_held else len(trees)
    return Boosted(start, tuple(trees[:n_kept]), np.array(losses[: n_kept + 1]))
