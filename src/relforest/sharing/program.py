"""A model as rules about what exists, which any language with a search for objects can run.

The scenes of the most probable leaf of a SMRF tree are those where *some* objects get the answers on its
branch, those of the next leaf are those of all others where some objects get the answers on its own, and so
on (Palmer 2015, section 4.1). So a SMRF tree is a chain of rules, as a tree of conditions is a tree of them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, Literal, NamedTuple, cast, final

import numpy as np
from numpy.typing import NDArray

from relforest.forests import Condition
from relforest.forests.scene_tree import SceneTree, Split
from relforest.forests.statements import Statement, Test
from relforest.forests.words import sentence
from relforest.mappings import Mapping, Related
from relforest.models import Model
from relforest.models.model import Label
from relforest.scenes import Schema
from relforest.scenes.frames import FrameLayout
from relforest.scenes.mean_object import has_mean
from relforest.scenes.parquet import column_names
from relforest.support.errors import InputError
from relforest.trees import Question, Tree
from relforest.trees.nodes import ANSWERS, AnyLeaf, children
from relforest.trees.packing import RANK
from relforest.trees.text import introduced
from relforest.trees.text import sentence as question_sentence
from relforest.volumes import Volume

MOST_LITERALS: Final = 20_000
"""Largest number of answers that the rules of a program may ask for."""
DEEPEST: Final = 40
"""Largest number of conditions in a row that hold; compilers of other languages limit how code is nested."""

Link = Literal["number", "shares", "mean", "logistic"]


class Measure(NamedTuple):
    """A number about bound objects: the value of a mapping, and the volume or statement about it."""

    mapping: Mapping
    variables: tuple[int, ...]
    form: Volume | Test


Measures = dict[int, tuple[int, Measure]]
"""Number and measure of the questions and statements met so far, by identity."""


class Asked(NamedTuple):
    """An answer that a rule asks for: the number of the measure, ``"yes"``, ``"no"`` or ``"error"``."""

    measure: int
    answer: str
    said: str = ""


class Rule(NamedTuple):
    """There are objects, other than the arguments and each other, that get all these answers.

    `n_free` is how many there are. In a SMRF tree, `n_bound` variables are bound above the leaf (-1 in other
    trees), and a free object is "no object" if no other is left. `at_least` and `every` are those of
    `relforest.forests.Condition`.
    """

    n_free: int
    asked: tuple[Asked, ...]
    said: str = ""
    n_bound: int = -1
    at_least: int = 1
    every: bool = False

    @property
    def or_none(self) -> bool:
        """Whether a free object may be "no object"."""
        return self.n_bound >= 0


@final
@dataclass(frozen=True, slots=True)
class Branch:
    """What follows if a rule holds, and if not; None if it always holds when it is asked."""

    rule: Rule
    yes: Step
    no: Step | None


Step = Branch | int
"""A branch, or the ordinal of a leaf."""


class Walk(NamedTuple):
    """A node of a SMRF tree, for those who look for all its leaves at once.

    A measure has three children, by answer, another object has one, and a leaf none; `measure` or `leaf` is
    -1 for other nodes. `rank` is that of the most probable leaf at or below the node, 0 = of the tree.
    """

    measure: int
    children: tuple[int, ...]
    leaf: int
    rank: int


@final
@dataclass(frozen=True, slots=True, eq=False)
class Program:
    """A model without anything that only this library can evaluate.

    Parameters
    ----------
    schema : Schema
    layout : FrameLayout
        The columns of a table with its scenes.
    measures : tuple of Measure
    trees : tuple of Step
        What each scene is asked first, in each tree.
    walks : tuple of tuple of Walk
        The nodes of each tree if it is a SMRF tree, otherwise none.
    values : tuple of (n_leaves, n_outputs) float64
        What the leaves of each tree say, already weighted.
    start : (n_outputs,) float64
        What is added to them.
    says : tuple of str
        Of a single SMRF tree, each leaf in words.
    link : {"number", "shares", "mean", "logistic"}
        What the sum is: a number, the probabilities of classes, the mean of such, or their logarithms. For
        two classes, there is one output, about the second one.
    classes : tuple of labels
        Empty for numbers.
    threshold : float
        The probability of the second of two classes from which on it is predicted.
    outcome : str
        What the numbers are of.
    """

    schema: Schema
    layout: FrameLayout
    measures: tuple[Measure, ...]
    trees: tuple[Step, ...]
    walks: tuple[tuple[Walk, ...], ...]
    values: tuple[NDArray[np.float64], ...]
    start: NDArray[np.float64]
    says: tuple[str, ...]
    link: Link
    classes: tuple[Label, ...]
    threshold: float
    outcome: str


def program_of(model: Model) -> Program:
    """Return a model as a program.

    Raises
    ------
    InputError
        If the model is too large, or asks about the mean object of a scene or about relations.
    """
    learned, schema = model.learned, model.learned.schema
    if has_mean(schema):
        raise InputError(
            "the model asks about the mean object of a scene, which tables do not have: "
            "fit it with mean_object=False to share it"
        )
    measures: Measures = {}
    trees: tuple[SceneTree | Tree, ...]
    if isinstance(learned, Tree):
        trees, weights, start = (learned,), np.ones(1), np.zeros(learned.values.shape[1])
        says = tuple(node.summary for node in learned.nodes if isinstance(node, AnyLeaf))
    else:
        trees, weights, start, says = learned.trees, learned.weights, learned.start, ()
    steps = [
        _chain(tree, measures) if isinstance(tree, Tree) else _scene_tree(tree, schema, measures)
        for tree in trees
    ]
    values = [weight * tree.values for tree, weight in zip(trees, weights, strict=True)]
    if len(model.classes or ()) == 2:
        # The leaves of a tree from a file may hold the shares of both classes.
        values, start = [each[:, -1:] for each in values], start[-1:]
    _check_size(steps)
    link: Link = "mean"
    if model.classes is None:
        link = "number"
    elif model.family in {"boosting", "rules", "outcome"}:
        link = "logistic"
    elif model.family == "tree":
        link = "shares"
    return Program(
        schema,
        model.columns or _own_layout(schema),
        tuple(measure for _, measure in measures.values()),
        tuple(steps),
        tuple(_walks(tree, measures) if isinstance(tree, Tree) else () for tree in trees),
        tuple(values),
        start,
        says,
        link,
        model.classes or (),
        model.threshold,
        model.outcome,
    )


def _chain(tree: Tree, measures: Measures) -> Step:
    """Return the leaves of a SMRF tree as rules, the most probable first, of equal ones the earlier one."""
    new, step = introduced(tree.schema, tree.nodes), None
    # From behind: the last leaf has all scenes that no other leaf has.
    for leaf in np.argsort(-tree.leaf_probabilities, kind="stable")[::-1].tolist():
        asked = []
        for index in tree.questions_above[leaf]:
            node = cast("Question", tree.nodes[index])
            # In depth-first order, the leaves below each answer are together.
            answer = ANSWERS[(tree.leaves[leaf] >= node.no) + (tree.leaves[leaf] >= node.error)]
            said = question_sentence(node, new[index] if answer == "yes" else ())
            asked.append(Asked(_question(node, measures), answer, said))
        n_bound = tree.n_bound[tree.leaves[leaf]]
        n_free = max(n_bound - tree.schema.n_parameters, 0)
        step = Branch(Rule(n_free, tuple(asked), n_bound=n_bound), leaf, step)
    return cast("Step", step)


def _question(node: Question, measures: Measures) -> int:
    return _number_of(Measure(node.mapping, node.variables, node.volume), measures, node)


def _walks(tree: Tree, measures: Measures) -> tuple[Walk, ...]:
    ranks = tree.packed.nodes[:, RANK].tolist()
    return tuple(
        Walk(
            _question(node, measures) if isinstance(node, Question) else -1,
            children(node),
            tree.leaves.index(index) if isinstance(node, AnyLeaf) else -1,
            ranks[index],
        )
        for index, node in enumerate(tree.nodes)
    )


def _scene_tree(tree: SceneTree, schema: Schema, measures: Measures) -> Step:
    rules = [
        _rule(node.condition, schema, measures) if isinstance(node, Split) else None for node in tree.nodes
    ]
    steps: dict[int, Step] = {index: ordinal for ordinal, index in enumerate(tree.leaves)}
    # Children come after their parents.
    for index in range(len(rules) - 1, -1, -1):
        node, rule = tree.nodes[index], rules[index]
        if isinstance(node, Split) and rule is not None:
            steps[index] = Branch(rule, steps[node.yes], steps[node.no])
    return steps[0]


def _rule(condition: Condition, schema: Schema, measures: Measures) -> Rule:
    asked = tuple(
        Asked(_number_of(_measure(statement), measures, statement), "yes")
        for statement in condition.statements
    )
    said = sentence(condition, schema)
    return Rule(condition.n_free, asked, said, at_least=condition.at_least, every=condition.every)


def _measure(statement: Statement) -> Measure:
    if isinstance(statement.mapping, Related):
        raise InputError(
            f"the model asks about the relation {statement.mapping.name!r}, which code without relforest "
            "cannot look up: predict with relforest, or fit a model without this relation to share it"
        )
    return Measure(statement.mapping, statement.variables, statement.test)


def _number_of(measure: Measure, measures: Measures, owner: object) -> int:
    """Return the number of what a question or statement measures, which several leaves ask for."""
    return measures.setdefault(id(owner), (len(measures), measure))[0]


def _check_size(steps: Sequence[Step]) -> None:
    n_asked, stack = 0, [(step, 0) for step in steps]
    while stack:
        step, depth = stack.pop()
        if isinstance(step, Branch):
            n_asked += len(step.rule.asked)
            stack.append((step.yes, depth + 1))
            stack += [] if step.no is None else [(step.no, depth)]
        if n_asked > MOST_LITERALS or depth > DEEPEST:
            raise InputError(
                f"the model is too large to be shared: it may ask for at most {MOST_LITERALS} answers, "
                f"or for {DEEPEST} conditions in a row that hold; fit fewer or smaller trees"
            )


def _own_layout(schema: Schema) -> FrameLayout:
    """Return the columns that `Scenes.to_parquet` writes."""
    scene, item, *names = column_names(schema)
    spans = [schema.columns(attribute.name) for attribute in schema.attributes]
    columns = tuple(
        (attribute, tuple(names[span])) for attribute, span in zip(schema.attributes, spans, strict=True)
    )
    names = names[schema.width :]
    arguments, related = tuple(names[: schema.n_parameters]), names[schema.n_parameters :]
    return FrameLayout(scene, item, columns, arguments, tuple(zip(schema.relations, related, strict=False)))
