"""Q as a sum of what questions add, by curves of relational distances and by trees of the same distances.

The value of an action is that of the *base* action, which is offered exactly once in every state (such as to
hold the ball), plus the advantage of doing something else instead. Both are sums of what questions add. Where
there is no such action, the values of each action type are a sum of their own.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Final, final

import numpy as np
from numpy.typing import NDArray

from relforest.forests.conditions import Condition
from relforest.forests.packing import Packed, pack_conditions
from relforest.rl.fitted.evidence import Evidence
from relforest.rl.fitted.forest_arrays import (
    NONE,
    ForestArrays,
    forest_mean,
    path_parts,
    pruned,
)
from relforest.rl.fitted.questions import (
    N_KNOTS,
    Measures,
    Question,
    curves,
    hats,
    knots_of,
    measured,
    spokesmen,
)
from relforest.scenes import Schema
from relforest.scenes.arrays import FloatArray, IntArray

# Trees only compare: where no choice of objects has a distance, it is larger than all others.
_FAR: Final = 1e6


@final
@dataclass(frozen=True, slots=True, eq=False)
class Sum:
    """What the questions of each action type add to a constant.

    A question adds the height of a curve. Where there are trees that compare the same distances, values are
    the mean of both, and a question adds half of what it adds in either.

    Parameters
    ----------
    schemas : tuple of Schema
        Of the scenes of each action type.
    base : int or None
        The action type that the others' advantage is over.
    constants : tuple of float
        One for each action type.
    questions : tuple of tuple of Question
        Those of each action type.
    trees : ForestArrays, optional
        Their features are the distances of the questions; there may be none for some action types.
    """

    schemas: tuple[Schema, ...]
    base: int | None
    constants: tuple[float, ...]
    questions: tuple[tuple[Question, ...], ...]
    trees: ForestArrays | None = None
    packed: tuple[Packed, ...] = field(init=False, repr=False)
    _curves: tuple[FloatArray, ...] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        packed = [
            pack_conditions(schema, [question.condition for question in own])
            for schema, own in zip(self.schemas, self.questions, strict=True)
        ]
        object.__setattr__(self, "packed", tuple(packed))
        drawn = [
            np.array([(question.knots, question.heights) for question in own]).reshape(-1, 2, N_KNOTS)
            for own in self.questions
        ]
        object.__setattr__(self, "_curves", tuple(drawn))

    @classmethod
    def zero(cls, schemas: tuple[Schema, ...], base: int | None) -> Sum:
        """Return a value of 0 for every action."""
        none: tuple[Question, ...] = ()
        return cls(schemas, base, (0.0,) * len(schemas), (none,) * len(schemas))

    def roots(self, number: int) -> IntArray:
        """Return the roots of the trees for actions of one type, (n_trees,)."""
        own = np.empty(0, dtype=np.int64) if self.trees is None else self.trees.roots[0, number]
        return own[own >= 0]

    def worth(self, number: int, seen: Measures, remaining: int | None) -> FloatArray:  # noqa: ARG002
        """Return what actions of one type are worth, (n,), without the value of the base."""
        return self.valued(number, seen.margins)

    def valued(self, number: int, margins: FloatArray) -> FloatArray:
        """Return what actions of one type with these margins (n, k) are worth, (n,); see `worth`."""
        out = np.empty(len(margins))
        knots, heights = self._curves[number][:, 0], self._curves[number][:, 1]
        curves(margins, np.ascontiguousarray(knots), np.ascontiguousarray(heights), out)
        out, roots = out + self.constants[number], self.roots(number)
        if self.trees is None or not len(roots):
            return out
        return 0.5 * (out + forest_mean(self.trees, roots, distances(margins)))

    def adds(self, number: int, margins: FloatArray) -> FloatArray:
        """Return the parts of `valued`, (n, 1 + k): the type as such, then what each question adds.

        In curves, questions are counted from what they usually add; in trees, by the means along the paths.
        """
        knots, heights = self._curves[number][:, 0], self._curves[number][:, 1]
        features = np.empty((len(margins), len(knots) * N_KNOTS))
        hats(margins, np.ascontiguousarray(knots), features)
        usual = np.array([question.usual for question in self.questions[number]])
        own = np.einsum("nkh,kh->nk", features.reshape(len(features), *knots.shape), heights) - usual
        out = np.column_stack([np.full(len(own), self.constants[number] + usual.sum()), own])
        roots = self.roots(number)
        if self.trees is None or not len(roots):
            return out
        return 0.5 * (out + path_parts(self.trees, roots, distances(margins)))

    def shares(self, number: int, seen: Measures, remaining: int | None) -> FloatArray:  # noqa: ARG002
        """Return what `adds` does, questions that are alike together with the one that stands for them."""
        out = self.adds(number, seen.margins)
        for place, stands in enumerate(spokesmen(self.questions[number]), start=1):
            if stands + 1 != place:
                out[:, 1 + stands] += out[:, place]
                out[:, place] = 0.0
        return out

    def told(self, number: int, place: int) -> tuple[Condition | None, int]:
        """Return what is asked at a place among the questions of an action type, and how many are alike."""
        own = self.questions[number]
        return own[place].condition, spokesmen(own).count(place)

    def curve(self, number: int, question: Question) -> Question:
        """Return a question of actions of one type with its heights as they count: half where trees do."""
        share = 0.5 if len(self.roots(number)) else 1.0
        return replace(question, heights=tuple(share * height for height in question.heights))

    def most_important(self, n: int) -> Sum:
        """Return the sum of the `n` questions that matter most for choosing; the others add what is usual.

        Those of the base are the last to count: they say how good a state is, and that is the same for all
        of its actions. What trees would ask next if they compared what is left out, they do not ask either.
        """
        every = [(number, place) for number, own in enumerate(self.questions) for place in range(len(own))]
        every.sort(key=lambda at: (at[0] == self.base, -self.questions[at[0]][at[1]].spread))
        kept = set(every[:n])
        constants, questions, places = [], [], []
        for number, own in enumerate(self.questions):
            is_kept = np.array([(number, place) in kept for place in range(len(own))], dtype=np.bool_)
            rest = [question.usual for question, stays in zip(own, is_kept, strict=True) if not stays]
            constants.append(self.constants[number] + sum(rest))
            questions.append(tuple(question for question, stays in zip(own, is_kept, strict=True) if stays))
            places.append(np.where(is_kept, is_kept.cumsum() - 1, NONE))
        trees = None if self.trees is None else pruned(self.trees, places)
        return replace(self, constants=tuple(constants), questions=tuple(questions), trees=trees)

    @property
    def size(self) -> tuple[int, int]:
        """Number of questions, and of all heights and leaves."""
        n_questions = sum(map(len, self.questions))
        n_leaves = 0 if self.trees is None else int((self.trees.feature < 0).sum())
        return n_questions, n_questions * N_KNOTS + n_leaves

    def offered(self, places: Sequence[int | None], schemas: tuple[Schema, ...]) -> Sum:
        """Return the same questions, which add nothing, for actions of other types.

        `places` are those of the types here whose questions they get.
        """
        own = (() if place is None else self.questions[place] for place in places)
        questions = tuple(tuple(Question(each.condition, each.knots) for each in asked) for asked in own)
        return Sum(schemas, None, (0.0,) * len(schemas), questions)

    def asked_of(self, evidence: Evidence) -> Sum:
        """Return the same questions, which add nothing, with the knots of this evidence if it has any."""
        found: list[tuple[Question, ...]] = []
        base = evidence.base_type()
        for number, (packed, own) in enumerate(zip(self.packed, self.questions, strict=True)):
            _, rows = evidence.examples(number, is_base=number == base)
            margins = measured(packed, evidence.scenes[number].take(rows), evidence.n_jobs).margins
            knots = map(knots_of, margins.T)
            kept = zip(own, knots, strict=True)
            found.append(tuple(Question(each.condition, at) for each, at in kept if at is not None))
        return Sum(self.schemas, base, (0.0,) * len(found), tuple(found))


def distances(margins: FloatArray) -> NDArray[np.float32]:
    """Return what trees compare, (n, k)."""
    return np.where(np.isnan(margins), _FAR, margins).astype(np.float32)
