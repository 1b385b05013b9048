"""SMRF trees as a scikit-learn classifier of scenes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Self, final

import numpy as np
from sklearn.base import BaseEstimator, ClassifierMixin
from sklearn.utils.validation import check_is_fitted

from relforest.scenes import Scenes
from relforest.scenes.ids import plain
from relforest.scenes.labels import binary_labels
from relforest.support.errors import InputError
from relforest.support.numerals import probability
from relforest.support.progress import printed_to_stderr
from relforest.support.rng import RandomState, generator, seed_sequence
from relforest.trees.growth import grow
from relforest.trees.inference import query
from relforest.trees.nodes import variable_name
from relforest.trees.search import SearchName
from relforest.trees.settings import Test, TreeSettings

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from relforest.trees.growth import Step
    from relforest.trees.tree import Tree


@final
@dataclass(frozen=True, slots=True)
class Explanation:
    """The reason for the prediction of a scene.

    Parameters
    ----------
    scene : object
        Identifier of the scene.
    probability : float
        Probability of the positive class.
    leaf : int
        Ordinal of the deciding leaf.
    witnesses : dict of str to object
        Identifiers of the bound objects by variable, for the most representative instantiation sequence that
        reaches the leaf; None if no object was left to bind.
    densities : tuple of float
        How typical the witnesses are for each question above the leaf, starting at the root: 1 at the centre
        of its volume, 0 far away or if the question could not be answered.
    """

    scene: object
    probability: float
    leaf: int
    witnesses: dict[str, object]
    densities: tuple[float, ...]

    def __str__(self) -> str:
        """Return the explanation on one line."""
        bound = ", ".join(f"{name} = {witness}" for name, witness in self.witnesses.items())
        found = f"probability {probability(self.probability)}, leaf {self.leaf}"
        return f"scene {self.scene}: {found}, {bound or 'no objects'}"


@final
class SMRFTreeClassifier(ClassifierMixin, BaseEstimator):  # type: ignore[misc]  # scikit-learn is untyped
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
        Number of attempts at each possible question in the exhaustive search. The screened search makes
        fewer, but corrects for as many comparisons.
    permutations : int, default 99
        Number of permutations in the permutation test.
    max_points : int, default 100_000
        Of expansions with more instantiation sequences, the screened search looks at a sample of so many,
        and leaves out those with over a hundred times more; the exhaustive search leaves out all of them.
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
    classes_ : ndarray (2,)
        The two labels; ``classes_[1]`` is the positive class.
    steps_ : tuple of Step
        The accepted questions, with p-values, in the order in which they were learned.
    n_left_out_ : int
        Number of expansions left out because of `max_points`.
    n_sampled_ : int
        Number of expansions searched by a sample because of `max_points`.

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
    there are A and B such that B is between 0.199 and 3.07 from A
        yes: 1.00  (36 of 36 scenes positive)
        no: 0.00  (0 of 24 scenes positive)
    """

    def __init__(  # noqa: PLR0913  # scikit-learn sets options in the constructor
        self,
        *,
        test: Test = "likelihood-ratio",
        search: SearchName = "screened",
        alpha: float = 0.05,
        attempts: int = 3,
        permutations: int = 99,
        max_points: int = 100_000,
        random_state: RandomState = None,
        n_jobs: int = 1,
        verbose: bool = False,
    ) -> None:
        self.test = test
        self.search = search
        self.alpha = alpha
        self.attempts = attempts
        self.permutations = permutations
        self.max_points = max_points
        self.random_state = random_state
        self.n_jobs = n_jobs
        self.verbose = verbose

    def fit(self, scenes: Scenes, y: ArrayLike) -> Self:
        """Learn a tree.

        Parameters
        ----------
        scenes : Scenes
        y : array-like (n_scenes,)
            0/1, -1/+1, booleans or two strings, aligned with ``scenes.scene_ids``.

        Raises
        ------
        InputError
            If the labels do not match the scenes or are not of two classes, or a parameter is out of range.
        """
        settings = TreeSettings(
            test=self.test,
            search=self.search,
            alpha=self.alpha,
            attempts=self.attempts,
            permutations=self.permutations,
            max_points=self.max_points,
        )
        labels = binary_labels(y, len(_checked(scenes)), what="scenes")
        rng = generator(seed_sequence(self.random_state))
        with printed_to_stderr(self.verbose):
            growth = grow(scenes, labels.positive, rng=rng, settings=settings)
        self.classes_ = labels.classes
        self.tree_: Tree = growth.tree
        self.steps_: tuple[Step, ...] = growth.steps
        self.n_left_out_: int = growth.n_left_out
        self.n_sampled_: int = growth.n_sampled
        return self

    def predict_proba(self, scenes: Scenes) -> NDArray[np.float64]:
        """Probability of each class, shape (n_scenes, 2)."""
        positive = self._leaf_probabilities()[self.apply(scenes)]
        return np.column_stack([1.0 - positive, positive])

    def predict(self, scenes: Scenes) -> NDArray[Any]:
        """Most probable class of each scene, shape (n_scenes,)."""
        is_positive = self._leaf_probabilities()[self.apply(scenes)] >= 0.5
        predicted: NDArray[Any] = self.classes_[is_positive.astype(np.int64)]
        return predicted

    def apply(self, scenes: Scenes) -> NDArray[np.int64]:
        """Ordinal of the deciding leaf of each scene, shape (n_scenes,)."""
        check_is_fitted(self)
        return query(self.tree_, _checked(scenes), n_jobs=self.n_jobs).leaf

    def explain(self, scenes: Scenes) -> list[Explanation]:
        """Return the objects behind each prediction."""
        check_is_fitted(self)
        return explain(self.tree_, _checked(scenes))

    def _leaf_probabilities(self) -> NDArray[np.float64]:
        check_is_fitted(self)
        return self.tree_.leaf_probabilities


def explain(tree: Tree, scenes: Scenes) -> list[Explanation]:
    """Return the deciding leaf of each scene and its witnesses."""
    answers = query(tree, scenes)
    probabilities = tree.leaf_probabilities
    bound = [tree.n_bound[leaf] for leaf in tree.leaves]
    explanations = []
    for i, leaf in enumerate(answers.leaf):
        witnesses: dict[str, object] = {}
        for variable in range(bound[leaf]):
            row = answers.witnesses[i, variable]
            witnesses[variable_name(variable)] = None if row < 0 else plain(scenes.object_ids[row])
        densities = tuple(answers.densities[i, : len(tree.questions_above[leaf])].tolist())
        explanations.append(
            Explanation(
                plain(scenes.scene_ids[i]), float(probabilities[leaf]), int(leaf), witnesses, densities
            )
        )
    return explanations


def _checked(scenes: object) -> Scenes:
    if not isinstance(scenes, Scenes):
        msg = f"expected Scenes, got {type(scenes).__name__}: use Scenes.from_frame or Scenes.from_dicts"
        raise InputError(msg)
    return scenes
