"""The hand-made policy of the color grouping task."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, final

import numpy as np
from numpy.typing import NDArray

from relforest.smdp import Decision
from relforest.worlds.blocks.actions import position_of
from relforest.worlds.blocks.scene import bounds, colors, locations
from relforest.worlds.blocks.scores import COLOR_DISTANCES, prototype
from relforest.worlds.blocks.stacks import connected, stacks
from relforest.worlds.blocks.tasks import COLOR_GROUPING_ACTIONS, ISOLATE, PUT

_PUT: Final = COLOR_GROUPING_ACTIONS.index(PUT)
_ISOLATE: Final = COLOR_GROUPING_ACTIONS.index(ISOLATE)
_RGB: Final = COLOR_DISTANCES["rgb"]


@final
@dataclass(frozen=True, slots=True)
class ColorPolicy:
    """Isolate what does not match its group, then put isolated blocks into the group they match best.

    It uses the groups as they are scored, but always compares colors in RGB, whichever distance the reward
    uses: a block matches a group if it is within 0.5 of the group's prototype.

    Notes
    -----
    Interpretations where the source is not specific: of several blocks that do not match, the worst is
    isolated first; of all isolated blocks and groups, the closest pair is joined first; an isolated block
    counts as a group of one; the block goes onto the highest block of the group. If the policy has finished
    but must act, it isolates an isolated block, which only takes time, or, if all blocks are in groups, puts
    the topmost block of a group onto the next lower one again.

    References
    ----------
    Palmer (2015), section 7.4.2.
    """

    def choose(self, decision: Decision, rng: np.random.Generator) -> int:  # noqa: ARG002 - the protocol's
        """Return the position of the next action in `decision`; `rng` is not consumed."""
        decision.check_offers()
        position = _improvement(decision)
        return _least_change(decision) if position is None else position

    def is_finished(self, decision: Decision) -> bool:
        """Return whether all blocks match their groups and isolated blocks do not match any other group."""
        return _improvement(decision) is None


def _improvement(decision: Decision) -> int | None:
    """Return the position of an action that improves the groups, or None."""
    box, rgb, groups = _groups(decision)
    centre = rgb[[_prototype(rgb, group) for group in groups]]
    own = np.empty(len(rgb), dtype=np.int64)
    for number, group in enumerate(groups):
        own[group] = number
    apart = _RGB.difference(rgb, centre[own])
    if apart.max() > _RGB.middle:
        return position_of(decision, _ISOLATE, int(np.argmax(apart)))
    singles = _singles(groups)
    distances = _RGB.difference(rgb[singles, np.newaxis], centre[np.newaxis])
    distances[np.arange(len(singles)), own[singles]] = np.inf
    if distances.min(initial=np.inf) > _RGB.middle:
        return None
    single, joined = np.unravel_index(np.argmin(distances), distances.shape)
    group = groups[joined]
    return position_of(decision, _PUT, int(singles[single]), int(group[np.argmax(box[group, 3])]))


def _prototype(rgb: NDArray[np.float64], group: NDArray[np.int64]) -> int:
    if len(group) == 1:
        return int(group[0])
    return int(group[prototype(rgb[group], _RGB.difference)])


def _least_change(decision: Decision) -> int:
    box, _, groups = _groups(decision)
    singles = _singles(groups)
    if len(singles):
        # A block that overlaps another is carried away, though it may count as isolated.
        overlaps = connected(box)
        crowd = [int((overlaps == overlaps[single]).sum()) for single in singles]
        return position_of(decision, _ISOLATE, int(singles[np.argmin(crowd)]))
    highest, below = groups[0][np.argsort(-box[groups[0], 3], kind="stable")][:2]
    return position_of(decision, _PUT, int(highest), int(below))


def _groups(
    decision: Decision,
) -> tuple[NDArray[np.float64], NDArray[np.float64], list[NDArray[np.int64]]]:
    """Return bounding boxes (n, 4), colors (n, 3), and the members of each stack."""
    box = bounds(decision.objects)
    labels = stacks(locations(decision.objects)[:, 0], box)
    return box, colors(decision.objects), [np.flatnonzero(labels == label) for label in np.unique(labels)]


def _singles(groups: list[NDArray[np.int64]]) -> NDArray[np.int64]:
    return np.array([group[0] for group in groups if len(group) == 1], dtype=np.int64)
