"""What learns values of vectors, and what it learns."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar, NamedTuple, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from relforest.rl.fitted.evidence import Evidence
from relforest.scenes.arrays import FloatArray, IntArray
from relforest.smdp import Decisions


class VectorMap(Protocol):
    """Turns the actions of decisions into vectors, see `relforest.worlds.keepaway.decisions.vectors`."""

    @property
    def width(self) -> int:
        """Length of a vector."""
        ...

    def vectors(self, decisions: Decisions) -> FloatArray:
        """Return the vectors of the actions of all decisions, (c, width)."""
        ...


class Rows(NamedTuple):
    """The actions of states as vectors of w numbers."""

    vectors: FloatArray  # (c, w)
    base: IntArray  # (c,): the row of the first action that the same state offers

    @classmethod
    def of(cls, decisions: Decisions, vector_map: VectorMap) -> Rows:
        """Return the actions of decisions."""
        return cls(vector_map.vectors(decisions), decisions.candidates[decisions.owners])


class Model(Protocol):
    """A value function that was learned."""

    fields: ClassVar[tuple[str, ...]]
    """The names of its arrays."""

    def values(self, rows: Rows) -> FloatArray:
        """Return the values of actions, (c,)."""
        ...

    def arrays(self) -> Mapping[str, NDArray[Any]]:
        """Return everything it consists of, for a file."""
        ...

    @classmethod
    def of(cls, arrays: Mapping[str, NDArray[Any]], width: int, *, origin: str) -> Model:
        """Return the model of arrays; `ModelFormatError` if they are not such a model of vectors (width,)."""
        ...


Known = TypeVar("Known", bound=Model)


class Approximator(Protocol[Known]):
    """Learns a model from all experience."""

    model: ClassVar[type[Model]]
    """What it learns."""

    def improved(
        self, before: Known | None, evidence: Evidence, rows: Rows, rng: np.random.Generator
    ) -> Known:
        """Return what is learned from experience and from an earlier model; `rows` are its candidates."""
        ...

    def to_dict(self) -> dict[str, Any]:
        """Return its options as plain JSON values."""
        ...
