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
    """Ends a branch with the probability of the target concept.

    Parameters
    ----------
    probability : float
        Probability that a scene whose best instantiation sequence arrives here is positive.
    negatives, positives : int
        Training scenes that this leaf won, by label.
    """

    probability: float
    negatives: int
    positives: int


@final
@dataclass(frozen=True, slots=True)
class Instantiation:
    """Binds one more object of the scene to the branch's next variable (A, B, C, ...).

    Parameters
    ----------
    child : int
        Index of the next node.
    """

    child: int


@final
@dataclass(frozen=True, slots=True)
class Question:
    """Asks whether a mapping of bound objects lies in a decision volume.

    Parameters
    ----------
    mapping : Mapping
        The mapping function.
    variables : tuple of int
        Which bound objects it takes: 0 is A, 1 is B, ...
    volume : Volume
        The decision volume in the mapping's codomain.
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
    """Indices of a node's children, in branch order."""
    match node:
        case Leaf():
            return ()
        case Instantiation(child):
            return (child,)
        case Question():
            return (node.yes, node.no, node.error)


def shifted(node: Node, after: int, by: int) -> Node:
    """`node` with every child index beyond `after` raised by `by`."""

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
    """Letter of a variable: A, B, ..., Z, then V26, V27, ..."""
    return chr(ord("A") + variable) if variable < 26 else f"V{variable}"
