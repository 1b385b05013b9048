"""Why an ensemble predicts what it predicts, and what it looks at most."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, final

from relforest.forests.questions import answers, compared, node_means, questions
from relforest.scenes.ids import plain

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from relforest.forests.ensemble import Ensemble
    from relforest.scenes import Scenes


@final
@dataclass(frozen=True, slots=True)
class Reason:
    """A question that moved a prediction.

    Parameters
    ----------
    sentence : str
        The condition in words.
    holds : bool
        Whether it holds in the scene.
    witnesses : dict of str to object
        Identifiers of the arguments, and of the objects for which it holds. If it does not hold, of the
        arguments only, or for a SMRF tree, of the objects that decide.
    contribution : float
        By how much the answer moved the score, compared with the average training scene at that question.
    n_questions : int
        How many questions it stands for, of which it is the strongest.
    """

    sentence: str
    holds: bool
    witnesses: dict[str, object]
    contribution: float
    n_questions: int = 1

    def __str__(self) -> str:
        """Return the reason on one line."""
        bound = ", ".join(f"{name} = {witness}" for name, witness in self.witnesses.items())
        told = f" ({bound})" if bound else ""
        more = f", and {self.n_questions - 1} more like it" if self.n_questions > 1 else ""
        said = f"{'' if self.holds else 'it is not so that '}{self.sentence}"
        return f"{self.contribution:+.2f}: {said}{told}{more}"


@final
@dataclass(frozen=True, slots=True)
class ScoreExplanation:
    """The reasons for the score of a scene, the strongest first.

    Parameters
    ----------
    scene : object
        Identifier of the scene.
    score : float
        The score: log-odds, a probability, or a real value.
    reasons : tuple of Reason
    """

    scene: object
    score: float
    reasons: tuple[Reason, ...]

    def __str__(self) -> str:
        """Return score and reasons, one per line."""
        lines = [f"scene {self.scene}: score {self.score:.3g}", *map(str, self.reasons)]
        return "\n    ".join(lines)


@final
@dataclass(frozen=True, slots=True)
class Importance:
    """How much of the training loss the questions that compare the same took away.

    Parameters
    ----------
    question : str
        The mappings and objects that it compares, such as ``"distance(location) of passer, C"``.
    share : float
        Its share of the gain of all questions.
    n_questions : int
        Number of these questions.
    """

    question: str
    share: float
    n_questions: int


def explain_scores(
    ensemble: Ensemble, scenes: Scenes, outputs: NDArray[np.int64], most: int, *, together: bool = False
) -> list[ScoreExplanation]:
    """Return the `most` strongest reasons for one output of every scene (n_scenes,).

    With `together`, questions whose first statements are about the same count as one reason.
    """
    means = [node_means(tree) for tree in ensemble.trees]
    scenes = scenes.recoded(ensemble.schema)
    scores = ensemble.scores(scenes)
    return [
        ScoreExplanation(
            plain(scenes.scene_ids[number]),
            float(scores[number, outputs[number]]),
            _reasons(ensemble, scenes.take([number]), means, int(outputs[number]), most, together=together),
        )
        for number in range(len(scenes))
    ]


def importances(ensemble: Ensemble) -> list[Importance]:
    """Return what questions compare, the most useful first."""
    gains: dict[str, list[float]] = {}
    for tree, weight in zip(ensemble.trees, ensemble.weights, strict=True):
        for asked in questions(tree):
            what = compared(tree, asked.node, ensemble.schema)
            gains.setdefault(what, []).append(asked.gain * abs(float(weight)))
    total = sum(map(sum, gains.values())) or 1.0
    found = [Importance(what, sum(each) / total, len(each)) for what, each in gains.items()]
    return sorted(found, key=lambda each: (-each.share, each.question))


def _reasons(
    ensemble: Ensemble,
    scene: Scenes,
    means: list[list[NDArray[np.float64]]],
    output: int,
    most: int,
    *,
    together: bool,
) -> tuple[Reason, ...]:
    found: dict[tuple[str, bool], Reason] = {}
    subjects: dict[tuple[str, bool], str] = {}
    for number, weight in enumerate(ensemble.weights.tolist()):
        for met in answers(ensemble, number, scene):
            moved = weight * float(means[number][met.child][output] - means[number][met.node][output])
            key = (met.sentence, met.holds)
            before = found[key].contribution if key in found else 0.0
            found[key] = Reason(met.sentence, met.holds, met.witnesses, before + moved)
            subjects[key] = compared(ensemble.trees[number], met.node, ensemble.schema, first=True)
    reasons = sorted(found.values(), key=_strength)
    if together:
        groups: dict[str, list[Reason]] = {}
        for reason in reasons:
            groups.setdefault(subjects[reason.sentence, reason.holds], []).append(reason)
        reasons = sorted(map(_joined, groups.values()), key=_strength)
    return tuple(reasons[:most])


def _joined(reasons: list[Reason]) -> Reason:
    """Return the sum of reasons about the same, told by the strongest one that speaks as they do together."""
    total = sum(reason.contribution for reason in reasons)
    told = next(reason for reason in reasons if reason.contribution * total >= 0.0)
    return replace(told, contribution=total, n_questions=len(reasons))


def _strength(reason: Reason) -> tuple[float, str, bool]:
    return -abs(reason.contribution), reason.sentence, reason.holds
