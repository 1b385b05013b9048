"""What arrives at a leaf, the questions that may be asked there, and how good an answer would be."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, final

import numpy as np

from relforest.trees.bags import Bags, bags_of
from relforest.trees.expansions import Expansion, expansions
from relforest.trees.inference import query
from relforest.trees.kernels import ERROR, NO, YES, answer_tuples
from relforest.trees.nodes import Leaf, Question
from relforest.trees.packing import pack_question
from relforest.trees.probabilities import Assignment
from relforest.trees.sequences import Sequences, n_extensions
from relforest.trees.significance import added_parameters, likelihood_ratio_p
from relforest.trees.structure import MAX_VARIABLES

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from relforest.mappings import Mapping
    from relforest.scenes import Scenes
    from relforest.trees.criterion import Target
    from relforest.trees.tree import Tree
    from relforest.volumes import Volume
    from relforest.volumes.settings import Shape


@final
@dataclass(frozen=True, slots=True, eq=False)
class Arrivals:
    """The instantiation sequences that arrive at a leaf, and those of its expansions."""

    scenes: Scenes
    places: NDArray[np.int64]  # (n_scenes, k) positions of the action arguments, see `argument_places`
    mappings: tuple[Mapping, ...]  # the mapping functions that may be asked
    sequences: Sequences

    def expansions(self) -> Iterator[Expansion]:
        """Yield all expansions of the leaf, fewest new variables first."""
        return expansions(self.mappings, self.sequences.depth, self.scenes.schema.n_parameters)

    def only(self, chosen: NDArray[np.int64]) -> Arrivals:
        """Return what arrives from some scenes."""
        is_chosen = np.zeros(len(self.scenes), dtype=np.bool_)
        is_chosen[chosen] = True
        return replace(self, sequences=self.sequences.where(is_chosen[self.sequences.scene]))

    def size(self, n_new: int) -> float:
        """Return the number of sequences with so many more variables; infinite if there are too many."""
        sequences = self.sequences
        if sequences.depth + n_new > MAX_VARIABLES:
            return np.inf
        while n_new > 0 and sequences.depth < self.places.shape[1]:
            sequences = sequences.extended(self.scenes.counts, self.places)
            n_new -= 1
        n = n_extensions(sequences.scene, sequences.objects, self.scenes.counts, self.places, n_new)
        return sequences.ratio * n

    def extended(self, n_new: int, most: int) -> list[Sequences]:
        """Return the sequences with 0 to `n_new` more variables, as far as there are not more than `most`."""
        known = [self.sequences]
        while len(known) <= n_new and replace(self, sequences=known[-1]).size(1) <= most:
            known.append(known[-1].extended(self.scenes.counts, self.places))
        return known

    def drawn(self, n_new: int, most: int, rng: np.random.Generator) -> list[Sequences]:
        """Return the sequences with 0 to `n_new` more variables, samples where there are more than `most`."""
        drawn = [self.sequences]
        while len(drawn) <= n_new:
            drawn.append(drawn[-1].drawn(self.scenes.counts, self.places, most, rng))
        return drawn


@final
@dataclass(frozen=True, slots=True, eq=False)
class PreparedQuestion:
    """An expansion, with everything about it that is independent of labels."""

    scenes: Scenes
    expansion: Expansion
    sequences: Sequences  # the instantiation sequences at the question, all or a sample of them
    asked: Sequences = field(init=False)
    """The distinct tuples of objects that it asks about, scene by scene."""
    bags: Bags = field(init=False)
    """Their points."""

    def __post_init__(self) -> None:
        asked = self.sequences.distinct(self.expansion.variables)
        object.__setattr__(self, "asked", asked)
        object.__setattr__(self, "bags", bags_of(self.scenes, asked, self.expansion.mapping))

    def presence(self, volume: Volume) -> NDArray[np.bool_]:
        """Which scenes would arrive at the Yes, No and Error leaf, (3, n_scenes), by these sequences."""
        return self._answered(volume, self.asked)[1]

    def partition(self, volume: Volume) -> tuple[Sequences, Sequences, Sequences]:
        """The sequences that go to the Yes, No and Error leaf."""
        objects = self.sequences.objects.take(self.expansion.variables, axis=1)
        answers, _ = self._answered(volume, Sequences(self.sequences.scene, objects))
        yes, no, error = (self.sequences.where(answers == answer) for answer in (YES, NO, ERROR))
        return yes, no, error

    def _answered(self, volume: Volume, asked: Sequences) -> tuple[NDArray[np.int8], NDArray[np.bool_]]:
        """Return the answer to each tuple, and which answers every scene has, (3, n_scenes)."""
        mapping, scenes = self.expansion.mapping, self.scenes
        question = Question(mapping, tuple(range(mapping.arity)), volume, 0, 0, 0)
        nodes, numbers = pack_question(scenes.schema, question)
        answers = np.empty(len(asked), dtype=np.int8)
        present = np.zeros((3, len(scenes)), dtype=np.bool_)
        parts = (scenes.rows, scenes.starts, scenes.matrix)
        answer_tuples(nodes, numbers, parts, (asked.scene, asked.objects), answers, present)
        return answers, present


@final
@dataclass(frozen=True, slots=True, eq=False)
class Candidate:
    """The best volume found at a leaf."""

    question: PreparedQuestion
    volume: Volume
    presence: NDArray[np.bool_]  # (3, n_scenes) scenes at the Yes, No and Error leaf
    gain: float  # increase of the tree's log likelihood
    p_value: float  # of the uncorrected likelihood ratio test
    n_tried: int  # volumes that competed, for the correction for multiple comparisons

    def beats(self, other: Candidate) -> bool:
        """Whether this one is at least as significant; the larger gain decides where p-values vanish."""
        return (self.p_value, -self.gain) <= (other.p_value, -other.gain)

    def among(self, n_tried: int) -> Candidate:
        """Return the same candidate as the best of so many."""
        return replace(self, n_tried=n_tried)


@final
@dataclass(frozen=True, slots=True, eq=False)
class OpenLeaf:
    """A leaf to be expanded, and how the present tree explains the scenes."""

    tree: Tree
    leaf: int  # ordinal of the leaf
    presence: NDArray[np.bool_]  # (n_leaves, n_scenes) scenes that arrive at each leaf
    assignment: Assignment  # which leaf decides each scene, and the probabilities

    def retargeted(self, target: Target) -> OpenLeaf:
        """The same leaf of the same tree, with values for another target."""
        return replace(self, assignment=target.assign(self.presence))

    def expanded(self, below: NDArray[np.bool_], target: Target) -> Assignment:
        """The assignment if leaves with presence `below` replaced this one."""
        presence = (self.presence[: self.leaf], below, self.presence[self.leaf + 1 :])
        return target.assign(np.vstack(presence))

    def below(self, question: PreparedQuestion, volume: Volume) -> NDArray[np.bool_]:
        """Which scenes arrive at the Yes, No and Error leaf of a question here, (3, n_scenes).

        Where the question's sequences do not show an answer, the tree is queried, which takes no memory: once
        for each of the three leaves, as if that leaf were the most probable one.
        """
        expansion = question.expansion
        node = Question(expansion.mapping, expansion.variables, volume, 0, 0, 0)
        grown = self.tree.expanded(self.leaf, expansion.n_new, node)
        present = question.presence(volume)
        for answer in range(3):
            sought = self.leaf + answer
            unsure = np.flatnonzero(self.presence[self.leaf] & ~present[answer])
            leaves = [Leaf(float(leaf == sought), 0, 0) for leaf in range(grown.n_leaves)]
            found = query(grown.with_leaves(leaves), question.scenes.take(unsure)).leaf
            present[answer, unsure] = found == sought
        return present

    def judged(
        self,
        question: PreparedQuestion,
        volume: Volume,
        target: Target,
        *,
        exactly: bool = False,
        shape: Shape = "full",
    ) -> Candidate:
        """Return what a volume of this shape would do to the tree, as the only one tried.

        If the question has but a sample of the sequences, then only `exactly` tells for sure who arrives
        where; otherwise scenes without a sequence in the sample count as No.
        """
        below = self.below(question, volume) if exactly else question.presence(volume)
        if question.sequences.ratio > 1.0:
            below[NO] |= self.presence[self.leaf] & ~below.any(axis=0)
        gain = self.expanded(below, target).log_likelihood - self.assignment.log_likelihood
        mapping, has_errors = question.expansion.mapping, bool(below[ERROR].any())
        n_parameters = added_parameters(mapping, has_errors=has_errors, n_values=target.n_values, shape=shape)
        return Candidate(question, volume, below, gain, likelihood_ratio_p(gain, n_parameters), 1)
