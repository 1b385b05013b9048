"""The features of an ensemble as a scikit-learn transformer."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Self, final

import numpy as np
from sklearn.base import BaseEstimator, TransformerMixin, clone
from sklearn.utils.validation import check_is_fitted

from relforest.forests.ensemble import Ensemble
from relforest.forests.features import MODES, Mode, feature_names, features
from relforest.scenes.batch import checked_scenes
from relforest.support.errors import InputError
from relforest.support.options import one_of

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from relforest.scenes import Scenes


@final
class SceneFeatures(TransformerMixin, BaseEstimator):  # type: ignore[misc]  # scikit-learn is untyped
    """Turns scenes into vectors by the trees of a forest, of boosting or of a rule set.

    Parameters
    ----------
    model : estimator
        `SMRFForestClassifier`, `SMRFBoostingRegressor` or another one with an ``ensemble_``. A copy of it is
        fitted; to use one that is fitted already, wrap it in scikit-learn's ``FrozenEstimator``.
    mode : {"bits", "probability", "densities+bits", "distances", "counts"}, default "bits"
        What the numbers are, see `relforest.forests.features.features`: which leaf decides, what each tree
        says, how typical the objects are, how far each condition is from holding, or how many objects satisfy
        it.
    n_jobs : int, default 1
        Number of threads of `transform`; -1 for all cores. Does not affect the result.

    Attributes
    ----------
    model_ : estimator
        The fitted copy.
    farthest_ : (n_features,) float64
        The largest numbers of the training scenes; they stand for distances that are undefined.

    Examples
    --------
    Forests as in chapter 5 of the source: the probabilities of SMRF trees, weighed by a linear support vector
    machine.

    >>> from relforest import SMRFForestClassifier
    >>> from relforest.forests import SceneFeatures
    >>> from relforest.trees import TreeSettings
    >>> from sklearn.pipeline import make_pipeline
    >>> from sklearn.svm import LinearSVC
    >>> forest = SMRFForestClassifier(max_samples=500, growth=TreeSettings())
    >>> model = make_pipeline(SceneFeatures(forest, mode="probability"), LinearSVC())
    >>> model.fit(scenes, labels)  # doctest: +SKIP
    """

    def __init__(self, model: BaseEstimator, *, mode: Mode = "bits", n_jobs: int = 1) -> None:
        self.model = model
        self.mode = mode
        self.n_jobs = n_jobs

    def fit(self, scenes: Scenes, y: ArrayLike | None = None) -> Self:
        """Fit a copy of the model to scenes and targets.

        Raises
        ------
        InputError
            If the mode is unknown, the model has no ensemble, or as for the model.
        """
        one_of("mode", self.mode, MODES)
        checked_scenes(scenes)
        self.model_ = clone(self.model).fit(scenes, y)
        if not isinstance(getattr(self.model_, "ensemble_", None), Ensemble):
            raise InputError(
                "model must be a forest, boosting or a rule set of relforest.forests, "
                f"got {type(self.model).__name__}"
            )
        found = features(self.model_.ensemble_, scenes, self.mode, n_jobs=self.n_jobs)
        farthest = np.fmax.reduce(found, axis=0, initial=-np.inf)
        self.farthest_: NDArray[np.float64] = np.where(np.isinf(farthest), 0.0, farthest)
        return self

    def transform(self, scenes: Scenes) -> NDArray[np.float64]:
        """Return the features, (n_scenes, n_features)."""
        check_is_fitted(self)
        found = features(self.model_.ensemble_, checked_scenes(scenes), self.mode, n_jobs=self.n_jobs)
        return np.where(np.isnan(found), self.farthest_, found)

    def get_feature_names_out(self, input_features: object = None) -> NDArray[np.object_]:  # noqa: ARG002
        """Return what each feature is, in words, (n_features,)."""
        check_is_fitted(self)
        return np.array(feature_names(self.model_.ensemble_, self.mode), dtype=object)

    def __sklearn_tags__(self) -> Any:  # noqa: ANN401
        tags = super().__sklearn_tags__()
        tags.input_tags.two_d_array = False
        return tags
