"""The exact extent of a decision volume in words."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

import numpy as np

from relforest.support.numerals import LONGEST_VECTOR, ends, finite, number, rounded, vector
from relforest.volumes import Arc, Ellipsoid

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from relforest.volumes import Volume

Interval = tuple[float, float]

# Half-axes that differ less than this, relatively, are equal.
_ROUND: Final = 0.01
# The centre of a volume is rounded to this share of its reach.
_CENTRE: Final = 0.05
# Beyond this, relative to the near end and in itself, an interval is a half-line.
_FAR: Final = (1e3, 1e6)
# An arc that leaves less than this (radians) of the circle's half is told by the gap.
_GAP: Final = 0.5
_MOST_AXES: Final = 3


def region(volume: Ellipsoid | Arc) -> str:
    """Say which points a volume holds.

    Examples
    --------
    >>> import numpy as np
    >>> from relforest.volumes import Ellipsoid
    >>> region(Ellipsoid(np.array([26.6]), np.eye(1), 0.03, 5, 0.1))
    'between 26.57 and 26.63'
    >>> region(Ellipsoid(np.array([1.5, -2.0]), np.diag([4.0, 1.0]), 1.0, 5, 0.1))
    'in the ellipse around (1.5, -2) that reaches 2 along (1, 0) and 1 across'
    """
    if isinstance(volume, Arc):
        return _arc(volume)
    return span(interval(volume)) if volume.dim == 1 else _ellipsoid(volume)


def interval(volume: Volume) -> Interval:
    """Return the two ends of a one-dimensional volume."""
    variance = float(volume.covariance[0, 0]) if isinstance(volume, Ellipsoid) else 1.0
    centre, half = float(np.ravel(volume.mean)[0]), finite(volume.radius * math.sqrt(variance))
    return finite(centre - half), finite(centre + half)


def span(between: Interval) -> str:
    """Say which numbers an interval holds; next to an end that is infinite, the other one is not rounded.

    Examples
    --------
    >>> span((26.57, 26.63)), span((3.0, 3e9)), span((26.6, 26.6)), span((3.0, math.inf))
    ('between 26.57 and 26.63', 'at least 3 (at most 3e+9)', 'exactly 26.6', 'at least 3')
    """
    low, high = between
    if math.isinf(high) or math.isinf(low):
        return f"at least {rounded(low, 0.0)}" if math.isinf(high) else f"at most {rounded(high, 0.0)}"
    if low == high:
        return f"exactly {rounded(low, 0.0)}"
    low_text, high_text = ends(low, high)
    ratio, far = _FAR
    if high >= far and high >= ratio * abs(low) and low_text != "0":
        return f"at least {low_text} (at most {high_text})"
    if low <= -far and -low >= ratio * abs(high) and high_text != "0":
        return f"at most {high_text} (at least {low_text})"
    return f"between {low_text} and {high_text}"


def _arc(volume: Arc) -> str:
    mean = math.remainder(volume.mean, 2 * math.pi)
    if volume.radius >= math.pi:
        return "at any angle"
    if volume.radius == 0.0:
        return f"exactly {rounded(mean, 0.0)} rad"
    gap = math.pi - volume.radius
    if gap < _GAP:
        opposite = math.remainder(mean + math.pi, 2 * math.pi)
        return f"at least {number(gap)} rad from {rounded(opposite, _CENTRE * gap)} rad"
    return f"within {number(volume.radius)} rad of {rounded(mean, _CENTRE * volume.radius)} rad"


def _ellipsoid(volume: Ellipsoid) -> str:
    eigenvalues, directions = np.linalg.eigh(volume.covariance)
    lengths = [finite(volume.radius * math.sqrt(max(value, 0.0))) for value in eigenvalues.tolist()]
    longest = lengths[-1]
    # Half-axes beyond the reach of floating point numbers have no length.
    shortest = lengths[0] or longest
    if longest == 0.0:
        return f"exactly at {vector(volume.mean, 0.0)}"
    centre = vector(volume.mean, _CENTRE * shortest)
    if longest <= (1.0 + _ROUND) * shortest:
        return f"within {number(longest)} of {centre}"
    if volume.dim > LONGEST_VECTOR:
        reach = f"{number(longest)} along its longest axis and {number(shortest)} along its shortest"
        return f"in the ellipsoid around {centre} that reaches {reach}"
    # The tip of the longest axis may be off by a share of the shortest.
    step = _CENTRE * shortest / longest
    reaches = [
        f"{number(length)} along {_direction(axis, step)}"
        for length, axis in zip(lengths[::-1], directions.T[::-1], strict=True)
    ]
    if volume.dim == 2:
        reaches[1] = f"{number(shortest)} across"
    elif volume.dim > _MOST_AXES:
        rest = f"at most {number(lengths[-_MOST_AXES - 1])} along the other axes"
        reaches = [*reaches[:_MOST_AXES], rest]
    shape = "ellipse" if volume.dim == 2 else "ellipsoid"
    return f"in the {shape} around {centre} that reaches {', '.join(reaches[:-1])} and {reaches[-1]}"


def _direction(axis: NDArray[np.float64], step: float) -> str:
    largest = float(np.abs(axis).max())
    # An axis has no sign: of the two, take the one whose first large component is positive.
    first = axis[np.abs(axis) >= 0.99 * largest][0]
    return vector(axis * np.sign(first), min(step, largest / 10))
