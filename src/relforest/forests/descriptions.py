"""Ensembles in words: what matters most comes first."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from scipy.special import expit

from relforest.forests.explanations import node_means
from relforest.forests.scene_tree import Split, Value
from relforest.forests.words import sentence
from relforest.support.numerals import probability

if TYPE_CHECKING:
    from relforest.forests.ensemble import Ensemble

MOST_QUESTIONS: Final = 10
"""Questions that are told unless otherwise asked."""


def ensemble_in_words(ensemble: Ensemble, of: str, *, most: int = MOST_QUESTIONS) -> str:
    """Return the questions that lowered the training loss most.

    Parameters
    ----------
    ensemble : Ensemble
    of : str
        What the last output scores, such as ``"completed = True"``.
    most : int
        Number of questions.

    Returns
    -------
    str
        A title, and a line for each question: its share of the gain of all questions, what a yes and a no
        add to the score on average, and the condition.
    """
    found = []
    for tree, weight in zip(ensemble.trees, ensemble.weights, strict=True):
        means = node_means(tree)
        for node in tree.nodes:
            if isinstance(node, Split):
                yes, no = (float(weight) * float(means[child][-1]) for child in (node.yes, node.no))
                found.append((node.gain * abs(float(weight)), yes, no, node.condition))
    found.sort(key=lambda each: -each[0])
    total = sum(gain for gain, *_ in found) or 1.0
    lines = [
        f"{100 * gain / total:4.1f} %  {yes:+.3f} / {no:+.3f}  {sentence(condition, ensemble.schema)}"
        for gain, yes, no, condition in found[:most]
    ]
    n, asked = len(ensemble.trees), len(found)
    title = f"Score of {of}: the sum of {n} {'tree' if n == 1 else 'trees'} with {asked} questions"
    told = f"The {len(lines)} that gain most: share of the gain, what a yes / a no adds, question"
    return "\n".join([title, told, *lines] if lines else [title])


def rule_set_in_words(ensemble: Ensemble, of: str, *, most: int = MOST_QUESTIONS) -> str:
    """Return the best rule set, the first tree: a line for each rule, and one for all other scenes.

    Leaves contain log-odds.

    Parameters
    ----------
    ensemble : Ensemble
    of : str
        What the probabilities are of.
    most : int
        Number of rules.
    """
    best = ensemble.trees[0]
    *held, other = (node for node in best.nodes if isinstance(node, Value))
    lines = [
        f"    {_outcome(leaf)}  if {sentence(split.condition, ensemble.schema)}"
        for split, leaf in zip(best.splits[:most], held, strict=False)
    ]
    title = f"Probability of {of}, by the first rule that holds"
    told = " (the best rule set; others and boosted trees predict with it)" if len(ensemble.trees) > 1 else ""
    return "\n".join([title + told, *lines, f"    {_outcome(other)}  otherwise"])


def _outcome(leaf: Value) -> str:
    count = f"{leaf.n_scenes} {'scene' if leaf.n_scenes == 1 else 'scenes'}"
    return f"{probability(float(expit(leaf.numbers[0])))} ({count})"
