"""The three types of nodes of a SMRF tree (Palmer 2015, section 4.1, Figure 4.1)."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final, final

from relforest.support.numerals import number, probability

if TYPE_CHECKING:
    from relforest.mappings import Mapping
    from relforest.trees.bounds import Bounds
    from relforest.volumes import Volume


@dataclass(frozen=True, slots=True)
class AnyLeaf(ABC):
    """The end of a branch."""

    probability: float  # of all leaves that a scene reaches, the one where this is highest decides
    negatives: int
    positives: int
    """Training scenes decided by this leaf, by label."""

    @property
    def n_scenes(self) -> int:
        """Training scenes decided by this leaf."""
        return self.negatives + self.positives

    @property
    def prediction(self) -> float:
        """What the leaf predicts as a number: the probability, or the mean of real targets."""
        return self.probability

    @property
    @abstractmethod
    def says(self) -> str:
        """What the leaf predicts, such as ``probability 0.7``."""

    @property
    @abstractmethod
    def counts_in_words(self) -> str:
        """The training scenes that it decides."""

    @property
    def summary(self) -> str:
        """What the leaf predicts and the training counts, in words."""
        return f"{self.says.removeprefix('probability ')}  ({self.counts_in_words})"


@final
@dataclass(frozen=True, slots=True)
class Leaf(AnyLeaf):
    """The end of a branch of a tree for two classes.

    `probability` is the probability that a scene is positive if its best instantiation sequence arrives here.
    """

    @property
    def says(self) -> str:
        """The probability."""
        return f"probability {probability(self.probability)}"

    @property
    def counts_in_words(self) -> str:
        """The positive scenes of all."""
        return f"{self.positives} of {counted(self.n_scenes, 'scene')} positive"


@final
@dataclass(frozen=True, slots=True)
class MeanLeaf(AnyLeaf):
    """The end of a branch of a tree for real targets: `probability` is the mean, no scene is negative.

    Parameters
    ----------
    deviation : float
        Standard deviation of the training scenes decided by this leaf; of all of them if it decides none.
    lowest : bool
        Whether the leaf with the lowest mean decides: then `probability` is minus the mean.
    """

    deviation: float
    lowest: bool = False

    @property
    def prediction(self) -> float:
        """The mean."""
        return -self.probability if self.lowest else self.probability

    @property
    def says(self) -> str:
        """The mean."""
        return f"mean {number(self.prediction)}"

    @property
    def counts_in_words(self) -> str:
        """The deviation, and how many scenes."""
        spread = f"deviation {number(self.deviation)}, " if self.positives else ""
        return f"{spread}{counted(self.positives, 'scene')}"


@final
@dataclass(frozen=True, slots=True)
class ClassLeaf(AnyLeaf):
    """The end of a branch of a tree for several classes.

    `probability` is the largest share of any class but the most common one, less a little where a leaf that
    comes before it would have the same; scenes of the most common class count as negative.

    Parameters
    ----------
    shares : tuple of float
        Share of each class.
    counts : tuple of int
        Training scenes decided by this leaf, by class.
    """

    shares: tuple[float, ...]
    counts: tuple[int, ...]

    @property
    def says(self) -> str:
        """The share of each class."""
        return ", ".join(probability(share) for share in self.shares)

    @property
    def counts_in_words(self) -> str:
        """The scenes of each class."""
        return f"{', '.join(map(str, self.counts))} of {counted(sum(self.counts), 'scene')}"


def counted(count: int, noun: str, plural: str | None = None) -> str:
    """Return a number of things, such as ``2 leaves``."""
    return f"{count} {noun if count == 1 else plural or noun + 's'}"


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
    bounds : tuple of Bounds
        For sentences: bounds that divide the training points like the volume, if some of it divides none.
    """

    mapping: Mapping
    variables: tuple[int, ...]
    volume: Volume
    yes: int
    no: int
    error: int
    bounds: tuple[Bounds, ...] = ()


Node = Leaf | MeanLeaf | ClassLeaf | Instantiation | Question

ANSWERS: Final = ("yes", "no", "error")


def children(node: Node) -> tuple[int, ...]:
    """Return the indices of a node's children, in branch order."""
    match node:
        case AnyLeaf():
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
        case AnyLeaf():
            return node
        case Instantiation(child):
            return Instantiation(moved(child))
        case Question():
            return replace(node, yes=moved(node.yes), no=moved(node.no), error=moved(node.error))


def variable_name(variable: int) -> str:
    """Return the name of a variable: A, B, ..., Z, then V26, V27, ..."""
    return chr(ord("A") + variable) if variable < 26 else f"V{variable}"
