"""What an agent is shown at one moment: objects, actions, score, and their places in padded arrays."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, final

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from relforest.smdp import Decision
from relforest.worlds.blocks.actions import FlatActions
from relforest.worlds.blocks.blocks import LARGEST_HALF
from relforest.worlds.blocks.samplers import Targets
from relforest.worlds.blocks.scene import FARTHEST, SCHEMA, describe_state, scene, virtual_objects
from relforest.worlds.blocks.state import BlocksState
from relforest.worlds.blocks.tasks import Task


@final
@dataclass(frozen=True, slots=True, eq=False)
class Moment:
    """A state of a task, as agents see it.

    Parameters
    ----------
    state : BlocksState
    score : float
        What the task scores.
    present : (n_slots,) bool
        Which slots hold an object: one slot per block of the episode, then one per target.
    targets : (n_targets,) float64
        Where each target is, world units, NaN = there is none.
    decision : Decision
        Objects and available actions; no action after the end.
    """

    state: BlocksState
    score: float
    present: NDArray[np.bool_]
    targets: NDArray[np.float64]
    decision: Decision

    def observation(self) -> dict[str, NDArray[Any]]:
        """Return new padded arrays, 0 in empty slots and where an attribute is undefined."""
        padded = np.zeros((len(self.present), SCHEMA.width))
        padded[self.present] = np.nan_to_num(self.decision.objects)
        arrays: dict[str, NDArray[Any]] = {
            name: padded[:, SCHEMA.columns(name)].copy() for name in SCHEMA.names
        }
        return arrays | {"mask": self.present.astype(np.int8)}

    def info(self, n_actions: int) -> dict[str, Any]:
        """Return what the conventions of `relforest.smdp` ask for at a state."""
        mask = np.zeros(n_actions, dtype=np.int8)
        mask[self.decision.indices] = 1
        return {"scene": scene(self.decision.objects, self.state.ids.tolist()), "action_mask": mask}


def moment(
    state: BlocksState, task: Task, actions: FlatActions, slots: NDArray[np.int64], *, ended: bool = False
) -> Moment:
    """Return what an agent is shown.

    Parameters
    ----------
    state : BlocksState
    task : Task
    actions : FlatActions
        Those of the task.
    slots : (n_blocks,) int64
        Ids of the blocks of the episode, ascending: block ``slots[i]`` has slot i.
    ended : bool
        Whether nothing follows.
    """
    own = np.searchsorted(slots, state.ids)
    targets = Targets(np.empty(0, np.int64), np.empty(0))
    if task.sampler is not None:
        targets = task.sampler.sample(state, own, len(slots))
    is_there = ~np.isnan(targets.x)
    objects = np.concatenate([describe_state(state), virtual_objects(targets.x[is_there])])
    present = np.concatenate([np.isin(slots, state.ids), is_there])
    decision = actions.nothing(objects) if ended else actions.decision(objects, present, targets.slots)
    return Moment(state, task.score(state), present, targets.x, decision)


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
