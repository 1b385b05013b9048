"""A relation as a function of two objects: whether the first stands in it to the second."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, final

import numpy as np

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
    """Whether two objects are related, with the properties of a `Mapping` to a category: 1 = yes, 0 = no.

    Parameters
    ----------
    relation : Relation
    """

    relation: Relation

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
    def arity(self) -> int:
        """Number of objects that it takes."""
        return 2

    @property
    def dim(self) -> int:
        """Dimension of the codomain."""
        return 1

    @property
    def space(self) -> Space:
        """The codomain: two values without order."""
        return "category"

    def evaluate(self, scenes: Scenes, rows: NDArray[np.int64]) -> NDArray[np.float64]:
        """Return 1 or 0 for each two object rows (n, 2), NaN where one is "no object" (-1), (n, 1)."""
        out = np.empty(len(rows))
        are_related(scenes.pairs, scenes.schema.relations.index(self.relation), rows, out)
        return out[:, None]
