"""Action values of a one-dimensional world over its only variable, as in Figure 7.1 of Palmer (2015)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import ArrayLike, NDArray

from relforest.reports.style import GREY, INK, PAPER, SERIES, mixed, styled
from relforest.support.errors import InputError

_WIDTH: Final = 6.4
_TOP_HEIGHT: Final = 3.3
_BAND_HEIGHT: Final = 0.16
_MOST_NAMED: Final = 24
_MOST_POINTS: Final = 1500
_DARKEST, _LIGHTEST = 0.8, 0.2


@final
@dataclass(frozen=True, slots=True, eq=False)
class LeafBand:
    """The deciding leaf of a tree, over x.

    Parameters
    ----------
    action : int
        The action that the tree belongs to.
    leaves : (n_x,) int64
        Ordinal of the leaf at each x.
    """

    action: int
    leaves: NDArray[np.int64]


@final
@dataclass(frozen=True, slots=True, eq=False)
class BellmanErrors:
    """Bellman errors of training examples.

    Parameters
    ----------
    x : (m,) float64
        The position where each example began.
    actions : (m,) int64
        The action taken.
    errors : (m,) float64
        Its Bellman error.
    """

    x: NDArray[np.float64]
    actions: NDArray[np.int64]
    errors: NDArray[np.float64]


def corridor_figure(
    x: ArrayLike,
    q_values: ArrayLike,
    action_names: Sequence[str],
    bellman: BellmanErrors,
    leaf_bands: Sequence[LeafBand],
    *,
    title: str = "",
) -> Figure:
    """Draw action values, Bellman errors and active leaves over x; the background shows the policy.

    Parameters
    ----------
    x : (n_x,) float64
        Ascending.
    q_values : (n_actions, n_x) float64
        Value of each action at each x.
    action_names : sequence of str
    bellman : BellmanErrors
        Drawn as points, with the mean of each action as a dotted line.
    leaf_bands : sequence of LeafBand
        One per tree, drawn as a bar that changes color with the leaf.
    title : str

    Raises
    ------
    InputError
        If the shapes do not match.

    References
    ----------
    Palmer (2015), Figures 6.1 and 7.1.
    """
    x, q_values = np.asarray(x, dtype=np.float64), np.asarray(q_values, dtype=np.float64)
    _check(x, q_values, action_names, leaf_bands)
    bands_height = min(max(0.35, _BAND_HEIGHT * len(leaf_bands)), _TOP_HEIGHT)
    with styled():
        figure = Figure(figsize=(_WIDTH, _TOP_HEIGHT + bands_height + 1.0), layout="constrained")
        top, bottom = figure.subplots(2, 1, sharex=True, height_ratios=(_TOP_HEIGHT, bands_height))
        _draw_policy(top, x, q_values)
        _draw_values(top, x, q_values)
        _draw_errors(top, bellman, len(action_names))
        top.set_ylabel("Q value, Bellman error")
        top.set_xlim(x[0], x[-1])
        _explain(top, action_names)
        if title:
            top.set_title(title, loc="left", pad=22.0, parse_math=False)
        _draw_bands(bottom, x, leaf_bands, action_names)
        bottom.set_xlabel("x")
    return figure


def _check(
    x: NDArray[np.float64], q_values: NDArray[np.float64], names: Sequence[str], bands: Sequence[LeafBand]
) -> None:
    if x.ndim != 1 or len(x) < 2 or q_values.shape != (len(names), len(x)):
        raise InputError(
            f"q_values must have the shape (actions, x) = ({len(names)}, {len(x)}), with at least 2 values "
            f"of x, got {q_values.shape}"
        )
    for band in bands:
        if band.leaves.shape != x.shape or not 0 <= band.action < len(names):
            raise InputError(f"a leaf band needs one leaf per x and one of {len(names)} actions")


def _draw_policy(axes: Axes, x: NDArray[np.float64], q_values: NDArray[np.float64]) -> None:
    best = q_values.argmax(axis=0)
    for low, high, action in _stretches(x, best):
        axes.axvspan(low, high, color=mixed(SERIES[action % len(SERIES)], 0.12), linewidth=0, zorder=0)


def _draw_values(axes: Axes, x: NDArray[np.float64], q_values: NDArray[np.float64]) -> None:
    for action, values in enumerate(q_values):
        axes.plot(x, values, color=SERIES[action % len(SERIES)], linewidth=2.0, zorder=3)


def _explain(axes: Axes, names: Sequence[str]) -> None:
    """Place a legend above the axes, away from the curves."""
    marks = [
        Line2D([], [], color=SERIES[action % len(SERIES)], linewidth=2.0, label=f"Q({name})")
        for action, name in enumerate(names)
    ]
    marks.append(Line2D([], [], color=GREY, linestyle="", marker="o", markersize=2.5, label="Bellman error"))
    marks.append(Line2D([], [], color=GREY, linestyle=":", linewidth=1.3, label="its mean"))
    axes.legend(
        handles=marks, loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=len(marks), borderaxespad=0.2
    )


def _draw_errors(axes: Axes, bellman: BellmanErrors, n_actions: int) -> None:
    axes.axhline(0.0, color=GREY, linewidth=0.6, zorder=0.5)
    for action in range(n_actions):
        own = np.flatnonzero(bellman.actions == action)
        if not len(own):
            continue
        color = SERIES[action % len(SERIES)]
        axes.axhline(float(bellman.errors[own].mean()), color=color, linewidth=1.3, linestyle=":", zorder=2.5)
        shown = (
            own
            if len(own) <= _MOST_POINTS
            else own[np.linspace(0, len(own) - 1, _MOST_POINTS).astype(np.int64)]
        )
        axes.scatter(
            bellman.x[shown], bellman.errors[shown], s=5, color=color, alpha=0.4, linewidths=0, zorder=1
        )


def _draw_bands(axes: Axes, x: NDArray[np.float64], bands: Sequence[LeafBand], names: Sequence[str]) -> None:
    for row, band in enumerate(bands):
        color = SERIES[band.action % len(SERIES)]
        present = np.unique(band.leaves)
        shades = dict(zip(present.tolist(), np.linspace(_DARKEST, _LIGHTEST, len(present)), strict=True))
        for low, high, leaf in _stretches(x, band.leaves):
            shade = mixed(color, float(shades[leaf]))
            axes.barh(row, high - low, left=low, height=0.8, color=shade, edgecolor=PAPER, linewidth=0.5)
    axes.set_ylim(max(len(bands), 1) - 0.4, -0.6)
    named = range(len(bands)) if len(bands) <= _MOST_NAMED else range(0)
    axes.set_yticks(list(named), [names[bands[row].action] for row in named])
    axes.tick_params(axis="y", length=0, labelsize=7)
    axes.spines["left"].set_visible(False)
    axes.set_title("active leaf of each tree", loc="left", pad=2.0, fontsize=8.0)
    if not bands:
        axes.text(0.5, 0.5, "no trees", transform=axes.transAxes, ha="center", va="center", color=INK)


def _stretches(x: NDArray[np.float64], codes: NDArray[np.int64]) -> list[tuple[float, float, int]]:
    """Return (from, to, code) of each run of equal codes; neighbours meet halfway."""
    changes = np.flatnonzero(codes[1:] != codes[:-1])
    middles = (x[changes] + x[changes + 1]) / 2
    bounds = [float(x[0]), *middles.tolist(), float(x[-1])]
    firsts = [0, *(changes + 1).tolist()]
    return [(bounds[i], bounds[i + 1], int(codes[first])) for i, first in enumerate(firsts)]
