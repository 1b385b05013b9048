"""The closed set of operations that mapping functions are made of."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import permutations
from types import MappingProxyType
from typing import Final, Literal, final

Symmetry = Literal["none", "swap-first-two"]


@final
@dataclass(frozen=True, slots=True)
class Operation:
    """A computation on the attribute values of one, two or three objects.

    Parameters
    ----------
    name : str
        Name in schemas, model files and sentences.
    code : int
        Number that identifies the operation in kernels.
    arity : int
        Number of objects that it takes.
    symmetry : {"none", "swap-first-two"}
        "swap-first-two": exchanging the first two objects moves the points by an isometry of the
        codomain, so a volume learned for one order has a mirror image for the other, and only one
        of the two orders is worth trying.
    """

    name: str
    code: int
    arity: int
    symmetry: Symmetry

    def argument_orders(self, variables: tuple[int, ...]) -> tuple[tuple[int, ...], ...]:
        """Return the orders of `variables` (as many as the arity) that can lead to different volumes."""
        orders = permutations(sorted(variables))
        if self.symmetry == "none":
            return tuple(orders)
        return tuple(order for order in orders if order[0] < order[1])


IDENTITY: Final = 0
DISTANCE: Final = 1
DIFFERENCE: Final = 2
REFRAME: Final = 3
SCALED_REFRAME: Final = 4
SCALED_DISTANCE: Final = 5
BEARING: Final = 6
SAME: Final = 7

# Swapping the frame's two objects sends a scaled point z to 1 - z, which is an isometry, but an
# unscaled point w to |B - A| - w, which is not: only the scaled form may drop one of the orders.
OPERATIONS: Final = MappingProxyType(
    {
        operation.name: operation
        for operation in (
            Operation("identity", IDENTITY, 1, "none"),
            Operation("distance", DISTANCE, 2, "swap-first-two"),
            Operation("difference", DIFFERENCE, 2, "swap-first-two"),
            Operation("reframe", REFRAME, 3, "none"),
            Operation("scaled_reframe", SCALED_REFRAME, 3, "swap-first-two"),
            Operation("scaled_distance", SCALED_DISTANCE, 3, "none"),
            Operation("bearing", BEARING, 3, "none"),
            Operation("same", SAME, 2, "swap-first-two"),
        )
    }
)
