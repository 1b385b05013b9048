"""What the questions of a tree ask, and how much they gain, for trees of conditions and SMRF trees."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, NamedTuple, cast

import numpy as np

from relforest.forests.scene_tree import SceneTree, Split, Value
from relforest.forests.words import sentence
from relforest.scenes.ids import plain
from relforest.trees import Question, Tree, query
from relforest.trees.nodes import ANSWERS, AnyLeaf, children, variable_name
from relforest.trees.text import introduced
from relforest.trees.text import sentence as question_sentence

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from relforest.forests.ensemble import Ensemble
    from relforest.scenes import Scenes, Schema

_ANSWERED: Final = {
    "yes": "{}",
    "no": "it is not so that {}",
    "error": "it cannot be said whether {}",
}


class Asked(NamedTuple):
    """A question of a tree.

    `node` is its index, `gain` by how much it lowered half of the squared error (for boosting, the loss),
    `yes` and `no` (n_outputs,) are the mean numbers of the leaves on either side, by training scenes.
    """

    node: int
    gain: float
    yes: NDArray[np.float64]
    no: NDArray[np.float64]


class Answered(NamedTuple):
    """A question that a scene met: its node and the next one, whether it holds, and of which objects."""

    node: int
    child: int
    sentence: str
    holds: bool
    witnesses: dict[str, object]


def questions(tree: SceneTree | Tree) -> list[Asked]:
    """Return all questions of a tree, in the order of the nodes."""
    if isinstance(tree, SceneTree):
        means = node_means(tree)
        return [
            Asked(index, node.gain, means[node.yes], means[node.no])
            for index, node in enumerate(tree.nodes)
            if isinstance(node, Split)
        ]
    means, totals = node_means(tree), _totals(tree)
    found = []
    for index, node in enumerate(tree.nodes):
        if isinstance(node, Question):
            within = sum(float(totals[child][0] @ means[child]) for child in children(node))
            gain = 0.5 * (within - float(totals[index][0] @ means[index]))
            found.append(Asked(index, max(gain, 0.0), means[node.yes], means[node.no]))
    return found


def node_means(tree: SceneTree | Tree) -> list[NDArray[np.float64]]:
    """Return the mean numbers (n_outputs,) of the leaves below each node, by training scenes."""
    means = [total / max(n, 1) for total, n in _totals(tree)]
    for leaf, value in zip(tree.leaves, tree.values, strict=True):
        means[leaf] = value
    return means


def question_in_words(tree: SceneTree | Tree, node: int, schema: Schema) -> str:
    """Return a question as a sentence; of a SMRF tree, after the answers that lead to it."""
    if isinstance(tree, SceneTree):
        return sentence(_split(tree, node).condition, schema)
    # In depth-first order, the first leaf after a node is below it.
    leaf = next(number for number, at in enumerate(tree.leaves) if at > node)
    above = [said for index, said in _branch(tree, leaf) if index < node]
    asked = question_sentence(_question(tree, node), introduced(tree.schema, tree.nodes)[node])
    return f"if {' and '.join(above)}: {asked}" if above else asked


def leaf_in_words(tree: SceneTree | Tree, leaf: int, schema: Schema) -> str:
    """Return the answers that lead to a leaf, given by its ordinal."""
    if isinstance(tree, Tree):
        above = [said for _, said in _branch(tree, leaf)]
    else:
        above, node = [], tree.leaves[leaf]
        parents = {
            child: (index, answer)
            for index, split in enumerate(tree.nodes)
            if isinstance(split, Split)
            for answer, child in zip(ANSWERS, (split.yes, split.no), strict=False)
        }
        while node:
            node, answer = parents[node]
            above.insert(0, _ANSWERED[answer].format(sentence(_split(tree, node).condition, schema)))
    return " and ".join(above) or "always"


def _branch(tree: Tree, leaf: int) -> list[tuple[int, str]]:
    """Return the questions above a leaf of a SMRF tree and what their answers say, root first."""
    new, found = introduced(tree.schema, tree.nodes), []
    for index in tree.questions_above[leaf]:
        answer = _answer(tree, index, tree.leaves[leaf])
        fresh = new[index] if answer == "yes" else ()
        found.append((index, _ANSWERED[answer].format(question_sentence(_question(tree, index), fresh))))
    return found


def compared(tree: SceneTree | Tree, node: int, schema: Schema, *, first: bool = False) -> str:
    """Return what a question, or only the first of its statements, compares, without its numbers."""
    if isinstance(tree, SceneTree):
        names = [*schema.parameters, "C", "D"]
        asked_for = _split(tree, node).condition.statements[: 1 if first else None]
        parts = {(each.mapping.name, each.variables) for each in asked_for}
    else:
        asked = _question(tree, node)
        names = [*schema.parameters, *map(variable_name, range(schema.n_parameters, tree.n_variables))]
        parts = {(asked.mapping.name, asked.variables)}
    said = {f"{name} of {', '.join(names[variable] for variable in used)}" for name, used in parts}
    return "; ".join(sorted(said))


def answers(ensemble: Ensemble, number: int, scene: Scenes) -> list[Answered]:
    """Return the questions that a single scene meets in one of the trees, root first."""
    tree = ensemble.trees[number]
    if isinstance(tree, Tree):
        return _answers_of_smrf(tree, scene)
    met, node = [], 0
    for condition, is_true, rows in ensemble.path(number, scene):
        split = _split(tree, node)
        child = split.yes if is_true else split.no
        names = [
            *scene.schema.parameters,
            *("CD" if is_true and not condition.every else "")[: condition.n_free],
        ]
        said = sentence(condition, ensemble.schema)
        met.append(Answered(node, child, said, is_true, _witnesses(names, rows, scene)))
        node = child
    return met


def _answers_of_smrf(tree: Tree, scene: Scenes) -> list[Answered]:
    met = []
    found, new = query(tree, scene), introduced(tree.schema, tree.nodes)
    leaf = int(found.leaf[0])
    for index in tree.questions_above[leaf]:
        asked, answer = _question(tree, index), _answer(tree, index, tree.leaves[leaf])
        said = question_sentence(asked, new[index] if answer == "yes" else ())
        names = [variable_name(variable) for variable in range(tree.n_bound[index])]
        child = children(asked)[ANSWERS.index(answer)]
        witnesses = _witnesses(names, found.witnesses[0], scene)
        met.append(Answered(index, child, said, answer == "yes", witnesses))
    return met


def _witnesses(names: list[str], rows: NDArray[np.int64], scene: Scenes) -> dict[str, object]:
    return {
        name: None if row < 0 else plain(scene.object_ids[row])
        for name, row in zip(names, rows.tolist(), strict=False)
    }


def _totals(tree: SceneTree | Tree) -> list[tuple[NDArray[np.float64], int]]:
    """Return the sum of the leaves' numbers over the training scenes below each node, and their count."""
    totals: list[tuple[NDArray[np.float64], int]] = [(np.empty(0), 0)] * len(tree.nodes)
    values = iter(tree.values[::-1])
    for index in range(len(tree.nodes) - 1, -1, -1):
        node = tree.nodes[index]
        if isinstance(node, (Value, AnyLeaf)):
            totals[index] = (next(values) * node.n_scenes, node.n_scenes)
            continue
        below = [totals[i] for i in ((node.yes, node.no) if isinstance(node, Split) else children(node))]
        totals[index] = (np.sum([total for total, _ in below], axis=0), sum(n for _, n in below))
    return totals


def _answer(tree: Tree, question: int, leaf: int) -> str:
    """Return the answer to a question by which a leaf, given by its node, is reached."""
    node = _question(tree, question)
    return ANSWERS[(leaf >= node.no) + (leaf >= node.error)]


def _question(tree: Tree, index: int) -> Question:
    return cast("Question", tree.nodes[index])


def _split(tree: SceneTree, index: int) -> Split:
    return cast("Split", tree.nodes[index])
