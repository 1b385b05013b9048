"""Why an ensemble predicts what it predicts, and what it looks at most."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, cast, final

import numpy as np

from relforest.forests.scene_tree import SceneTree, Split, Value
from relforest.forests.words import sentence
from relforest.scenes.ids import plain

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from relforest.forests.conditions import Condition
    from relforest.forests.ensemble import Ensemble
    from relforest.scenes import Scenes, Schema


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
        Identifiers of the arguments, and of the objects for which it holds; of the arguments only if not.
    contribution : float
        By how much the answer moved the score, compared with the average training scene at that question.
    """

    sentence: str
    holds: bool
    witnesses: dict[str, object]
    contribution: float

    def __str__(self) -> str:
        """Return the reason on one line."""
        bound = ", ".join(f"{name} = {witness}" for name, witness in self.witnesses.items())
        told = f" ({bound})" if bound and self.holds else ""
        return f"{self.contribution:+.2f}: {'' if self.holds else 'it is not so that '}{self.sentence}{told}"


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
    """How much of the training loss a kind of question took away.

    Parameters
    ----------
    question : str
        The mappings and objects that it compares, such as ``"distance(location) of passer, C"``.
    share : float
        Its share of the gain of all questions.
    n_questions : int
        Number of questions of this kind.
    """

    question: str
    share: float
    n_questions: int


def explain_scores(
    ensemble: Ensemble, scenes: Scenes, outputs: NDArray[np.int64], most: int
) -> list[ScoreExplanation]:
    """Return the `most` strongest reasons for one output of every scene (n_scenes,)."""
    means = [node_means(tree) for tree in ensemble.trees]
    scores = ensemble.scores(scenes)
    return [
        ScoreExplanation(
            plain(scenes.scene_ids[number]),
            float(scores[number, outputs[number]]),
            _reasons(ensemble, scenes.take([number]), means, int(outputs[number]), most),
        )
        for number in range(len(scenes))
    ]


def importances(ensemble: Ensemble) -> list[Importance]:
    """Return the kinds of questions, the most useful first."""
    gains: dict[str, list[float]] = {}
    for tree, weight in zip(ensemble.trees, ensemble.weights, strict=True):
        for split in tree.splits:
            kind = question_kind(split.condition, ensemble.schema)
            gains.setdefault(kind, []).append(split.gain * abs(float(weight)))
    total = sum(map(sum, gains.values())) or 1.0
    found = [Importance(kind, sum(each) / total, len(each)) for kind, each in gains.items()]
    return sorted(found, key=lambda each: (-each.share, each.question))


def question_kind(condition: Condition, schema: Schema) -> str:
    """Return what a condition compares, without its numbers."""
    names = [*schema.parameters, "C", "D"]
    parts = {
        f"{statement.mapping.name} of {', '.join(names[variable] for variable in statement.variables)}"
        for statement in condition.statements
    }
    return "; ".join(sorted(parts))


def node_means(tree: SceneTree) -> list[NDArray[np.float64]]:
    """Return the mean number of the leaves below each node, by training scenes."""
    sums: dict[int, tuple[NDArray[np.float64], float]] = {}
    for index in range(len(tree.nodes) - 1, -1, -1):
        node = tree.nodes[index]
        if isinstance(node, Value):
            sums[index] = (np.array(node.numbers) * node.n_scenes, node.n_scenes)
        else:
            (a, n), (b, m) = sums[node.yes], sums[node.no]
            sums[index] = (a + b, n + m)
    return [sums[index][0] / max(sums[index][1], 1) for index in range(len(tree.nodes))]


def _reasons(
    ensemble: Ensemble, scene: Scenes, means: list[list[NDArray[np.float64]]], output: int, most: int
) -> tuple[Reason, ...]:
    found: dict[tuple[str, bool], tuple[float, dict[str, object]]] = {}
    for number, (tree, weight) in enumerate(zip(ensemble.trees, ensemble.weights, strict=True)):
        node = 0
        for condition, is_true, bound in ensemble.path(number, scene):
            split = cast("Split", tree.nodes[node])
            child = split.yes if is_true else split.no
            moved = float(weight) * float(means[number][child][output] - means[number][node][output])
            key = (sentence(condition, ensemble.schema), is_true)
            before, _ = found.get(key, (0.0, {}))
            found[key] = (before + moved, _witnesses(condition, bound, scene, is_true=is_true))
            node = child
    strongest = sorted(found.items(), key=lambda each: (-abs(each[1][0]), each[0]))[:most]
    return tuple(Reason(said, is_true, witnesses, moved) for (said, is_true), (moved, witnesses) in strongest)


def _witnesses(
    condition: Condition, bound: NDArray[np.int64], scene: Scenes, *, is_true: bool
) -> dict[str, object]:
    parameters = scene.schema.parameters
    free = "CD"[: condition.n_free] if is_true else ""
    return {
        name: None if row < 0 else plain(scene.object_ids[row])
        for name, row in zip((*parameters, *free), bound.tolist(), strict=False)
    }
