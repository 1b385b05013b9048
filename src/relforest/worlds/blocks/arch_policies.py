"""The two hand-made policies of the arch task: one that is careful, one that errs on purpose.

Both follow `relforest.worlds.blocks.plan`; its moves are only available with ``sampler="expert"``.

References
----------
Palmer (2015), section 7.4.3.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final, Protocol, final

import numpy as np

from relforest.smdp import Decision
from relforest.support.errors import InputError
from relforest.worlds.blocks.actions import position_of
from relforest.worlds.blocks.arch import find_arch
from relforest.worlds.blocks.plan import ArchPlan, arch_plan
from relforest.worlds.blocks.scene import locations
from relforest.worlds.blocks.state import BlocksState
from relforest.worlds.blocks.tasks import ARCH_ACTIONS, DONE, MOVE, ROTATE

ERROR: Final = 0.5
"""Probability that the trainer leaves a support lying, and that it continues although an arch is finished."""

EXPLORATION: Final = 0.1
"""Probability that the trainer acts at random."""

_ROTATE, _MOVE, _DONE = (ARCH_ACTIONS.index(action) for action in (ROTATE, MOVE, DONE))


class ArchWorld(Protocol):
    """The part of the world that these policies use, because contacts are not in the scene."""

    @property
    def state(self) -> BlocksState:
        """The blocks at present."""
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

    It also chooses done if fewer than three blocks are left. The world must have ``sampler="expert"``.
    """

    world: ArchWorld

    def choose(self, decision: Decision, rng: np.random.Generator) -> int:  # noqa: ARG002 - the protocol's
        """Return the position of the next step in `decision`; `rng` is not consumed.

        Raises
        ------
        InputError
            If the move is not available.
        """
        decision.check_offers()
        state = self.world.state
        plan = arch_plan(state)
        if plan is None or find_arch(state) is not None:
            return position_of(decision, _DONE)
        if plan.lying:
            return position_of(decision, _ROTATE, plan.lying[0])
        return _planned_move(decision, plan)

    def is_finished(self, decision: Decision) -> bool:  # noqa: ARG002 - the protocol's
        """Return False: it chooses done instead."""
        return False


@final
@dataclass(frozen=True, slots=True)
class TrainerPolicy:
    """The same plan, with purposeful errors: the experience that the arch is learned from.

    With probability 0.1 it acts at random, among the rotations, done, and the moves of the training sampler.
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

        Raises
        ------
        InputError
            If the move is not available.
        """
        decision.check_offers()
        state = self.world.state
        plan = arch_plan(state)
        if rng.random() < EXPLORATION:
            return self._explore(decision, plan, rng)
        if plan is None or (find_arch(state) is not None and rng.random() >= ERROR):
            return position_of(decision, _DONE)
        for support in plan.lying:
            if rng.random() >= ERROR:
                return position_of(decision, _ROTATE, support)
        return _planned_move(decision, plan)

    def is_finished(self, decision: Decision) -> bool:  # noqa: ARG002 - the protocol's
        """Return False: it chooses done instead."""
        return False

    def _explore(self, decision: Decision, plan: ArchPlan | None, rng: np.random.Generator) -> int:
        kept = np.arange(len(decision))
        if plan is not None:
            kept = np.delete(kept, _planned_move(decision, plan))
        sampled = replace(
            decision,
            types=decision.types[kept],
            arguments=decision.arguments[kept],
            indices=decision.indices[kept],
        )
        return int(kept[self.exploration.choose(sampled, rng)])


def _planned_move(decision: Decision, plan: ArchPlan) -> int:
    """Return the position of the plan's move: the last that goes there, after those of other samplers."""
    moves = np.flatnonzero((decision.types == _MOVE) & (decision.arguments[:, 0] == plan.block))
    x = locations(decision.objects)[decision.arguments[moves, 1], 0]
    found = moves[x == plan.x]
    if not len(found):
        raise InputError(
            f"the planned move of block {plan.block} to {plan.x:g} is not available: make "
            'the environment with sampler="expert"'
        )
    return int(found[-1])
