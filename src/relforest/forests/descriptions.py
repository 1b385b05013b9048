"""Ensembles in words: what matters most comes first."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, NamedTuple, cast

from scipy.special import expit

from relforest.forests.questions import question_in_words, questions
from relforest.forests.scene_tree import Value
from relforest.forests.words import sentence
from relforest.support.numerals import probability
from relforest.trees.nodes import variable_name

if TYPE_CHECKING:
    from relforest.forests.ensemble import Ensemble
    from relforest.forests.scene_tree import SceneTree
    from relforest.scenes import Schema
    from relforest.trees import Tree

MOST_QUESTIONS: Final = 10
"""Questions that are told unless otherwise asked."""


class Strong(NamedTuple):
    """A question of an ensemble: its share of the gain of all questions, and what a yes and a no add."""

    share: float
    yes: float
    no: float
    tree: SceneTree | Tree
    node: int
    schema: Schema

    @property
    def said(self) -> str:
        """The question in words."""
        return question_in_words(self.tree, self.node, self.schema)


def ensemble_in_words(ensemble: Ensemble, of: str, *, most: int = MOST_QUESTIONS) -> str:
    """Return the questions that lowered the training loss most, at most `most` of them.

    After a title that says what the last output is the score `of`, such as ``"completed = True"``, there is a
    line for each question: its share of the gain of all questions, what a yes and a no add to the score on
    average, and the condition.
    """
    found = strongest_questions(ensemble)
    lines = [
        f"{100 * each.share:4.1f} %  {each.yes:+.3f} / {each.no:+.3f}  {each.said}" for each in found[:most]
    ]
    n = len(ensemble.trees)
    title = f"Score of {of}: the sum of {n} {'tree' if n == 1 else 'trees'} with {len(found)} questions"
    told = f"The {len(lines)} that gain most: share of the gain, what a yes / a no adds, question"
    if ensemble.is_smrf and ensemble.schema.parameters:
        names = (f"{variable_name(i)} is the {name}" for i, name in enumerate(ensemble.schema.parameters))
        told += f"; {', '.join(names)}"
    return "\n".join([title, told, *lines] if lines else [title])


def strongest_questions(ensemble: Ensemble) -> list[Strong]:
    """Return the questions of all trees, those that lowered the training loss most first."""
    asked = [
        (
            each.gain * abs(float(weight)),
            float(weight * each.yes[-1]),
            float(weight * each.no[-1]),
            tree,
            each.node,
        )
        for tree, weight in zip(ensemble.trees, ensemble.weights, strict=True)
        for each in questions(tree)
    ]
    asked.sort(key=lambda each: -each[0])
    total = sum(gain for gain, *_ in asked) or 1.0
    return [Strong(gain / total, yes, no, tree, node, ensemble.schema) for gain, yes, no, tree, node in asked]


def rule_set_in_words(ensemble: Ensemble, of: str, *, most: int = MOST_QUESTIONS) -> str:
    """Return the most typical rule set, the first tree: a line for each rule, and one for all other scenes.

    Leaves contain log-odds; `of` is what the probabilities are of, and `most` the number of rules.
    """
    best = cast("SceneTree", ensemble.trees[0])
    *held, other = (node for node in best.nodes if isinstance(node, Value))
    lines = [
        f"    {_outcome(leaf)}  if {sentence(split.condition, ensemble.schema)}"
        for split, leaf in zip(best.splits[:most], held, strict=False)
    ]
    title = f"Probability of {of}, by the first rule that holds"
    told = (
        " (the most typical rules; others and boosted trees predict with them)"
        if len(ensemble.trees) > 1
        else ""
    )
    return "\n".join([title + told, *lines, f"    {_outcome(other)}  otherwise"])


def _outcome(leaf: Value) -> str:
    count = f"{leaf.n_scenes} {'scene' if leaf.n_scenes == 1 else 'scenes'}"
    return f"{probability(float(expit(leaf.numbers[0])))} ({count})"
