"""Values by scikit-learn's ensembles of regression trees."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, Final, Literal, NamedTuple, TypeAlias, final

import numpy as np
from numpy.typing import NDArray
from sklearn.ensemble import ExtraTreesRegressor, HistGradientBoostingRegressor
from threadpoolctl import threadpool_limits

from relforest.rl.fitted.evidence import Evidence
from relforest.rl.fitted.forest_arrays import ForestArrays, forest_mean, forests_of, joined
from relforest.rl.fitted.settings import ForestSettings
from relforest.rl.vectors.approximator import Model, Rows
from relforest.rl.vectors.sweeps import swept
from relforest.scenes.arrays import FloatArray, IntArray
from relforest.support.options import at_least, one_of

Regressor: TypeAlias = Literal["trees", "boosting"]


@final
@dataclass(frozen=True, slots=True, eq=False)
class Forest:
    """The mean of trees that compare numbers of a vector."""

    trees: ForestArrays

    fields: ClassVar[tuple[str, ...]] = ForestArrays._fields

    def values(self, rows: Rows) -> FloatArray:
        """Return the values of actions, (c,)."""
        return forest_mean(self.trees, self.trees.roots[0, 0], rows.vectors.astype(np.float32))

    def arrays(self) -> Mapping[str, NDArray[Any]]:
        """Return the arrays of the trees."""
        return self.trees._asdict()

    @classmethod
    def of(cls, arrays: Mapping[str, NDArray[Any]], width: int, *, origin: str) -> Forest:
        """Return trees that compare `width` numbers; `ModelFormatError` if the arrays are not such trees."""
        return cls(forests_of(arrays, (width,), origin=origin))


@final
@dataclass(frozen=True, slots=True)
class TreesQ:
    """Fitted Q iteration by an ensemble of trees.

    Parameters
    ----------
    regressor : {"trees", "boosting"}
        Extremely randomised trees with the options of `relforest.rl.fitted.ForestSettings`, or
        scikit-learn's histogram gradient boosting with its own.
    sweeps : int
        Most times that returns and trees are computed in turn.

    References
    ----------
    Ernst, Geurts and Wehenkel, Tree-based batch mode reinforcement learning (2005).
    """

    regressor: Regressor
    sweeps: int = 5

    model: ClassVar[type[Model]] = Forest

    def __post_init__(self) -> None:
        one_of("regressor", self.regressor, tuple(_REGRESSORS))
        at_least("sweeps", self.sweeps, 1)

    def improved(
        self, before: Forest | None, evidence: Evidence, rows: Rows, rng: np.random.Generator
    ) -> Forest:
        """Return trees of the returns of their own policy."""
        # Trees compare such numbers when they play.
        examples = rows.vectors[evidence.taken].astype(np.float32)

        def fit(targets: FloatArray) -> Forest:
            # Sums must be taken in the same order, whatever the number of cores.
            with threadpool_limits(1):
                return _REGRESSORS[self.regressor](examples, targets, int(rng.integers(2**31)))

        return swept(before, evidence, rows, fit, self.sweeps)

    def to_dict(self) -> dict[str, Any]:
        """Return the name of the learner and its options."""
        return {"name": f"{self.regressor}-q", "sweeps": self.sweeps}


class _Tree(NamedTuple):
    """A tree in the form of scikit-learn's ``tree_``."""

    children_left: IntArray
    children_right: IntArray
    feature: IntArray
    threshold: FloatArray
    value: FloatArray  # (n_nodes, 1, 1)
    node_count: int


def _extra_trees(examples: NDArray[np.float32], targets: FloatArray, seed: int) -> Forest:
    settings = ForestSettings()
    model = ExtraTreesRegressor(
        settings.trees, min_samples_leaf=settings.min_leaf, max_features=settings.share, random_state=seed
    ).fit(examples, targets)
    return Forest(joined([[[tree.tree_ for tree in model.estimators_]]]))


def _boosting(examples: NDArray[np.float32], targets: FloatArray, seed: int) -> Forest:
    # Without early stopping, whose share of examples kept aside would depend on luck.
    model = HistGradientBoostingRegressor(early_stopping=False, random_state=seed).fit(examples, targets)
    # scikit-learn has no public view of these trees.
    grown = [predictor.nodes for (predictor,) in model._predictors]  # noqa: SLF001
    start = float(model._baseline_prediction.item())  # noqa: SLF001
    trees = []
    for nodes in grown:
        left, right = (
            np.where(nodes["is_leaf"], -1, nodes[side].astype(np.int64)) for side in ("left", "right")
        )
        # The sum of all trees and the beginning, as a mean of trees.
        value = nodes["value"] * len(grown) + start
        feature = nodes["feature_idx"].astype(np.int64)
        trees.append(_Tree(left, right, feature, nodes["num_threshold"], value[:, None, None], len(nodes)))
    return Forest(joined([[trees]]))


_REGRESSORS: Final[Mapping[str, Callable[[NDArray[np.float32], FloatArray, int], Forest]]] = {
    "trees": _extra_trees,
    "boosting": _boosting,
}
