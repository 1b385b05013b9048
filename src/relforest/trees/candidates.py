"""Candidate questions at one leaf: their points, and the best volume for given labels."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Protocol, final

import numpy as np

from relforest.support.progress import report
from relforest.trees.expansions import Expansion, expansions
from relforest.trees.kernels import ERROR, NO, YES, answer_tuples
from relforest.trees.nodes import Leaf, Question
from relforest.trees.packing import pack
from relforest.trees.probabilities import Assignment, assign
from relforest.trees.sequences import Sequences, n_extensions, rows_of
from relforest.trees.significance import added_parameters, likelihood_ratio_p
from relforest.trees.structure import MAX_VARIABLES
from relforest.volumes import Volume, aggregate
from relforest.volumes.settings import CovAggSettings

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from relforest.mappings import Mapping
    from relforest.scenes import Scenes


class SearchSettings(Protocol):
    """The part of `TreeSettings` that the search needs."""

    @property
    def attempts(self) -> int:
        """Tries per expansion."""
        ...

    @property
    def covagg(self) -> CovAggSettings:
        """Parameters of covariant aggregation."""
        ...


@final
@dataclass(frozen=True, slots=True, eq=False)
class PreparedQuestion:
    """An expansion, with everything about it that is independent of labels.

    Parameters
    ----------
    scenes : Scenes
    expansion : Expansion
    sequences : Sequences
        All instantiation sequences at the question.
    asked : Sequences
        The distinct tuples of objects that it asks about, scene by scene.
    """

    scenes: Scenes
    expansion: Expansion
    sequences: Sequences
    asked: Sequences
    rows: NDArray[np.int64] = field(init=False)
    """Object rows of `asked`."""
    points: NDArray[np.float64] = field(init=False)
    """Defined points (n_points, d), grouped by scene."""
    starts: NDArray[np.int64] = field(init=False)
    """Where each scene's points begin, (n_bags + 1,)."""
    bag_scenes: NDArray[np.int64] = field(init=False)
    """Scene of each bag, (n_bags,): scenes with at least one defined point."""

    def __post_init__(self) -> None:
        rows = rows_of(self.scenes, self.asked)
        points = self.expansion.mapping.evaluate(self.scenes.schema, self.scenes.matrix, rows)
        defined = np.isfinite(points).all(axis=1)
        scene = self.asked.scene[defined]
        bag_scenes, first = np.unique(scene, return_index=True)
        object.__setattr__(self, "rows", rows)
        object.__setattr__(self, "points", points[defined])
        object.__setattr__(self, "starts", np.append(first, len(scene)).astype(np.int64))
        object.__setattr__(self, "bag_scenes", bag_scenes)

    def answers(self, volume: Volume, rows: NDArray[np.int64]) -> NDArray[np.int8]:
        """Answer (`YES`, `NO`, `ERROR`) for each tuple of object rows (n, arity)."""
        mapping = self.expansion.mapping
        node = Question(mapping, tuple(range(mapping.arity)), volume, 1, 2, 3)
        packed = pack(self.scenes.schema, (node, *(Leaf(0.0, 0, 0),) * 3))
        answers = np.empty(len(rows), dtype=np.int8)
        answer_tuples(packed.nodes, packed.numbers, self.scenes.matrix, rows, answers)
        return answers

    def presence(self, volume: Volume) -> NDArray[np.bool_]:
        """Which scenes would arrive at the Yes, No and Error leaf, (3, n_scenes)."""
        present = np.zeros((3, len(self.scenes)), dtype=np.bool_)
        present[self.answers(volume, self.rows), self.asked.scene] = True
        return present

    def partition(self, volume: Volume) -> tuple[Sequences, Sequences, Sequences]:
        """The sequences that go to the Yes, No and Error leaf."""
        chosen = Sequences(self.sequences.scene, self.sequences.objects[:, self.expansion.variables])
        answers = self.answers(volume, rows_of(self.scenes, chosen))
        yes, no, error = (self.sequences.where(answers == answer) for answer in (YES, NO, ERROR))
        return yes, no, error


@final
@dataclass(frozen=True, slots=True, eq=False)
class Candidate:
    """The best volume found at a leaf.

    Parameters
    ----------
    question : PreparedQuestion
    volume : Volume
    presence : bool ndarray (3, n_scenes)
        Scenes at the Yes, No and Error leaf.
    gain : float
        Increase of the tree's log likelihood.
    p_value : float
        Of the uncorrected likelihood ratio test.
    n_tried : int
        Volumes that competed.
    """

    question: PreparedQuestion
    volume: Volume
    presence: NDArray[np.bool_]
    gain: float
    p_value: float
    n_tried: int

    def beats(self, other: Candidate) -> bool:
        """Whether this one is at least as significant; the larger gain decides where p-values vanish."""
        return (self.p_value, -self.gain) <= (other.p_value, -other.gain)


@final
@dataclass(frozen=True, slots=True, eq=False)
class OpenLeaf:
    """A leaf to be expanded, and how the present tree explains the scenes.

    Parameters
    ----------
    leaf : int
        Ordinal of the leaf.
    presence : bool ndarray (n_leaves, n_scenes)
        Scenes that arrive at each leaf.
    assignment : Assignment
        Which leaf decides each scene, and the probabilities.
    """

    leaf: int
    presence: NDArray[np.bool_]
    assignment: Assignment

    def relabelled(self, labels: NDArray[np.bool_]) -> OpenLeaf:
        """The same leaf of the same tree, with probabilities from other labels."""
        return OpenLeaf(self.leaf, self.presence, assign(self.presence, labels))

    def expanded(self, below: NDArray[np.bool_], labels: NDArray[np.bool_]) -> Assignment:
        """The assignment if leaves with presence `below` replaced this one."""
        presence = (self.presence[: self.leaf], below, self.presence[self.leaf + 1 :])
        return assign(np.vstack(presence), labels)


def prepare(
    scenes: Scenes,
    places: NDArray[np.int64],
    at_leaf: Sequences,
    mappings: tuple[Mapping, ...],
    max_points: int,
) -> tuple[list[PreparedQuestion], int]:
    """Prepare every expansion of a leaf.

    Returns the expansions that have points, and the number left out because of `max_points` or because the
    branch already binds as many variables as allowed. Expansions without a defined point are dropped.
    """
    prepared: list[PreparedQuestion] = []
    extended = [at_leaf]
    left_out = 0
    for expansion in expansions(mappings, at_leaf.depth, scenes.schema.n_parameters):
        report("expansions prepared", len(prepared))
        # Step by step: there may be no expansion with fewer new variables, if no mapping takes so few.
        while len(extended) <= expansion.n_new and not _too_many(extended[-1], scenes, places, max_points):
            extended.append(extended[-1].extended(scenes.counts, places))
        if len(extended) <= expansion.n_new:
            left_out += 1
            continue
        sequences = extended[expansion.n_new]
        question = PreparedQuestion(scenes, expansion, sequences, sequences.distinct(expansion.variables))
        if len(question.points):
            prepared.append(question)
    return prepared, left_out


def _too_many(sequences: Sequences, scenes: Scenes, places: NDArray[np.int64], max_points: int) -> bool:
    if sequences.depth == MAX_VARIABLES:
        return True
    return n_extensions(sequences.scene, sequences.objects, scenes.counts, places) > max_points


def best_candidate(
    questions: list[PreparedQuestion],
    labels: NDArray[np.bool_],
    at: OpenLeaf,
    settings: SearchSettings,
    rng: np.random.Generator,
) -> Candidate | None:
    """The most significant volume over all questions and attempts; None if no volume separates anything."""
    best: Candidate | None = None
    n_tried = 0
    for number, question in enumerate(questions):
        report("expansions tried", number, len(questions))
        mapping = question.expansion.mapping
        for _ in range(settings.attempts):
            n_tried += 1
            found = aggregate(
                question.points,
                question.starts,
                labels[question.bag_scenes],
                rng=rng,
                space=mapping.space,
                objective="log-likelihood",
                settings=settings.covagg,
            )
            if found is None:
                continue
            below = question.presence(found.volume)
            gain = at.expanded(below, labels).log_likelihood - at.assignment.log_likelihood
            n_parameters = added_parameters(mapping, has_errors=bool(below[ERROR].any()))
            p_value = likelihood_ratio_p(gain, n_parameters)
            candidate = Candidate(question, found.volume, below, gain, p_value, 0)
            if best is None or not best.beats(candidate):
                best = candidate
    if best is None:
        return None
    return Candidate(best.question, best.volume, best.presence, best.gain, best.p_value, n_tried)
