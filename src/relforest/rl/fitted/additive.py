"""Q as a sum of curves of relational distances: fitted Q iteration with one ridge for all action types.

The value of an action is that of the *base* action, which is offered exactly once in every state (such as to
hold the ball), plus the advantage of doing something else instead. Both are sums of questions' curves. Where
there is no such action, the values of each action type are a sum of their own.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Final, final

import numpy as np
from scipy.linalg import cho_factor, cho_solve

from relforest.forests.conditions import Condition
from relforest.forests.packing import Packed, pack_conditions
from relforest.rl.fitted.evidence import Evidence, check_values
from relforest.rl.fitted.questions import (
    N_KNOTS,
    Measures,
    Question,
    curves,
    features_of,
    hats,
    knots_of,
    measured,
    spokesmen,
)
from relforest.rl.fitted.search import new_questions
from relforest.rl.fitted.settings import CurveSettings
from relforest.scenes import Schema
from relforest.scenes.arrays import FloatArray
from relforest.support.progress import report

Features = np.ndarray[Any, np.dtype[np.float32]]

# The mean value is not penalised, the mean advantage of an action type hardly.
_FREE: Final = 1e-3
_NEARLY_FREE: Final = 0.3
# Features that hardly vary are not blown up.
_LEAST_SPREAD: Final = 1e-3
# The features of the questions that a run begins with varied by about so much where they come from, as their
# knots are quantiles. Here, some may be true of a few transitions only, which would then fix their weights.
_SPREAD_BEFORE: Final = 0.3
_SETTLED: Final = 0.02


@final
@dataclass(frozen=True, slots=True, eq=False)
class Sum:
    """A constant and the questions of each action type.

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
    """

    schemas: tuple[Schema, ...]
    base: int | None
    constants: tuple[float, ...]
    questions: tuple[tuple[Question, ...], ...]
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

    def shares(self, number: int, seen: Measures, remaining: int | None) -> FloatArray:  # noqa: ARG002
        """Return the parts of what `worth` returns, (n, 1 + k): the type as such, then each question.

        Questions are counted from what they usually add, and those alike with the one that stands for them.
        """
        knots, heights = self._curves[number][:, 0], self._curves[number][:, 1]
        features = np.empty((len(seen.margins), len(knots) * N_KNOTS))
        hats(seen.margins, np.ascontiguousarray(knots), features)
        usual = np.array([question.usual for question in self.questions[number]])
        adds = np.einsum("nkh,kh->nk", features.reshape(len(features), *knots.shape), heights) - usual
        out = np.zeros((len(adds), 1 + len(usual)))
        out[:, 0] = self.constants[number] + usual.sum()
        for place, stands in enumerate(spokesmen(self.questions[number]), start=1):
            out[:, 1 + stands] += adds[:, place - 1]
        return out

    def told(self, number: int, place: int) -> tuple[Condition | None, int]:
        """Return what is asked at a place among the questions of an action type, and how many are alike."""
        own = self.questions[number]
        return own[place].condition, spokesmen(own).count(place)

    def most_important(self, n: int) -> Sum:
        """Return the sum of the `n` questions that matter most for choosing; the others add what is usual.

        Those of the base are the last to count: they say how good a state is, and that is the same for all
        of its actions.
        """
        every = [(number, place) for number, own in enumerate(self.questions) for place in range(len(own))]
        every.sort(key=lambda at: (at[0] == self.base, -self.questions[at[0]][at[1]].spread))
        kept = set(every[:n])
        constants, questions = [], []
        for number, own in enumerate(self.questions):
            is_kept = [(number, place) in kept for place in range(len(own))]
            rest = [question.usual for question, stays in zip(own, is_kept, strict=True) if not stays]
            constants.append(self.constants[number] + sum(rest))
            questions.append(tuple(question for question, stays in zip(own, is_kept, strict=True) if stays))
        return replace(self, constants=tuple(constants), questions=tuple(questions))

    @property
    def size(self) -> tuple[int, int]:
        """Number of questions, and of all their heights."""
        n_questions = sum(map(len, self.questions))
        return n_questions, n_questions * N_KNOTS

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

    def worth(self, number: int, seen: Measures, remaining: int | None) -> FloatArray:  # noqa: ARG002
        """Return what actions of one type are worth, (n,), without the value of the base."""
        out = np.empty(len(seen.margins))
        knots, heights = self._curves[number][:, 0], self._curves[number][:, 1]
        curves(seen.margins, np.ascontiguousarray(knots), np.ascontiguousarray(heights), out)
        return out + self.constants[number]


def improved(
    total: Sum,
    evidence: Evidence,
    settings: CurveSettings,
    rng: np.random.Generator,
    *,
    start: Sum | None,
    is_first: bool,
) -> Sum:
    """Return the sum that is learned from all experience, with new questions.

    Parameters
    ----------
    total : Sum
        What was learned before.
    evidence : Evidence
    settings : CurveSettings
    rng : Generator
    start : Sum or None
        What was known before there was any of this experience: the penalty is on what is different from it.
        Its questions are the first of `total`.
    is_first : bool
        Whether nothing was learned before: then the first questions are about what the policy of the
        experience earned, without any maximum over values that mean nothing yet.

    References
    ----------
    Ernst, Geurts and Wehenkel, Tree-based batch mode reinforcement learning (2005), for fitted Q iteration.
    """
    if is_first:
        # Questions of another task were made for other distances.
        total = total.asked_of(evidence)
    fit = _Fit.of(total, evidence, start or Sum.zero(total.schemas, total.base))
    fit, targets = fit.solved(settings, sweeps=0 if is_first else settings.sweeps)
    for turn in range(settings.rounds):
        report("rounds of questions", turn, settings.rounds)
        residuals = targets - fit.values()[evidence.taken]
        grown = fit
        for number in range(len(total.schemas)):
            grown = grown.with_questions(number, _sought(fit, number, residuals, settings, rng))
        if grown is fit and not is_first:
            break
        earned = is_first and turn < settings.rounds // 2
        fit, targets = grown.solved(settings, sweeps=0 if earned else settings.sweeps)
    check_values(fit.values(), evidence)
    return fit.described()


def _sought(
    fit: _Fit, number: int, residuals: FloatArray, settings: CurveSettings, rng: np.random.Generator
) -> list[Question]:
    """Return new questions about actions of one type."""
    asked = fit.total.questions[number]
    room = settings.max_questions - len(asked)
    transitions, rows = fit.evidence.examples(number, is_base=number == fit.total.base)
    if room <= 0 or not len(rows):
        return []
    chosen = np.sort(rng.permutation(len(rows))[: settings.max_scenes])
    scenes = fit.evidence.scenes[number].take(rows[chosen])
    return new_questions(scenes, residuals[transitions[chosen]], settings, rng, asked)[:room]


@final
@dataclass(frozen=True, slots=True, eq=False)
class _Fit:
    """A sum, and the features of its questions for all candidates of each action type.

    What is solved for is the difference from `start`, whose values of the actions taken are `known` (n,).
    """

    total: Sum
    evidence: Evidence
    features: tuple[Features, ...]
    start: Sum
    known: FloatArray

    @classmethod
    def of(cls, total: Sum, evidence: Evidence, start: Sum) -> _Fit:
        found = [
            features_of(packed, own, scenes, evidence.n_jobs)
            for packed, own, scenes in zip(total.packed, total.questions, evidence.scenes, strict=True)
        ]
        first = tuple(
            own[:, : len(questions) * N_KNOTS] for own, questions in zip(found, start.questions, strict=True)
        )
        before = cls(start, evidence, first, start, np.empty(0))
        return cls(total, evidence, tuple(found), start, before.values()[evidence.taken])

    def with_questions(self, number: int, added: list[Question]) -> _Fit:
        """Return the fit with more questions for one action type."""
        if not added:
            return self
        total, schema = self.total, self.total.schemas[number]
        packed = pack_conditions(schema, [question.condition for question in added])
        more = features_of(packed, added, self.evidence.scenes[number], self.evidence.n_jobs)
        questions, features = list(total.questions), list(self.features)
        questions[number] = (*questions[number], *added)
        features[number] = np.hstack([features[number], more])
        return replace(self, total=replace(total, questions=tuple(questions)), features=tuple(features))

    def described(self) -> Sum:
        """Return the sum, with the spread of each question."""
        found = []
        for number, own in enumerate(self.total.questions):
            _, rows = self.evidence.examples(number, is_base=number == self.total.base)
            shares = self.features[number][rows].reshape(len(rows), len(own), N_KNOTS)
            heights = np.array([question.heights for question in own]).reshape(-1, N_KNOTS)
            spreads = (
                np.einsum("nqk,qk->nq", shares, heights).std(axis=0) if len(rows) else np.zeros(len(own))
            )
            found.append(
                tuple(replace(each, spread=float(spread)) for each, spread in zip(own, spreads, strict=True))
            )
        return replace(self.total, questions=tuple(found))

    def values(self) -> FloatArray:
        """Return Q of all candidates, (n_candidates,)."""
        total, evidence = self.total, self.evidence
        out = np.empty(len(evidence.owner))
        own = [
            features @ np.concatenate([[], *(question.heights for question in questions)]).astype(np.float32)
            + constant
            for features, questions, constant in zip(
                self.features, total.questions, total.constants, strict=True
            )
        ]
        for values, candidates in zip(own, evidence.candidates, strict=True):
            out[candidates] = values
        if total.base is not None:
            of_state = out[evidence.base_of(total.base)]
            is_base = evidence.types == total.base
            out = np.where(is_base, out, out + of_state[evidence.owner])
        return out

    def solved(self, settings: CurveSettings, *, sweeps: int) -> tuple[_Fit, FloatArray]:
        """Return the fit after policy iteration, and the returns (n,) that it explains.

        Without any `sweeps`, it explains what was earned.
        """
        evidence, system = self.evidence, _System.of(self, settings)
        if sweeps == 0:
            earned = evidence.earned()
            return system.solve(self, earned), earned
        fit, before = self, None
        for _ in range(sweeps):
            targets = evidence.targets(fit.values(), settings.trace)
            fit = system.solve(fit, targets)
            if before is not None and np.abs(targets - before).mean() < _SETTLED * evidence.scale:
                break
            before = targets
        return fit, evidence.targets(fit.values(), settings.trace)


@final
@dataclass(frozen=True, slots=True, eq=False)
class _System:
    """The normal equations of a ridge, which is solved for several targets."""

    matrix: Features  # (n, k)
    factor: tuple[FloatArray, bool]
    means: tuple[FloatArray, ...]  # of the features of each action type, where they count
    spreads: tuple[FloatArray, ...]

    @classmethod
    def of(cls, fit: _Fit, settings: CurveSettings) -> _System:
        evidence, n_types = fit.evidence, len(fit.features)
        n = len(evidence.taken)
        constant = np.zeros((n, 1 + n_types), dtype=np.float32)
        constant[:, 0] = 1.0
        blocks, means, spreads, penalty = [constant], [], [], [np.full(1 + n_types, _NEARLY_FREE)]
        penalty[0][0] = _FREE
        for number, features in enumerate(fit.features):
            is_base = number == fit.total.base
            transitions, rows = evidence.examples(number, is_base=is_base)
            if not is_base:
                constant[transitions, 1 + number] = 1.0
            own = features[rows]
            mean = own.mean(axis=0) if len(own) else np.zeros(own.shape[1])
            spread = (own.std(axis=0) if len(own) else np.zeros(own.shape[1])) + _LEAST_SPREAD
            first = len(fit.start.questions[number]) * N_KNOTS
            spread[:first] = np.maximum(spread[:first], _SPREAD_BEFORE)
            block = np.zeros((n, own.shape[1]), dtype=np.float32)
            block[transitions] = (own - mean) / spread
            blocks.append(block)
            means.append(np.asarray(mean, dtype=np.float64))
            spreads.append(np.asarray(spread, dtype=np.float64))
            penalty.append(np.where(np.arange(own.shape[1]) < first, settings.prior, settings.ridge))
        matrix = np.hstack(blocks)
        normal = (matrix.T @ matrix).astype(np.float64) + np.diag(np.concatenate(penalty))
        return cls(matrix, cho_factor(normal), tuple(means), tuple(spreads))

    def solve(self, fit: _Fit, targets: FloatArray) -> _Fit:
        """Return the fit with the weights that explain the targets (n,) best."""
        total, start, unknown = fit.total, fit.start, targets - fit.known
        mean = float(unknown.mean())
        found = cho_solve(self.factor, (self.matrix.T @ (unknown - mean).astype(np.float32)).astype(float))
        first = 1 + len(total.questions)
        constants, questions = [], []
        for number, own in enumerate(total.questions):
            end = first + len(own) * N_KNOTS
            weights = found[first:end] / self.spreads[number]
            # Without a base, the values of every type contain the mean.
            shared = mean + found[0] if number == total.base or total.base is None else 0.0
            constant = float(shared + found[1 + number] - weights @ self.means[number])
            constants.append(start.constants[number] + constant)
            heights = weights.reshape(-1, N_KNOTS)
            before = start.questions[number]
            heights[: len(before)] += np.array([each.heights for each in before]).reshape(-1, N_KNOTS)
            questions.append(
                tuple(
                    replace(question, heights=tuple(each))
                    for question, each in zip(own, heights.tolist(), strict=True)
                )
            )
            first = end
        total = replace(total, constants=tuple(constants), questions=tuple(questions))
        return replace(fit, total=total)
