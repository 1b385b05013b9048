"""Where a decision volume lies, in plain words: what the whole volume has in common, or nothing."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from relforest.support.numerals import finite
from relforest.volumes import Arc, Slab

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from relforest.mappings import Mapping
    from relforest.trees.bounds import Bounds
    from relforest.volumes import Ellipsoid, Volume

AXIS_NAMES: Final = ("x", "y", "z")
SIDES: Final = ("on the left", "on the right")
# How far a volume may reach over a border, relative to its extent, and still count as on one side.
_OVERLAP: Final = 0.05
# How far the centre may be from a point, relative to the reach, for the volume to be "around" it.
_CENTRED: Final = 0.5
# A volume that reaches farther than this share of the way from A to B is around neither, nor between them.
_COMPACT: Final = 0.5


class _Extents(NamedTuple):
    """The box around a volume, without end where a bound does not matter, and the half widths of all."""

    low: NDArray[np.float64]
    high: NDArray[np.float64]
    half: NDArray[np.float64]

    def side(self, axis: int, border: float = 0.0) -> int:
        """Return 1 if all of the volume is beyond `border`, -1 if all of it is short of it, else 0."""
        overlap = 2 * _OVERLAP * self.half[axis]
        return int(self.low[axis] >= border - overlap) - int(self.high[axis] <= border + overlap)

    def around(self, *point: float) -> bool:
        """Return whether the volume surrounds `point`, its centre being near."""
        if np.isinf(self.low).any() or np.isinf(self.high).any():
            return False
        away = float(np.linalg.norm((self.low + self.high) / 2 - np.array(point)))
        return away <= _CENTRED * float(self.half.min())

    @property
    def is_compact(self) -> bool:
        """Whether the volume is much smaller than the way from A to B."""
        return bool((self.high - self.low).max() <= 2 * _COMPACT)


def place(mapping: Mapping, volume: Volume, names: list[str], bounds: tuple[Bounds, ...] = ()) -> str:
    """Say where the volume of a question about locations lies.

    Left and right are meant as on a map: the first coordinate grows to the right, the second upwards.

    The mapping takes the variables with these names. Bounds are those that matter, if not all of them do; of
    a slab, always.

    The text is such as ``"around the middle of the way from A to B"``; it is empty if there is nothing true
    to say.
    """
    if mapping.attribute.role != "location" or isinstance(volume, Arc) or volume.dim not in {2, 3}:
        return ""
    box = _box(volume, bounds)
    match mapping.operation:
        case "difference":
            return _beside(box, names[0])
        case "reframe":
            return _seen(box, names[0], names[1])
        case "scaled_reframe":
            return _on_the_way(box, names[0], names[1])
        case _:
            return ""


def _box(volume: Ellipsoid | Slab, bounds: tuple[Bounds, ...]) -> _Extents:
    covariance = (volume.interval if isinstance(volume, Slab) else volume).covariance
    half = np.array([finite(volume.radius * math.sqrt(each)) for each in np.diag(covariance).tolist()])
    half = np.broadcast_to(half, volume.dim)
    if not bounds:
        return _Extents(volume.mean - half, volume.mean + half, half)
    low, high = np.full(volume.dim, -np.inf), np.full(volume.dim, np.inf)
    for each in bounds:
        low[each.axis], high[each.axis] = each.low, each.high
    return _Extents(low, high, half)


def _beside(box: _Extents, start: str) -> str:
    sides = [(box.side(axis), name) for axis, name in enumerate(AXIS_NAMES[: len(box.half)])]
    compared = [f"{'larger' if side > 0 else 'smaller'} {name}" for side, name in sides if side]
    if compared:
        return f"at {' and '.join(compared)} than {start}"
    return f"around {start}" if box.around(*np.zeros(len(box.half))) else ""


def _seen(box: _Extents, start: str, end: str) -> str:
    if box.around(0.0, 0.0):
        return f"around {start}"
    ahead, side = box.side(0), _left_or_right(box)
    if ahead:
        where = f"{'in front of' if ahead > 0 else 'behind'} {start} {side}".strip()
        return f"{where}, looking from {start} to {end}"
    return f"{side} of {start}, looking from {start} to {end}" if side else ""


def _on_the_way(box: _Extents, start: str, end: str) -> str:
    for name, point in ((start, (0.0, 0.0)), (end, (1.0, 0.0))):
        if box.is_compact and box.around(*point):
            return f"around {name}"
    side = _left_or_right(box)
    way = f"the way from {start} to {end}"
    if box.side(0) > 0 and box.side(0, 1.0) < 0:
        if side:
            return f"{side} of {way}"
        if box.is_compact and box.around(0.5, 0.0):
            return f"around the middle of {way}"
        return f"between {start} and {end}" if box.is_compact else ""
    if box.side(0, 1.0) > 0:
        return f"{f'beyond {end} {side}'.strip()}, looking from {start}"
    return _seen(box, start, end)


def _left_or_right(box: _Extents) -> str:
    # The frame turns A to B onto the first axis without a reflection, so the second one points left.
    return {1: SIDES[0], -1: SIDES[1], 0: ""}[box.side(1)]
