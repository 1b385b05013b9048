"""A relation as a function of objects: whether one stands in it to another one, or to any other one."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, final

import numpy as np

from relforest.scenes.arrays import gather, occurrences
from relforest.scenes.pairs import are_related
from relforest.scenes.schema import Attribute, Relation

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from relforest.mappings.mapping import Space
    from relforest.scenes import Scenes

RELATED: Final = -1
"""Stands for the operation in kernels; the others are computed from attributes and have codes from 0 on."""


@final
@dataclass(frozen=True, slots=True)
class Related:
    """Whether objects are related, with the properties of a `Mapping` to a category: 1 = yes, 0 = no.

    Parameters
    ----------
    relation : Relation
    arity : int
        2 for whether one object is related to another, 1 for whether it is to any other object of its scene.
    """

    relation: Relation
    arity: int = 2

    @property
    def name(self) -> str:
        """The name of the relation."""
        return self.relation.name

    @property
    def operation(self) -> str:
        """The word that tells it from operations on attributes."""
        return "related"

    @property
    def attribute(self) -> Attribute:
        """What it says about a pair of objects, as an attribute of the pair."""
        return Attribute(self.relation.name, kind="category", categories=("no", "yes"))

    @property
    def dim(self) -> int:
        """Dimension of the codomain."""
        return 1

    @property
    def space(self) -> Space:
        """The codomain: two values without order."""
        return "category"

    def evaluate(
        self, scenes: Scenes, rows: NDArray[np.int64], scene: NDArray[np.int64]
    ) -> NDArray[np.float64]:
        """Return 1 or 0 for object rows (n, arity) of these scenes (n,), NaN for "no object" (-1), (n, 1)."""
        out, number = np.empty(len(rows)), scenes.schema.relations.index(self.relation)
        if self.arity == 2:
            are_related(scenes.pairs, number, rows, out)
            return out[:, None]
        first, _, pairs = occurrences(scenes.parts)
        first = first[scenes.pairs[pairs, 0] == number]
        objects = gather(scenes.rows, scenes.starts, scenes.counts)
        owner = np.repeat(np.arange(len(scenes)), scenes.counts)
        keys = owner[first] * len(scenes.matrix) + objects[first]
        found = np.isin(scene * len(scenes.matrix) + rows[:, 0], keys)
        return np.where(rows >= 0, found[:, None], np.nan)
