"""The style of all pictures: colors that color-blind readers can distinguish, thin lines, small type."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import AbstractContextManager
from types import MappingProxyType
from typing import Any, Final

import matplotlib as mpl
from matplotlib.colors import to_rgb

Color = tuple[float, float, float]

BLUE: Final = "#0072B2"
ORANGE: Final = "#D55E00"
GREEN: Final = "#009E73"
PINK: Final = "#CC79A7"
SKY: Final = "#56B4E9"
GOLD: Final = "#E69F00"
INK: Final = "#262626"
GREY: Final = "#737373"
PALE: Final = "#D9D9D9"
PAPER: Final = "#FFFFFF"

POSITIVE: Final = BLUE
NEGATIVE: Final = ORANGE

SERIES: Final = (BLUE, ORANGE, GREEN, PINK, GOLD, SKY)
"""Colors of lines, in order (Okabe and Ito's palette, without its yellow, which is too light for lines)."""
MARKERS: Final = ("o", "s", "^", "D", "v", "P")
"""Markers of lines, in the same order, for printing without colors."""

# Keys are `Any` because their type differs between versions of Matplotlib.
STYLE: Final[Mapping[Any, Any]] = MappingProxyType(
    {
        "axes.edgecolor": GREY,
        "axes.labelcolor": INK,
        "axes.labelsize": 9.0,
        "axes.linewidth": 0.8,
        "axes.spines.right": False,
        "axes.spines.top": False,
        "axes.titlesize": 10.0,
        "figure.facecolor": PAPER,
        "font.family": ["sans-serif"],
        "font.sans-serif": ["DejaVu Sans"],
        "font.size": 9.0,
        "legend.fontsize": 8.5,
        "legend.frameon": False,
        "lines.linewidth": 1.6,
        "savefig.dpi": 150,
        # Without a salt, the identifiers in an SVG file would differ each time.
        "svg.hashsalt": "relforest",
        "text.color": INK,
        "text.usetex": False,
        "xtick.color": GREY,
        "xtick.labelcolor": INK,
        "xtick.labelsize": 8.0,
        "ytick.color": GREY,
        "ytick.labelcolor": INK,
        "ytick.labelsize": 8.0,
    }
)


def styled() -> AbstractContextManager[None]:
    """Return a context with the house style; Matplotlib's previous settings are restored afterwards."""
    return mpl.rc_context(dict(STYLE))


def mixed(color: str, share: float) -> Color:
    """Mix ``share`` parts of a color with paper; returns red, green and blue."""
    red, green, blue = (
        share * own + (1.0 - share) * ground for own, ground in zip(to_rgb(color), to_rgb(PAPER), strict=True)
    )
    return red, green, blue


def probability_color(probability: float) -> Color:
    """Return the color of a leaf: from negative at 0 through white at 1/2 to positive at 1."""
    strength = 0.65 * abs(2.0 * probability - 1.0)
    return mixed(POSITIVE if probability >= 0.5 else NEGATIVE, strength)
