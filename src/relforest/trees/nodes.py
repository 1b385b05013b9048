"""The three kinds of nodes of a SMRF tree (Palmer 2015, section 4.1, Figure 4.1)."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final, final

if TYPE_CHECKING:
    from relforest.mappings import Mapping
    from relforest.volumes import Volume


@final
@dataclass(frozen=True, slots=True)
class Leaf:
    """The end of a branch, with the probability of the target concept.

    Parameters
    ----------
    probability : float
        Probability that a scene is positive if its best instantiation sequence arrives here.
    negatives, positives : int
        Training scenes decided by this leaf, by label.
    """

    probability: float
    negatives: int
    positives: int


@final
@dataclass(frozen=True, slots=True)
class Instantiation:
    """Binds another object of the scene to the next variable of the branch (A, B, C, ...).

    Parameters
    ----------
    child : int
        Index of the next node.
    """

    child: int


@final
@dataclass(frozen=True, slots=True)
class Question:
    """Asks whether a point computed from bound objects lies in a decision volume.

    Parameters
    ----------
    mapping : Mapping
        The mapping function.
    variables : tuple of int
        The bound objects that the mapping takes: 0 is A, 1 is B, ...
    volume : Volume
        The decision volume in the codomain of the mapping.
    yes, no, error : int
        Index of the next node if the point lies inside, outside, or is undefined.
    """

    mapping: Mapping
    variables: tuple[int, ...]
    volume: Volume
    yes: int
    no: int
    error: int


Node = Leaf | Instantiation | Question

ANSWERS: Final = ("yes", "no", "error")


def children(node: Node) -> tuple[int, ...]:
    """Return the indices of a node's children, in branch order."""
    match node:
        case Leaf():
            return ()
        case Instantiation(child):
            return (child,)
        case Question():
            return (node.yes, node.no, node.error)


def shifted(node: Node, after: int, by: int) -> Node:
    """Return `node` with every child index beyond `after` increased by `by`."""

    def moved(index: int) -> int:
        return index + by if index > after else index

    match node:
        case Leaf():
            return node
        case Instantiation(child):
            return Instantiation(moved(child))
        case Question():
            return replace(node, yes=moved(node.yes), no=moved(node.no), error=moved(node.error))


def variable_name(variable: int) -> str:
    """Return the name of a variable: A, B, ..., Z, then V26, V27, ..."""
    return chr(ord("A") + variable) if variable < 26 else f"V{variable}"
