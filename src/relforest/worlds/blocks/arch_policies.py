"""The two hand-made policies of the arch task: one that is careful, one that errs on purpose.

Both follow `relforest.worlds.blocks.plan`, and ask the world to offer its moves when they take them.

References
----------
Palmer (2015), section 7.4.3.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, Protocol, final

import numpy as np

from relforest.smdp import Decision
from relforest.worlds.blocks.actions import position_of
from relforest.worlds.blocks.arch import find_arch
from relforest.worlds.blocks.plan import arch_plan
from relforest.worlds.blocks.state import BlocksState
from relforest.worlds.blocks.tasks import ARCH_ACTIONS, DONE, ROTATE

ERROR: Final = 0.5
"""Probability that the trainer leaves a support lying, and that it continues although an arch is finished."""

EXPLORATION: Final = 0.1
"""Probability that the trainer acts at random."""

_ROTATE, _DONE = (ARCH_ACTIONS.index(action) for action in (ROTATE, DONE))


class ArchWorld(Protocol):
    """The part of the world that these policies use; contacts are not in the scene."""

    @property
    def state(self) -> BlocksState:
        """The blocks at present."""
        ...

    def offer_move(self, block: int, x: float) -> int:
        """Return the position of a move, which the decision offers from now on."""
        ...


class Exploration(Protocol):
    """Chooses the random actions of the trainer."""

    def choose(self, decision: Decision, rng: np.random.Generator) -> int:
        """Return the position of an action in `decision`."""
        ...


@final
@dataclass(frozen=True, slots=True)
class CarefulPolicy:
    """Rotate supports upright, space them, put the top on them, and choose done when the arch is finished.

    It also chooses done if fewer than three blocks are left.
    """

    world: ArchWorld

    def choose(self, decision: Decision, rng: np.random.Generator) -> int:  # noqa: ARG002 - the protocol's
        """Return the position of the next step in `decision`; `rng` is not consumed.

        The world's decision may have changed then, see `relforest.smdp.RefiningWorld`.
        """
        decision.check_offers()
        state = self.world.state
        plan = arch_plan(state)
        if plan is None or find_arch(state) is not None:
            return position_of(decision, _DONE)
        if plan.lying:
            return position_of(decision, _ROTATE, plan.lying[0])
        return self.world.offer_move(plan.block, plan.x)

    def is_finished(self, decision: Decision) -> bool:  # noqa: ARG002 - the protocol's
        """Return False: it chooses done instead."""
        return False


@final
@dataclass(frozen=True, slots=True)
class TrainerPolicy:
    """The same plan, with purposeful errors: the experience that the arch is learned from.

    With probability 0.1 it acts at random, among the actions that the world offers by itself.
    Otherwise, it chooses done with probability 0.5 if the arch is finished, and skips the rotation of each
    lying support with probability 0.5.

    Notes
    -----
    Whether a rotation is skipped is drawn again at each decision; the source does not specify this.
    """

    world: ArchWorld
    exploration: Exploration

    def choose(self, decision: Decision, rng: np.random.Generator) -> int:
        """Return the position of the next step in `decision`; consumes one to four numbers from `rng`.

        The world's decision may have changed then, see `relforest.smdp.RefiningWorld`.
        """
        decision.check_offers()
        state = self.world.state
        plan = arch_plan(state)
        if rng.random() < EXPLORATION:
            return self.exploration.choose(decision, rng)
        if plan is None or (find_arch(state) is not None and rng.random() >= ERROR):
            return position_of(decision, _DONE)
        for support in plan.lying:
            if rng.random() >= ERROR:
                return position_of(decision, _ROTATE, support)
        return self.world.offer_move(plan.block, plan.x)

    def is_finished(self, decision: Decision) -> bool:  # noqa: ARG002 - the protocol's
        """Return False: it chooses done instead."""
        return False
