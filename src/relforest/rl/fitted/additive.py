"""Fitted Q iteration for sums of curves, with one ridge for all action types."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Final, NamedTuple, final

import numpy as np
from scipy.linalg import cho_factor, cho_solve

from relforest.forests.packing import pack_conditions
from relforest.rl.fitted.evidence import Evidence, check_values
from relforest.rl.fitted.questions import N_KNOTS, Question, features_of, measured
from relforest.rl.fitted.search import new_questions
from relforest.rl.fitted.settings import CurveSettings
from relforest.rl.fitted.sum import Sum
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


class Explained(NamedTuple):
    """A sum of curves, and what it was learned from."""

    total: Sum
    margins: tuple[FloatArray, ...]  # of its questions, for all candidates of each action type
    targets: FloatArray  # (n,): what each transition turned out to be worth


def improved(
    total: Sum,
    evidence: Evidence,
    settings: CurveSettings,
    rng: np.random.Generator,
    *,
    start: Sum | None,
    is_first: bool,
) -> Explained:
    """Return curves that are learned from all experience, with new questions.

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
    total = replace(total, trees=None)
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
    return Explained(fit.total, fit.margins, targets)


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
    """A sum, and the margins and features of its questions for all candidates of each action type.

    What is solved for is the difference from `start`, whose values of the actions taken are `known` (n,).
    """

    total: Sum
    evidence: Evidence
    margins: tuple[FloatArray, ...]
    features: tuple[Features, ...]
    start: Sum
    known: FloatArray

    @classmethod
    def of(cls, total: Sum, evidence: Evidence, start: Sum) -> _Fit:
        margins = tuple(
            measured(packed, scenes, evidence.n_jobs).margins
            for packed, scenes in zip(total.packed, evidence.scenes, strict=True)
        )
        found = tuple(features_of(*each) for each in zip(margins, total.questions, strict=True))
        first = tuple(
            own[:, : len(questions) * N_KNOTS] for own, questions in zip(found, start.questions, strict=True)
        )
        before = cls(start, evidence, margins, first, start, np.empty(0))
        return cls(total, evidence, margins, found, start, before.values()[evidence.taken])

    def with_questions(self, number: int, added: list[Question]) -> _Fit:
        """Return the fit with more questions for one action type."""
        if not added:
            return self
        total, schema = self.total, self.total.schemas[number]
        packed = pack_conditions(schema, [question.condition for question in added])
        more = measured(packed, self.evidence.scenes[number], self.evidence.n_jobs).margins
        questions, margins, features = list(total.questions), list(self.margins), list(self.features)
        questions[number] = (*questions[number], *added)
        margins[number] = np.hstack([margins[number], more])
        features[number] = np.hstack([features[number], features_of(more, added)])
        total = replace(total, questions=tuple(questions))
        return replace(self, total=total, margins=tuple(margins), features=tuple(features))

    def values(self) -> FloatArray:
        """Return Q of all candidates, (n_candidates,)."""
        total, out = self.total, np.empty(len(self.evidence.owner))
        own = zip(self.features, total.questions, total.constants, self.evidence.candidates, strict=True)
        for features, questions, constant, candidates in own:
            heights = np.concatenate([[], *(question.heights for question in questions)]).astype(np.float32)
            out[candidates] = features @ heights + constant
        return self.evidence.with_base(out, total.base)

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
