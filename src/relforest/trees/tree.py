"""A SMRF tree as an immutable value."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, Final, cast, final

import numpy as np

from relforest.scenes import Schema
from relforest.support.documents import well_formed
from relforest.support.errors import InputError
from relforest.support.files import check_document
from relforest.support.notebook import drawn
from relforest.trees.node_json import node_from_dict, node_to_dict
from relforest.trees.nodes import AnyLeaf, ClassLeaf, Instantiation, Leaf, Node, Question, counted, shifted
from relforest.trees.packing import PackedTree, pack
from relforest.trees.structure import check_counts, check_structure
from relforest.trees.text import describe

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

FORMAT: Final = "relforest-tree"
VERSION: Final = 2
"""The newest version; trees of two classes are still written as version 1, which older releases read."""


@final
@dataclass(frozen=True, slots=True, eq=False)
class Tree:
    """A probabilistic, existential decision tree over scenes.

    Parameters
    ----------
    schema : Schema
        Attributes and action arguments of the scenes. The first ``schema.n_parameters``
        variables of every branch are bound to the arguments.
    nodes : tuple of Node
        In depth-first order (Yes, No, Error); node 0 is the root, and a child comes after its parent.

    Raises
    ------
    InputError
        If the nodes do not form a tree in that order, the tree is too large, a question uses an unbound
        variable, or leaves are of several types.

    References
    ----------
    Palmer (2015), section 4.1.
    """

    schema: Schema
    nodes: tuple[Node, ...]
    leaves: tuple[int, ...] = field(init=False)
    """Node index of each leaf, in depth-first order. The position of a leaf in this tuple is its ordinal."""
    questions_above: tuple[tuple[int, ...], ...] = field(init=False)
    """For each leaf, the node indices of the questions above it, root first."""
    n_bound: tuple[int, ...] = field(init=False)
    """Number of variables bound at each node."""
    packed: PackedTree = field(init=False)
    """The tree as arrays, for kernels."""

    _repr_html_ = drawn

    def __post_init__(self) -> None:
        bound, above = check_structure(self.schema, self.nodes)
        leaves = tuple(i for i, node in enumerate(self.nodes) if isinstance(node, AnyLeaf))
        types = {_leaf_type(self.nodes[leaf]) for leaf in leaves}
        if len(types) > 1:
            raise InputError("the leaves of a tree must be of one type, and have the same number of classes")
        object.__setattr__(self, "leaves", leaves)
        object.__setattr__(self, "questions_above", tuple(above[leaf] for leaf in leaves))
        object.__setattr__(self, "n_bound", tuple(bound))
        object.__setattr__(self, "packed", pack(self.schema, self.nodes))

    @classmethod
    def stub(cls, schema: Schema, leaf: Leaf) -> Tree:
        """Return a tree of a single leaf."""
        return cls(schema, (leaf,))

    @property
    def n_variables(self) -> int:
        """Largest number of variables bound on a branch."""
        return max(self.n_bound)

    @property
    def n_leaves(self) -> int:
        """Number of leaves."""
        return len(self.leaves)

    @property
    def is_stub(self) -> bool:
        """Whether the tree is a single leaf, which makes no distinction."""
        return self.n_leaves == 1

    @property
    def depth(self) -> int:
        """Largest number of questions on a branch."""
        return max(len(above) for above in self.questions_above)

    @property
    def leaf_probabilities(self) -> NDArray[np.float64]:
        """Probability of each leaf, (n_leaves,): of those reached, the leaf with the largest one decides."""
        return np.array([node.probability for node in self.nodes if isinstance(node, AnyLeaf)])

    @property
    def leaf_predictions(self) -> NDArray[np.float64]:
        """What each leaf predicts: its probability, or for real targets the mean, (n_leaves,)."""
        return np.array([node.prediction for node in self.nodes if isinstance(node, AnyLeaf)])

    @property
    def values(self) -> NDArray[np.float64]:
        """What each leaf predicts, (n_leaves, 1), or the shares of several classes (n_leaves, n_classes)."""
        shares = [node.shares for node in self.nodes if isinstance(node, ClassLeaf)]
        return np.array(shares) if shares else self.leaf_predictions[:, None]

    def with_leaves(self, leaves: Sequence[AnyLeaf]) -> Tree:
        """Return the same tree with other leaves, given in leaf order."""
        nodes = list(self.nodes)
        for index, leaf in zip(self.leaves, leaves, strict=True):
            nodes[index] = cast("Node", leaf)
        return Tree(self.schema, tuple(nodes))

    def expanded(self, leaf: int, n_new: int, question: Question) -> Tree:
        """Return the tree with a leaf replaced by instantiations and a question with three leaves.

        Parameters
        ----------
        leaf : int
            Ordinal of the leaf.
        n_new : int
            Number of instantiation nodes before the question.
        question : Question
            Its child indices are ignored.
        """
        at = self.leaves[leaf]
        asked = at + n_new
        subtree = (
            *(Instantiation(at + i + 1) for i in range(n_new)),
            replace(question, yes=asked + 1, no=asked + 2, error=asked + 3),
            *(self.nodes[at],) * 3,
        )
        nodes = [shifted(node, at, len(subtree) - 1) for node in self.nodes]
        return Tree(self.schema, (*nodes[:at], *subtree, *nodes[at + 1 :]))

    def __str__(self) -> str:
        """Return the tree in words."""
        return describe(self.schema, self.nodes)

    def __repr__(self) -> str:
        """Return counts, attributes and arguments on one line."""
        questions = counted(sum(isinstance(node, Question) for node in self.nodes), "question")
        return f"Tree({questions}, {counted(len(self.leaves), 'leaf', 'leaves')}; {self.schema.in_words})"

    def to_dict(self) -> dict[str, Any]:
        """Return the JSON form, with format name and version."""
        return {
            "format": FORMAT,
            "version": 1 if type(self.nodes[self.leaves[0]]) is Leaf else VERSION,
            "schema": self.schema.to_dict(),
            "nodes": [node_to_dict(node) for node in self.nodes],
        }

    @classmethod
    def from_dict(cls, document: object) -> Tree:
        """Read what `to_dict` returned.

        Raises
        ------
        ModelFormatError
            If the document is malformed, too large, or of a version that this library cannot read.
        """
        checked = check_document(document, format=FORMAT, version=VERSION, origin="tree")
        with well_formed("malformed tree"):
            check_counts(checked)
            schema = Schema.from_dict(checked["schema"])
            attributes = {attribute.name: attribute for attribute in schema.attributes}
            return cls(schema, tuple(node_from_dict(node, attributes) for node in checked["nodes"]))


def _leaf_type(leaf: Node) -> tuple[type[Node], int]:
    return type(leaf), len(leaf.shares) if isinstance(leaf, ClassLeaf) else 0
