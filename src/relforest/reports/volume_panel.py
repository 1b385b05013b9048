"""A picture of the decision volume of a question, over the points that the question sees."""

from __future__ import annotations

import math
from typing import Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Ellipse, FancyArrowPatch, Wedge
from numpy.typing import NDArray

from relforest.mappings import Mapping
from relforest.reports.question_points import QuestionPoints
from relforest.reports.style import GREY, INK, NEGATIVE, PAPER, POSITIVE, mixed
from relforest.reports.text_size import shortened
from relforest.volumes import Arc, Ellipsoid, Slab, Volume
from relforest.volumes.ellipsoid import LARGEST_VALUE

MOST_POINTS: Final = 400
"""Largest number of points per class in a picture."""

_FILL: Final = mixed("#F0E442", 0.45)
_FILL_EDGE: Final = "#8A7F00"
_BINS: Final = 24
_LABEL_WIDTH: Final = 2.0
_LABEL: Final = 7.5
# In units of the visible range: the renderer fails on shapes that extend much farther.
_FAR: Final = 1e4
_GRID: Final = 300

Points = NDArray[np.float64]


def draw_volume(
    axes: Axes,
    mapping: Mapping,
    volume: Volume,
    points: QuestionPoints | None = None,
    witness: Points | None = None,
) -> None:
    """Draw a decision volume: an ellipse, an interval (of the only coordinate that counts), or an arc.

    Beyond two dimensions, draw the interval of Mahalanobis distances within the radius.

    The mapping labels the axes. Points are those that the question sees; positive and negative scenes differ
    in color. The witness (d,) is marked, unless it is undefined or too large to learn from.
    """
    # The negated test also catches NaN.
    if witness is not None and not (np.abs(witness) <= LARGEST_VALUE).all():
        witness = None
    if points is not None:
        tame = (np.abs(points.points) <= LARGEST_VALUE).all(axis=1)
        points = QuestionPoints(points.points[tame], points.positive[tame])
    name = mapping.name
    if isinstance(volume, Slab):
        name = _axis_name(mapping, volume.axis)
        if points is not None:
            points = QuestionPoints(volume.coordinate(points.points), points.positive)
        witness = None if witness is None else volume.coordinate(witness)[0]
        volume = volume.interval
    if isinstance(volume, Arc):
        _draw_arc(axes, volume, points, witness)
    elif volume.dim == 2:
        _draw_ellipse(axes, volume, points, witness)
        axes.set_xlabel(_axis_name(mapping, 0), labelpad=1.0, parse_math=False)
        axes.set_ylabel(_axis_name(mapping, 1), labelpad=1.0, parse_math=False)
    elif volume.dim == 1:
        half = float(np.linalg.norm(volume.axes[0]))
        mean = float(volume.mean[0])
        _draw_interval(axes, (mean - half, mean + half), points, witness)
        axes.axvline(mean, color=_FILL_EDGE, linewidth=1.0, linestyle="--", zorder=1)
        left, right = axes.get_xlim()
        if mapping.operation == "distance" and right > 0.0:
            axes.set_xlim(left=max(0.0, left))
        axes.set_xlabel(shortened(name, _LABEL_WIDTH, _LABEL), labelpad=1.0, parse_math=False)
    else:
        scaled = None
        if points is not None:
            scaled = QuestionPoints(_relative(volume, points.points), points.positive)
        at = None if witness is None else _relative(volume, witness[None])[0]
        _draw_interval(axes, (0.0, 1.0), scaled, at)
        axes.set_xlim(left=0.0)
        axes.set_xlabel("Mahalanobis distance / radius", labelpad=1.0)


def _relative(volume: Ellipsoid, points: Points) -> Points:
    """Return the distances (n, 1) of points from the mean, in radii."""
    radius = volume.radius or 1.0
    return volume.distance(points)[:, None] / radius


def _draw_ellipse(
    axes: Axes, volume: Ellipsoid, points: QuestionPoints | None, witness: Points | None
) -> None:
    long, short = volume.axes
    half = np.hypot(long, short)
    low, high = _window(volume.mean, half, None if points is None else points.points, witness)
    _show_undistorted(axes, low, high)
    low, high = np.transpose([axes.get_xlim(), axes.get_ylim()])
    if np.linalg.norm(long) > _FAR * (high - low).max():
        _fill_inside(axes, volume, low, high)
    else:
        _add_ellipse(axes, volume)
    if points is not None:
        _scatter(axes, _near(points, low, high).thinned(MOST_POINTS, volume))
    if witness is not None:
        _star(axes, float(witness[0]), float(witness[1]))


def _add_ellipse(axes: Axes, volume: Ellipsoid) -> None:
    long, _ = volume.axes
    size = 2 * np.linalg.norm(volume.axes, axis=1)
    centre = (float(volume.mean[0]), float(volume.mean[1]))
    angle = math.degrees(math.atan2(long[1], long[0]))
    shape = {"xy": centre, "width": size[0], "height": size[1], "angle": angle}
    axes.add_patch(Ellipse(**shape, facecolor=_FILL, edgecolor="none", zorder=0.5))
    axes.add_patch(Ellipse(**shape, facecolor="none", edgecolor=_FILL_EDGE, linewidth=1.4, zorder=3))
    for axis in volume.axes:
        end = (centre[0] + axis[0], centre[1] + axis[1])
        arrow = FancyArrowPatch(centre, end, arrowstyle="-|>", mutation_scale=8.0, shrinkA=0.0, shrinkB=0.0)
        arrow.set(color=INK, linewidth=1.0, zorder=4)
        axes.add_patch(arrow)


def _fill_inside(axes: Axes, volume: Ellipsoid, low: Points, high: Points) -> None:
    """Fill the inside of an ellipse that extends far beyond the picture."""
    x, y = np.linspace(low, high, _GRID).T
    inside = volume.contains(np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)).reshape(_GRID, _GRID)
    image = np.where(inside[:, :, None], _FILL, (1.0, 1.0, 1.0))
    extent = (low[0], high[0], low[1], high[1])
    axes.imshow(image, extent=extent, origin="lower", aspect="auto", zorder=0.5)


def _near(points: QuestionPoints, low: Points, high: Points) -> QuestionPoints:
    """Return the points that are not too far away for the renderer."""
    near = (np.abs(points.points - (low + high) / 2) <= _FAR * (high - low)).all(axis=1)
    return QuestionPoints(points.points[near], points.positive[near])


def _show_undistorted(axes: Axes, low: Points, high: Points) -> None:
    """Show at least the rectangle between two corners, with equal scales on both axes."""
    room = axes.get_window_extent()
    scale = max((high[0] - low[0]) / room.width, (high[1] - low[1]) / room.height)
    middle, reach = (low + high) / 2, np.array([room.width, room.height]) * scale / 2
    axes.set_xlim(middle[0] - reach[0], middle[0] + reach[0])
    axes.set_ylim(middle[1] - reach[1], middle[1] + reach[1])


def _window(
    mean: Points,
    half: Points,
    points: Points | None,
    witness: Points | None,
    *,
    surroundings: float = 3.0,
) -> tuple[Points, Points]:
    """Return the corners of the visible range: the volume, and its surroundings where there are points.

    `surroundings` limits the distance from the middle of the volume, in units of its half extents.
    """
    low, high = mean - 1.15 * half, mean + 1.15 * half
    if points is not None and len(points):
        outer = np.quantile(points, [0.01, 0.99], axis=0)
        margin = 0.05 * (outer[1] - outer[0])
        around = (
            np.maximum(outer[0] - margin, mean - surroundings * half),
            np.minimum(outer[1] + margin, mean + surroundings * half),
        )
        # A volume may be so large that it acts as an inequality; its far end is then irrelevant.
        huge = half > 5.0 * (outer[1] - outer[0])
        low = np.where(huge, around[0], np.minimum(low, around[0]))
        high = np.where(huge, around[1], np.maximum(high, around[1]))
    if witness is not None:
        low, high = np.minimum(low, witness - 0.1 * half), np.maximum(high, witness + 0.1 * half)
    # Far from 0, the range must be wide enough for its bounds to be distinct numbers.
    size = np.maximum(np.abs(low), np.abs(high))
    flat, room = high - low <= 1e-9 * size, np.maximum(0.5, 1e-6 * size)
    return np.where(flat, low - room, low), np.where(flat, high + room, high)


def _scatter(axes: Axes, points: QuestionPoints) -> None:
    for label, color, marker in ((False, NEGATIVE, "o"), (True, POSITIVE, "^")):
        own = points.points[points.positive == label]
        axes.scatter(
            own[:, 0], own[:, 1], s=7, color=color, marker=marker, alpha=0.55, linewidths=0, zorder=1 + label
        )


def _star(axes: Axes, x: float, y: float) -> None:
    axes.plot([x], [y], marker="*", ms=13, color=PAPER, mec=INK, mew=1.2, zorder=5, clip_on=False, ls="")


def _draw_interval(
    axes: Axes,
    interval: tuple[float, float],
    points: QuestionPoints | None,
    witness: Points | None,
) -> None:
    """Draw an interval over a histogram: positive scenes upwards, negative ones downwards."""
    middle, half = np.array([np.mean(interval)]), np.array([(interval[1] - interval[0]) / 2])
    low, high = _window(middle, half, None if points is None else points.points, witness, surroundings=5.0)
    reach = _FAR * (high[0] - low[0])
    begin, end = (min(max(bound, low[0] - reach), high[0] + reach) for bound in interval)
    axes.axvspan(begin, end, facecolor=_FILL, edgecolor=_FILL_EDGE, linewidth=1.2, zorder=0.5)
    axes.set_xlim(low[0], high[0])
    axes.axhline(0.0, color=GREY, linewidth=0.8)
    axes.set_yticks([])
    axes.spines["left"].set_visible(False)
    highest = 1.0
    if points is not None and len(points):
        edges = np.linspace(low[0], high[0], _BINS + 1)
        shares = [_shares(points.points[points.positive == label, 0], edges) for label in (True, False)]
        highest = max(float(max(shares[0].max(), shares[1].max())), 1e-9)
        for heights, color in ((shares[0], POSITIVE), (-shares[1], NEGATIVE)):
            axes.bar(edges[:-1], heights, np.diff(edges), align="edge", color=color, alpha=0.75, zorder=2)
    axes.set_ylim(-1.1 * highest, 1.1 * highest)
    if witness is not None:
        _star(axes, float(witness[0]), 0.0)


def _shares(values: Points, edges: Points) -> Points:
    """Return the share of values in each bin, so that classes of any size can be compared."""
    counts, _ = np.histogram(values, edges)
    return counts / max(len(values), 1)


def _draw_arc(axes: Axes, volume: Arc, points: QuestionPoints | None, witness: Points | None) -> None:
    begin, end = (math.degrees(volume.mean + side * volume.radius) for side in (-1, 1))
    whole = volume.radius >= math.pi
    axes.add_patch(
        Wedge(
            (0, 0), 1.0, 0 if whole else begin, 360 if whole else end, facecolor=_FILL, edgecolor=_FILL_EDGE
        )
    )
    turn = np.linspace(0.0, 2 * math.pi, 181)
    axes.plot(np.cos(turn), np.sin(turn), color=GREY, linewidth=1.0)
    axes.plot([0, math.cos(volume.mean)], [0, math.sin(volume.mean)], color=INK, linewidth=1.2)
    if points is not None:
        for label, color, radii in ((False, NEGATIVE, (0.86, 0.98)), (True, POSITIVE, (1.02, 1.14))):
            own = points.thinned(MOST_POINTS, volume)
            angles = own.points[own.positive == label, 0]
            ends = [np.stack([radius * np.cos(angles), radius * np.sin(angles)], axis=1) for radius in radii]
            segments = np.stack([*ends, np.full_like(ends[0], np.nan)], axis=1).reshape(-1, 2)
            axes.plot(segments[:, 0], segments[:, 1], color=color, linewidth=0.8, alpha=0.6)
    if witness is not None:
        _star(axes, math.cos(float(witness[0])), math.sin(float(witness[0])))
    for angle, name in ((0.0, "0"), (0.5 * math.pi, "π/2"), (math.pi, "π"), (-0.5 * math.pi, "-π/2")):
        axes.text(
            1.32 * math.cos(angle),
            1.32 * math.sin(angle),
            name,
            ha="center",
            va="center",
            fontsize=8,
            color=GREY,
        )
    axes.set_xlim(-1.5, 1.5)
    axes.set_ylim(-1.5, 1.5)
    axes.set_aspect("equal")
    axes.set_axis_off()


def _axis_name(mapping: Mapping, component: int) -> str:
    if mapping.arity == 3:
        return ("along", "across")[component]
    return f"{shortened(mapping.attribute.name, _LABEL_WIDTH - 0.3, _LABEL)} {component + 1}"
