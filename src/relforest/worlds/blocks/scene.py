"""What a learner sees of the blocks world: the blocks, and virtual objects where an action may go.

Neither the table nor the tool is an object. Velocities are left out. Virtual objects are private to the
action that goes there (`relforest.smdp.Decision`).

References
----------
Palmer (2015), sections 5.3.1, 6.5 and 7.4.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from relforest.scenes import Attribute, Scenes, Schema
from relforest.worlds.blocks.state import BlocksState, boxes, orientations, reaches

SCHEMA: Final = Schema(
    (Attribute("location", 2), Attribute("extent", 2), Attribute("orientation"), Attribute("color", 3))
)
"""Centre in world units (0, 0 = middle of the table top); half sizes, the longer first; twice the angle of
the longer side in radians (0 = lying, pi = upright), because a block looks the same after half a turn; RGB
from 0 to 1."""

FARTHEST: Final = 1000.0
"""Locations are clipped to this; only blocks that fall off the table come near it."""

_LOCATION, _EXTENT, _ORIENTATION, _COLOR = (SCHEMA.columns(name) for name in SCHEMA.names)


def describe(
    half_extents: NDArray[np.float64], poses: NDArray[np.float64], colors: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return blocks as objects of a scene, (n, 8) float64.

    Half extents (n, 2) are in the block's own frame, poses (n, 3) centre x and y and angle in radians, and
    colors (n, 3) red, green and blue from 0 to 1.
    """
    objects = np.empty((len(poses), SCHEMA.width))
    objects[:, _LOCATION] = np.minimum(np.maximum(poses[:, :2], -FARTHEST), FARTHEST)
    objects[:, _EXTENT] = np.sort(half_extents, axis=1)[:, ::-1]
    objects[:, _ORIENTATION] = orientations(half_extents, poses[:, 2])[:, np.newaxis]
    objects[:, _COLOR] = colors
    return objects


def describe_state(state: BlocksState) -> NDArray[np.float64]:
    """Return the blocks of a state as objects of a scene, (n, 8) float64."""
    return describe(state.half_extents, state.poses, state.colors)


def virtual_objects(targets: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return objects (k, 8) that represent horizontal places (k,) to move a block to.

    The source says that virtual objects have attributes that correspond to the parameters of an action, here
    x. They have the location (x, 0); everything else is undefined.

    References
    ----------
    Palmer (2015), section 6.5.
    """
    objects = np.full((len(targets), SCHEMA.width), np.nan)
    objects[:, _LOCATION] = 0.0
    objects[:, _LOCATION.start] = np.clip(targets, -FARTHEST, FARTHEST)
    return objects


def scene(objects: NDArray[np.float64], block_ids: Sequence[int]) -> Scenes:
    """Return the scene of a state: `Scenes` of length 1, without arguments and virtual objects.

    Objects are the blocks, (n, 8); they are called ``"block_ID"``.
    """
    n = len(objects)
    names = [f"block_{number}" for number in block_ids]
    return Scenes(
        SCHEMA,
        matrix=objects,
        rows=np.arange(n),
        starts=np.zeros(1, dtype=np.int64),
        counts=np.array([n]),
        object_ids=np.array(names, dtype=object),
    )


def locations(objects: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return where objects are: a view (n, 2) of (n, 8)."""
    return objects[:, _LOCATION]


def extents(objects: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the half sizes of objects, the longer first: a view (n, 2) of (n, 8)."""
    return objects[:, _EXTENT]


def colors(objects: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the colors of objects: a view (n, 3) of (n, 8)."""
    return objects[:, _COLOR]


def bounds(objects: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the bounding boxes of blocks given as objects (n, 8): (n, 4) min x, max x, min y, max y."""
    reach = reaches(objects[:, _EXTENT], objects[:, _ORIENTATION][:, 0] / 2.0)
    return boxes(objects[:, _LOCATION], reach)
