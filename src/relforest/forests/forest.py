"""Forests: the mean of trees, each grown from its own sample of the scenes."""

from __future__ import annotations

from dataclasses import dataclass
from numbers import Integral
from typing import TYPE_CHECKING, NamedTuple, cast, final

import numpy as np

from relforest.forests.ensemble import Ensemble
from relforest.forests.members import Wanted, grow_conditions, grow_shared, grow_smrf, sampled
from relforest.forests.settings import GrowthSettings
from relforest.forests.tables import searched_tables
from relforest.support.errors import InputError
from relforest.support.options import at_least, in_range
from relforest.support.parallel import run_tasks
from relforest.support.rng import generator, stream
from relforest.trees import TreeSettings, query

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from numpy.typing import NDArray

    from relforest.forests.scene_tree import SceneTree
    from relforest.scenes import Scenes, Schema
    from relforest.trees import Tree

_TABLES, _TREES = range(2)


@final
@dataclass(frozen=True, slots=True)
class ForestSettings:
    """How many trees a forest has, of which type, and what each of them sees.

    Raises
    ------
    InputError
        If a value is outside its range, or `negated` does not apply.
    """

    n_trees: int
    max_samples: float  # share of the scenes that each tree sees; if it is an integer, their number
    growth: GrowthSettings | TreeSettings  # decides whether the trees are trees of conditions or SMRF trees
    negated: float | None = None
    """Share of the SMRF trees that are learned for the negated target. None is half of them, none where there
    are more than two classes, and for real targets whatever each tree explains better."""

    def __post_init__(self) -> None:
        at_least("n_trees", self.n_trees, 1)
        if isinstance(self.max_samples, Integral):
            at_least("max_samples", self.max_samples, 2)
        else:
            in_range("max_samples", self.max_samples, 0.0, 1.0, open_low=True)
        if self.negated is not None:
            in_range("negated", self.negated, 0.0, 1.0)
        if self.negated and isinstance(self.growth, GrowthSettings):
            raise InputError(
                "negated is for SMRF trees (growth=TreeSettings()); trees of conditions need no negation"
            )

    def size(self, n_scenes: int) -> int:
        """Return how many of the scenes each tree sees.

        Raises
        ------
        InputError
            If there are fewer.
        """
        if not isinstance(self.max_samples, Integral):
            return max(1, round(self.max_samples * n_scenes))
        if self.max_samples > n_scenes:
            raise InputError(f"max_samples must be at most the {n_scenes} scenes, got {self.max_samples}")
        return int(self.max_samples)

    def negations(self, wanted: Wanted) -> list[bool | None]:
        """Return for each tree whether it is learned for the negated target, spread evenly.

        None is for trees that decide it.

        Raises
        ------
        InputError
            If several classes were to be negated.
        """
        several = wanted.numbers.shape[1] > 1
        if several and self.negated:
            raise InputError("more than two classes cannot be negated: leave negated at None")
        share = (0.0 if several else 0.5) if self.negated is None else self.negated
        if isinstance(self.growth, GrowthSettings):
            share = 0.0
        elif self.negated is None and not wanted.of_classes:
            return [None] * self.n_trees
        # The slack keeps a product such as 0.3 * 10 from falling below the integer.
        steps = np.floor(share * np.arange(self.n_trees + 1) + 1e-9)
        return [bool(step > 0.0) for step in np.diff(steps)]


class Forest(NamedTuple):
    """The result of growing a forest.

    `unseen` (n_scenes, n_outputs) is the mean over the trees that did not see a scene, NaN where all did; it
    is empty where each tree has scenes of its own. `n_sampled` counts what was searched by a sample, in the
    tree with most of it: scenes for trees of conditions, expansions for SMRF trees. `n_left_out` counts
    expansions that were not searched, in the same way.
    """

    ensemble: Ensemble
    unseen: NDArray[np.float64]
    n_sampled: int
    n_left_out: int = 0


def grow_forest(
    scenes: Scenes, wanted: Wanted, settings: ForestSettings, seed: np.random.SeedSequence, *, n_jobs: int = 1
) -> Forest:
    """Grow each tree from a random sample of the scenes, drawn without replacement.

    `n_jobs` trees grow at the same time, which does not affect the result.

    References
    ----------
    Palmer (2015), section 5.2.3 for SMRF trees, half of them with negated labels.
    """
    everything, size = np.arange(len(scenes)), settings.size(len(scenes))
    negations, rngs = settings.negations(wanted), _streams(seed, settings.n_trees)
    signs = _signs(negations, wanted)
    is_smrf = isinstance(settings.growth, TreeSettings)
    pool = np.flatnonzero(wanted.weights > 0.0) if is_smrf else everything
    samples = [sampled(pool, size, rng) for rng in rngs]
    unseen = [np.setdiff1d(everything, sample) for sample in samples]
    leaves: Sequence[NDArray[np.int64]]
    if isinstance(settings.growth, TreeSettings):
        parts = [(scenes.take(sample).compact(), wanted.take(sample)) for sample in samples]
        forest = _smrf_forest(parts, negations, settings.growth, rngs, n_jobs)
        leaves = [
            query(cast("Tree", tree), scenes.take(rest)).leaf
            for tree, rest in zip(forest.ensemble.trees, unseen, strict=True)
        ]
    else:
        tables = searched_tables(scenes, settings.growth, generator(stream(seed, _TABLES)))
        targets = wanted.newton(wanted.mean)
        tasks = [
            (tables, split, targets, settings.growth, rng)
            for split, rng in zip(zip(samples, unseen, strict=True), rngs, strict=True)
        ]
        own, leaves = zip(*run_tasks(grow_shared, tasks, n_jobs=n_jobs, prefer="threads"), strict=True)
        n_sampled = max((table.n_sampled for table in tables), default=0)
        forest = _forest_of_conditions(scenes.schema, wanted, own, n_sampled)
    total, n_unseen = np.zeros(wanted.numbers.shape), np.zeros((len(scenes), 1))
    trees = forest.ensemble.trees
    bases = wanted.complement(signs < 0) if is_smrf else np.tile(wanted.mean, (len(trees), 1))
    for tree, sign, base, rest, leaf in zip(trees, signs, bases, unseen, leaves, strict=True):
        total[rest] += base + sign * tree.values[leaf]
        n_unseen[rest] += 1
    with np.errstate(invalid="ignore"):
        return forest._replace(unseen=total / n_unseen)


def grow_forest_of_samples(
    samples: Sequence[Scenes],
    wanted: Wanted,
    settings: ForestSettings,
    seed: np.random.SeedSequence,
    *,
    n_jobs: int = 1,
) -> Forest:
    """Grow each tree from all scenes of its own sample, one for each tree and of the same schema.

    What is `wanted` of them is listed one sample after the other; for `n_jobs` see `grow_forest`.
    """
    ends = np.cumsum([len(scenes) for scenes in samples])
    pieces = [wanted.take(np.arange(end - len(each), end)) for each, end in zip(samples, ends, strict=True)]
    negations, rngs = settings.negations(wanted), _streams(seed, settings.n_trees)
    if isinstance(settings.growth, TreeSettings):
        parts = ((scenes.compact(), piece) for scenes, piece in zip(samples, pieces, strict=True))
        return _smrf_forest(parts, negations, settings.growth, rngs, n_jobs)
    tasks = [
        (scenes, piece, wanted.mean, settings.growth, rng)
        for scenes, piece, rng in zip(samples, pieces, rngs, strict=True)
    ]
    trees, n_sampled = zip(*run_tasks(grow_conditions, tasks, n_jobs=n_jobs, prefer="threads"), strict=True)
    return _forest_of_conditions(samples[0].schema, wanted, trees, max(n_sampled))


def _signs(negations: list[bool | None], wanted: Wanted) -> NDArray[np.int64]:
    """Return -1 for each tree whose probabilities are those of the negated labels, else 1."""
    return np.where(np.array([bool(negated) for negated in negations]) & wanted.of_classes, -1, 1)


def _streams(seed: np.random.SeedSequence, n_trees: int) -> list[np.random.Generator]:
    return [generator(stream(seed, _TREES, number)) for number in range(n_trees)]


def _forest_of_conditions(
    schema: Schema, wanted: Wanted, trees: tuple[SceneTree, ...], n_sampled: int
) -> Forest:
    """Return the forest of trees that add to the mean."""
    ensemble = Ensemble(schema, wanted.mean, trees, np.full(len(trees), 1.0 / len(trees)))
    return Forest(ensemble, np.empty((0, ensemble.n_outputs)), n_sampled)


def _smrf_forest(
    parts: Iterable[tuple[Scenes, Wanted]],
    negations: list[bool | None],
    settings: TreeSettings,
    rngs: Sequence[np.random.Generator],
    n_jobs: int,
) -> Forest:
    """Grow a SMRF tree from each part."""
    tasks = [
        (*part, negated, settings, rng) for part, negated, rng in zip(parts, negations, rngs, strict=True)
    ]
    signs = _signs(negations, tasks[0][1])
    # Half of their time is spent outside kernels.
    grown = run_tasks(grow_smrf, tasks, n_jobs=n_jobs, prefer="processes")
    trees, n_sampled, n_left_out = zip(*grown, strict=True)
    start = tasks[0][1].complement(signs < 0).mean(axis=0)
    ensemble = Ensemble(trees[0].schema, start, trees, signs / len(trees))
    return Forest(ensemble, np.empty((0, len(start))), max(n_sampled), max(n_left_out))
