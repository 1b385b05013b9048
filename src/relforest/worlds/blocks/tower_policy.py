"""The two hand-made policies of the high towers task."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, Literal, final

import numpy as np

from relforest.smdp import Decision
from relforest.support.options import one_of
from relforest.worlds.blocks.actions import position_of
from relforest.worlds.blocks.scene import bounds, extents
from relforest.worlds.blocks.stacks import connected
from relforest.worlds.blocks.tasks import HIGH_TOWERS_ACTIONS, PUT

_PUT: Final = HIGH_TOWERS_ACTIONS.index(PUT)


@final
@dataclass(frozen=True, slots=True)
class TowerPolicy:
    """Build a single stack, of the largest blocks first, or of the smallest first; never rotate.

    Raises
    ------
    InputError
        If ``first`` is neither.

    Notes
    -----
    Interpretations where the source is not specific: the stack is the block with the highest top and all
    blocks connected to it by horizontal overlap; blocks go onto the block with the highest top; size is area.
    The policy has finished when all blocks are in the stack; if it must act then, it puts the topmost block
    onto the next lower one again.

    References
    ----------
    Palmer (2015), section 7.4.1.
    """

    first: Literal["large", "small"]  # which block comes next

    def __post_init__(self) -> None:
        one_of("first", self.first, ("large", "small"))

    def choose(self, decision: Decision, rng: np.random.Generator) -> int:  # noqa: ARG002 - the protocol's
        """Return the position of the next put in `decision`; `rng` is not consumed."""
        decision.check_offers()
        if decision.n_objects < 2:
            return 0
        box, area = bounds(decision.objects), extents(decision.objects).prod(axis=1)
        by_height = np.argsort(-box[:, 3], kind="stable")
        goal, below = int(by_height[0]), int(by_height[1])
        stack = connected(box)
        outside = np.flatnonzero(stack != stack[goal])
        if not len(outside):
            return position_of(decision, _PUT, goal, below)
        best = np.argmax(area[outside]) if self.first == "large" else np.argmin(area[outside])
        return position_of(decision, _PUT, int(outside[best]), goal)

    def is_finished(self, decision: Decision) -> bool:
        """Return whether all blocks are in one stack."""
        return len(np.unique(connected(bounds(decision.objects)))) < 2
