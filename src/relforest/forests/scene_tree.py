"""Trees of conditions: each scene goes one way at every condition, and ends in a leaf with numbers."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, final

import numpy as np

from relforest.forests.conditions import Condition
from relforest.support.documents import well_formed
from relforest.support.errors import ModelFormatError
from relforest.support.options import between, in_range

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from relforest.scenes import Schema


@final
@dataclass(frozen=True, slots=True)
class Value:
    """A leaf.

    Parameters
    ----------
    numbers : tuple of float
        What the tree says about a scene that arrives here, one number per output.
    n_scenes : int
        Training scenes that arrived here.
    """

    numbers: tuple[float, ...]
    n_scenes: int


@final
@dataclass(frozen=True, slots=True)
class Split:
    """A question.

    Parameters
    ----------
    condition : Condition
    yes, no : int
        Index of the next node if the condition holds, and if not.
    gain : float
        By how much it lowered the training loss.
    """

    condition: Condition
    yes: int
    no: int
    gain: float


Node = Value | Split


@final
@dataclass(frozen=True, slots=True, eq=False)
class SceneTree:
    """A decision tree whose questions are conditions.

    Unlike in a SMRF tree, the objects bound by a question are forgotten after it.

    Parameters
    ----------
    nodes : tuple of Value or Split
        Node 0 is the root; a child comes after its parent.

    Raises
    ------
    ModelFormatError
        If the nodes do not form a tree in that order.
    """

    nodes: tuple[Node, ...]
    leaves: tuple[int, ...] = field(init=False)
    """Node index of each leaf."""

    def __post_init__(self) -> None:
        children = [each for node in self.nodes if isinstance(node, Split) for each in (node.yes, node.no)]
        later = all(
            index < min(node.yes, node.no) for index, node in enumerate(self.nodes) if isinstance(node, Split)
        )
        if sorted(children) != list(range(1, len(self.nodes))) or not later or not self.nodes:
            raise ModelFormatError(
                "malformed tree: every node but the root must be the child of one earlier node"
            )
        leaves = tuple(index for index, node in enumerate(self.nodes) if isinstance(node, Value))
        object.__setattr__(self, "leaves", leaves)

    @property
    def splits(self) -> tuple[Split, ...]:
        """The questions, in the order of the nodes."""
        return tuple(node for node in self.nodes if isinstance(node, Split))

    @property
    def values(self) -> NDArray[np.float64]:
        """The numbers of the leaves, (n_leaves, n_outputs)."""
        return np.array([node.numbers for node in self.nodes if isinstance(node, Value)])

    def to_dict(self) -> list[dict[str, Any]]:
        """Return the JSON form."""
        return [
            {"value": list(node.numbers), "scenes": node.n_scenes}
            if isinstance(node, Value)
            else {"condition": node.condition.to_dict(), "yes": node.yes, "no": node.no, "gain": node.gain}
            for node in self.nodes
        ]

    @classmethod
    def from_dict(cls, document: Any, schema: Schema, n_outputs: int) -> SceneTree:  # noqa: ANN401
        """Read what `to_dict` returned.

        Raises
        ------
        ModelFormatError
            If it is not such a document, or a leaf has another number of outputs.
        """
        with well_formed("malformed tree"):
            if not isinstance(document, list):
                raise ModelFormatError("malformed tree: expected a list of nodes")
            nodes = tuple(_node(each, schema, n_outputs, len(document)) for each in document)
        return cls(nodes)


def _node(document: Any, schema: Schema, n_outputs: int, n_nodes: int) -> Node:  # noqa: ANN401
    if "condition" in document:
        yes, no = (between(key, document[key], 1, n_nodes - 1) for key in ("yes", "no"))
        gain = in_range("gain", document["gain"], 0.0, 1e100)
        return Split(Condition.from_dict(document["condition"], schema), yes, no, gain)
    numbers = tuple(in_range("value", each, -1e100, 1e100) for each in document["value"])
    if len(numbers) != n_outputs:
        raise ModelFormatError(f"a leaf has {len(numbers)} numbers instead of {n_outputs}")
    return Value(numbers, between("scenes", document["scenes"], 0, 10**15))
