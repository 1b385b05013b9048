"""What an agent sees at one moment: objects, actions, score, and their places in padded arrays."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, Final, final

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from relforest.scenes import Scenes
from relforest.smdp import Decision
from relforest.worlds.blocks.actions import flat_actions
from relforest.worlds.blocks.blocks import LARGEST_HALF
from relforest.worlds.blocks.samplers import Targets, n_reserved
from relforest.worlds.blocks.scene import FARTHEST, SCHEMA, describe_state, scene, virtual_objects
from relforest.worlds.blocks.state import BlocksState
from relforest.worlds.blocks.tasks import Task

_COLUMNS: Final = tuple((name, SCHEMA.columns(name)) for name in SCHEMA.names)
_NO_TARGETS: Final = Targets(np.empty(0, dtype=np.int64), np.empty(0))


@final
@dataclass(frozen=True, slots=True, eq=False)
class Moment:
    """A state of a task, as agents see it, with one slot per block of the episode, then one per target."""

    state: BlocksState
    score: float  # of the task
    present: NDArray[np.bool_]  # (n_slots,) which slots hold an object
    decision: Decision  # no action after the end
    action_mask: NDArray[np.int8]  # (n_actions,) 1 for each of its actions
    scene: Scenes  # the blocks
    targets: Targets  # of moves: those sampled, then those that were asked for

    def observation(self) -> dict[str, NDArray[Any]]:
        """Return new padded arrays, 0 in empty slots and where an attribute is undefined."""
        objects = self.decision.objects
        padded = np.zeros((len(self.present), SCHEMA.width))
        # All attributes of blocks are defined.
        padded[self.present] = np.nan_to_num(objects) if self.decision.n_private else objects
        arrays: dict[str, NDArray[Any]] = {name: padded[:, columns].copy() for name, columns in _COLUMNS}
        arrays["mask"] = self.present.astype(np.int8)
        return arrays

    def info(self) -> dict[str, Any]:
        """Return the entries that the conventions of `relforest.smdp` require in a state."""
        return {"scene": self.scene, "action_mask": self.action_mask.copy()}


@final
class Observer:
    """Turns successive states of a task with this number of blocks into moments.

    It caches everything that stays the same until a block is lost.
    """

    def __init__(self, task: Task, n_blocks: int) -> None:
        self._task = task
        n_targets = 0 if task.sampler is None else task.sampler.size(n_blocks)
        self._n_reserved = 0 if task.sampler is None else n_reserved(n_blocks)
        self._actions = flat_actions(task.action_types, n_blocks, n_targets, self._n_reserved)
        self._n_slots = n_blocks + n_targets + self._n_reserved
        self._slots = np.empty(0, dtype=np.int64)
        self._ids = self._own = self._slots
        self._present = np.empty(0, dtype=np.bool_)
        self._scene: Scenes | None = None

    @property
    def n_actions(self) -> int:
        """Number of ground actions, available or not."""
        return len(self._actions)

    @property
    def n_slots(self) -> int:
        """Number of slots for objects."""
        return self._n_slots

    def begin(self, ids: NDArray[np.int64]) -> None:
        """Begin an episode with these blocks, given in ascending order: ``ids[i]`` has slot i."""
        self._slots, self._scene = ids, None

    def look(self, state: BlocksState, remaining: int, *, ended: bool = False) -> Moment:
        """Return what an agent sees with so many actions left before the limit, or after the end."""
        if self._scene is None or state.ids is not self._ids:
            self._scene, self._ids = scene(describe_state(state), state.ids.tolist()), state.ids
            self._own = np.searchsorted(self._slots, state.ids)
            self._present = np.isin(self._slots, state.ids)
        targets = _NO_TARGETS
        if self._task.sampler is not None:
            sampled = self._task.sampler.sample(state, self._own, len(self._slots))
            targets = sampled.with_reserved(self._n_reserved)
        shown = self._scene.with_matrix(describe_state(state))
        return self._seen(state, self._task.score(state), shown, targets, remaining, ended=ended)

    def with_moves(self, moment: Moment, moves: Iterable[tuple[int, float]], n_kept: int = 0) -> Moment:
        """Return a moment that also offers to move blocks, given by their positions in the state, to some x.

        Everything that it offered keeps its position and its number. Moves that are offered already are left
        out, and those for which no slot is free; `n_kept` slots stay free.
        """
        targets = moment.targets
        for block, x in moves:
            targets = targets.also(int(self._own[block]), x, n_kept)
        if targets is moment.targets or not len(moment.decision):
            return moment
        return self._seen(moment.state, moment.score, moment.scene, targets, moment.decision.remaining or 0)

    def move(self, moment: Moment, block: int, x: float) -> int | None:
        """Return the position of that move in the decision; None if it is not offered."""
        place = moment.targets.place(int(self._own[block]), x)
        found = np.flatnonzero(self._actions.targets[moment.decision.indices] == place)
        return int(found[0]) if len(found) else None

    def _seen(
        self,
        state: BlocksState,
        score: float,
        shown: Scenes,
        targets: Targets,
        remaining: int,
        *,
        ended: bool = False,
    ) -> Moment:
        is_there = ~np.isnan(targets.x)
        objects = np.concatenate([shown.matrix, virtual_objects(targets.x[is_there])])
        present = np.concatenate([self._present, is_there])
        offer = self._actions.nothing() if ended else self._actions.offer(present, targets.slots)
        decision = Decision(
            objects,
            offer.types,
            offer.arguments,
            offer.indices,
            n_private=len(objects) - len(state),
            remaining=remaining if len(offer.types) else 0,
        )
        return Moment(state, score, present, decision, offer.mask, shown, targets)


def observation_space(n_slots: int) -> spaces.Dict:
    """Return the space of padded observations."""
    return spaces.Dict(
        {
            "location": spaces.Box(-FARTHEST, FARTHEST, (n_slots, 2), np.float64),
            "extent": spaces.Box(0.0, LARGEST_HALF, (n_slots, 2), np.float64),
            "orientation": spaces.Box(-math.pi, math.pi, (n_slots, 1), np.float64),
            "color": spaces.Box(0.0, 1.0, (n_slots, 3), np.float64),
            "mask": spaces.MultiBinary(n_slots),
        }
    )
