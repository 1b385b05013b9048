"""SMRF trees as scikit-learn estimators of scenes."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, NamedTuple, Self, final, get_args

import numpy as np
from sklearn.base import BaseEstimator, ClassifierMixin, RegressorMixin
from sklearn.utils.validation import check_is_fitted

from relforest.scenes.batch import checked_scenes
from relforest.scenes.ids import plain
from relforest.scenes.labels import class_labels
from relforest.support.errors import InputError
from relforest.support.numerals import probability
from relforest.support.options import one_of
from relforest.support.progress import printed_to_stderr
from relforest.support.rng import RandomState, generator, seed_sequence
from relforest.trees.criterion import Target
from relforest.trees.growth import grow_best
from relforest.trees.inference import query
from relforest.trees.nodes import ClassLeaf, MeanLeaf, variable_name
from relforest.trees.settings import SearchName, Test, TreeSettings
from relforest.trees.weights import ClassWeight, class_weights, real_values, scene_weights
from relforest.volumes.settings import CovAggSettings

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from relforest.scenes import Scenes
    from relforest.trees.growth import Step
    from relforest.trees.tree import Tree

Decides = Literal["highest", "lowest", "either"]


@final
@dataclass(frozen=True, slots=True)
class Explanation:
    """The reason for the prediction of a scene.

    Parameters
    ----------
    scene : object
        Identifier of the scene.
    probability : float
        Probability of the positive class; the mean for real targets, and the largest share of any class but
        the most common one for several classes.
    leaf : int
        Ordinal of the deciding leaf.
    witnesses : dict of str to object
        Identifiers of the bound objects by variable, for the most representative instantiation sequence that
        reaches the leaf; None if no object was left to bind.
    densities : tuple of float
        How typical the witnesses are for each question above the leaf, starting at the root: 1 at the centre
        of its volume, 0 far away or if the question could not be answered.
    prediction : str
        The prediction in words, where it is not the probability of a positive class.
    """

    scene: object
    probability: float
    leaf: int
    witnesses: dict[str, object]
    densities: tuple[float, ...]
    prediction: str = ""

    def __str__(self) -> str:
        """Return the explanation on one line."""
        bound = ", ".join(f"{name} = {witness}" for name, witness in self.witnesses.items())
        found = f"{self.prediction or f'probability {probability(self.probability)}'}, leaf {self.leaf}"
        return f"scene {self.scene}: {found}, {bound or 'no objects'}"


class _Wanted(NamedTuple):
    """The targets of which the one that explains most is kept, without the scenes of weight 0."""

    targets: list[Target]
    weights: NDArray[np.float64] | None  # of all scenes
    classes: NDArray[Any] | None = None


@dataclass(kw_only=True, eq=False, repr=False)
class _SceneTree(BaseEstimator, ABC):  # type: ignore[misc]  # scikit-learn is untyped
    """The options of `TreeSettings` and a few more, and the fit."""

    test: Test = "likelihood-ratio"
    search: SearchName = "screened"
    alpha: float = 0.05
    attempts: int = 3
    permutations: int = 99
    max_points: int = 100_000
    covagg: CovAggSettings | None = None
    random_state: RandomState = None
    n_jobs: int = 1
    verbose: bool = False

    def fit(self, scenes: Scenes, y: ArrayLike, sample_weight: ArrayLike | None = None) -> Self:
        """Learn a tree.

        Parameters
        ----------
        scenes : Scenes
        y : (n_scenes,) array-like
            Aligned with ``scenes.scene_ids``: labels that are whole numbers, booleans or strings; for a
            regressor, finite numbers.
        sample_weight : (n_scenes,) array-like, optional
            Weights, of which only the proportions count; scenes of weight 0 are left out.

        Raises
        ------
        InputError
            If targets or weights do not match the scenes, labels are not of at least two classes, a number is
            not finite or all are equal, a weight is negative or not finite or all are zero, or a parameter is
            out of range.
        """
        wanted = self._wanted(y, len(checked_scenes(scenes)), sample_weight)
        if not isinstance(self.covagg, CovAggSettings | None):
            raise InputError(f"covagg must be CovAggSettings(...) or None, got {self.covagg!r}")
        settings = TreeSettings(
            test=self.test,
            search=self.search,
            alpha=self.alpha,
            attempts=self.attempts,
            permutations=self.permutations,
            max_points=self.max_points,
            covagg=self.covagg or CovAggSettings(),
        )
        rng = generator(seed_sequence(self.random_state))
        kept = scenes if wanted.weights is None else scenes.take(np.flatnonzero(wanted.weights > 0))
        with printed_to_stderr(self.verbose):
            growth = grow_best(kept, wanted.targets, rng=rng, settings=settings)
        self.tree_: Tree = growth.tree
        self.steps_: tuple[Step, ...] = growth.steps
        self.n_left_out_: int = growth.n_left_out
        self.n_sampled_: int = growth.n_sampled
        if wanted.classes is not None:
            self.classes_: NDArray[Any] = wanted.classes
        return self

    @abstractmethod
    def _wanted(self, y: ArrayLike, n: int, sample_weight: ArrayLike | None) -> _Wanted:
        """Check what is to be learned."""

    def apply(self, scenes: Scenes) -> NDArray[np.int64]:
        """Ordinal of the deciding leaf of each scene, (n_scenes,)."""
        check_is_fitted(self)
        return query(self.tree_, checked_scenes(scenes), n_jobs=self.n_jobs).leaf

    def explain(self, scenes: Scenes) -> list[Explanation]:
        """Return the objects behind each prediction."""
        check_is_fitted(self)
        return explain(self.tree_, checked_scenes(scenes))


@final
@dataclass(kw_only=True, eq=False, repr=False)
class SMRFTreeClassifier(ClassifierMixin, _SceneTree):  # type: ignore[misc]  # scikit-learn is untyped
    """Probabilistic, existential decision tree over scenes.

    Parameters
    ----------
    test : {"likelihood-ratio", "permutation"}, default "likelihood-ratio"
        Significance test of questions. The likelihood ratio test is that of the source and fast, but accepts
        questions on pure noise more often than `alpha`; the permutation test keeps its level.
    search : {"screened", "exhaustive"}, default "screened"
        How the best question is found. The exhaustive search is that of the source: all possible questions
        on all scenes. The screened search tries them on a few scenes, then the best on all; it is about ten
        times faster.
    alpha : float, default 0.05
        Significance level.
    attempts : int, default 3
        Number of attempts at each possible question (in the screened search at the best of them).
    permutations : int, default 99
        Number of permutations in the permutation test.
    max_points : int, default 100_000
        Of expansions with more instantiation sequences, the screened search looks at a sample of so many,
        and leaves out those with over a hundred times more; the exhaustive search leaves out all of them.
    covagg : CovAggSettings or None, default None
        How volumes are learned, and their shape; by default as published. See
        `relforest.volumes.CovAggSettings`.
    class_weight : {"balanced"}, dict or None, default None
        Weight of each class, by label: those that are not named weigh 1. "balanced" gives all classes the
        same weight in sum. It multiplies `sample_weight`.
    random_state : int, Generator, RandomState, SeedSequence or None, default None
        Seed; an integer makes `fit` reproducible.
    n_jobs : int, default 1
        Number of threads for prediction; -1 for all cores. Does not affect the result.
    verbose : bool, default False
        Whether `fit` prints to standard error what it is doing, at most one line a second.

    Attributes
    ----------
    tree_ : Tree
        The learned tree; ``print(model.tree_)`` describes it in words.
    classes_ : (n_classes,) array
        The labels in sorted order; of two, ``classes_[1]`` is the positive class.
    steps_ : tuple of Step
        The accepted questions, with p-values, in the order in which they were learned.
    n_left_out_ : int
        Number of expansions left out because of `max_points`.
    n_sampled_ : int
        Number of expansions searched by a sample because of `max_points`.

    Notes
    -----
    With more than two classes, the leaf with the largest share of any class but the most common one decides:
    what exists in a scene speaks for a special class, and the common one is left with the rest.

    References
    ----------
    Palmer (2015), chapter 4.

    Examples
    --------
    >>> import numpy as np
    >>> from relforest import Attribute, Scenes, Schema, SMRFTreeClassifier
    >>> rng = np.random.default_rng(0)
    >>> places = rng.uniform(0, 10, size=(60, 3, 2))
    >>> records = [{"objects": [{"location": place} for place in scene]} for scene in places.tolist()]
    >>> scenes = Scenes.from_dicts(records)
    >>> close = [min(np.linalg.norm(scene[i] - scene[i - 1]) for i in range(3)) < 3 for scene in places]
    >>> model = SMRFTreeClassifier(random_state=0).fit(scenes, close)
    >>> print(model.tree_)
    SMRF tree with 1 question and 3 leaves
    there are A and B such that B is within 3.13 of A
        yes: 1.00  (36 of 36 scenes positive)
        no: 0.00  (0 of 24 scenes positive)
    """

    class_weight: ClassWeight = None

    def _wanted(self, y: ArrayLike, n: int, sample_weight: ArrayLike | None) -> _Wanted:
        classes, codes = class_labels(y, n, what="scenes")
        weights = scene_weights(sample_weight, n)
        by_class = class_weights(self.class_weight, classes, codes, weights)
        if by_class is not None:
            weights = scene_weights(by_class[codes] * (1.0 if weights is None else weights), n)
        kept = slice(None) if weights is None else weights > 0
        positive = None if weights is None else weights[kept]
        if len(classes) == 2:
            return _Wanted([Target.binary(codes[kept] == 1, positive)], weights, classes)
        return _Wanted([Target.classes(codes[kept], len(classes), positive)], weights, classes)

    def predict_proba(self, scenes: Scenes) -> NDArray[np.float64]:
        """Probability of each class, (n_scenes, n_classes)."""
        leaf = self.apply(scenes)
        if len(self.classes_) > 2:
            return self.tree_.values[leaf]
        positive = self.tree_.leaf_probabilities[leaf]
        return np.column_stack([1.0 - positive, positive])

    def predict(self, scenes: Scenes) -> NDArray[Any]:
        """Most probable class of each scene, (n_scenes,); the positive one at even odds."""
        probabilities = self.predict_proba(scenes)
        if len(self.classes_) > 2:
            chosen = probabilities.argmax(axis=1)
        else:
            chosen = (probabilities[:, 1] >= 0.5).astype(np.int64)
        predicted: NDArray[Any] = self.classes_[chosen]
        return predicted


@final
@dataclass(kw_only=True, eq=False, repr=False)
class SMRFTreeRegressor(RegressorMixin, _SceneTree):  # type: ignore[misc]  # scikit-learn is untyped
    """Existential regression tree over scenes: each leaf predicts the mean of its training scenes.

    Of all leaves that a scene reaches, one end decides: the one with the highest mean, as the most probable
    one does in a classifier, or the one with the lowest. What exists in a scene raises the prediction in the
    first case and lowers it in the second. Other parameters are those of `SMRFTreeClassifier`, without
    ``class_weight``.

    Parameters
    ----------
    decides : {"highest", "lowest", "either"}, default "either"
        Which leaf decides. With "either", a tree of each is grown, each at its share of `alpha`, and the
        one under which the targets are more likely is kept.

    Attributes
    ----------
    tree_ : Tree
        The learned tree; ``print(model.tree_)`` describes it in words.
    steps_, n_left_out_, n_sampled_
        As for `SMRFTreeClassifier`.

    Notes
    -----
    Questions are chosen and tested by the likelihood of Gaussian errors with one variance for all leaves.

    Examples
    --------
    >>> import numpy as np
    >>> from relforest import Scenes, SMRFTreeRegressor
    >>> rng = np.random.default_rng(0)
    >>> weights = rng.uniform(0, 10, size=(60, 3))
    >>> records = [{"objects": [{"weight": w} for w in scene]} for scene in weights.tolist()]
    >>> scenes = Scenes.from_dicts(records)
    >>> y = 5.0 + (weights.max(axis=1) > 8) + 0.1 * rng.normal(size=60)
    >>> model = SMRFTreeRegressor(alpha=1e-4, random_state=0).fit(scenes, y)
    >>> print(model.tree_)
    SMRF tree with 1 question and 3 leaves
    there is an A with weight at least 8.03
        yes: mean 5.99  (deviation 0.116, 39 scenes)
        no: mean 4.98  (deviation 0.0871, 21 scenes)
    """

    decides: Decides = "either"

    def _wanted(self, y: ArrayLike, n: int, sample_weight: ArrayLike | None) -> _Wanted:
        values = real_values(y, n, otherwise="use SMRFTreeClassifier for classes")
        weights = scene_weights(sample_weight, n)
        kept = slice(None) if weights is None else weights > 0
        one_of("decides", self.decides, get_args(Decides))
        targets = [
            Target.real(values[kept], None if weights is None else weights[kept], lowest=lowest)
            for lowest in (False, True)
            if self.decides in {"either", "lowest" if lowest else "highest"}
        ]
        return _Wanted(targets, weights)

    def predict(self, scenes: Scenes) -> NDArray[np.float64]:
        """Mean of the deciding leaf of each scene, (n_scenes,)."""
        leaf = self.apply(scenes)
        return self.tree_.leaf_predictions[leaf]


def explain(tree: Tree, scenes: Scenes) -> list[Explanation]:
    """Return the deciding leaf of each scene and its witnesses."""
    answers = query(tree, scenes)
    leaves = [tree.nodes[leaf] for leaf in tree.leaves]
    bound = [tree.n_bound[leaf] for leaf in tree.leaves]
    explanations = []
    for i, leaf in enumerate(answers.leaf):
        witnesses: dict[str, object] = {}
        for variable in range(bound[leaf]):
            row = answers.witnesses[i, variable]
            witnesses[variable_name(variable)] = None if row < 0 else plain(scenes.object_ids[row])
        densities = tuple(answers.densities[i, : len(tree.questions_above[leaf])].tolist())
        node = leaves[leaf]
        said = node.says if isinstance(node, (MeanLeaf, ClassLeaf)) else ""
        explanations.append(
            Explanation(plain(scenes.scene_ids[i]), node.prediction, int(leaf), witnesses, densities, said)
        )
    return explanations
