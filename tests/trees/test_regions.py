"""What a volume holds, word for word."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from relforest.trees.regions import interval, region, span
from relforest.volumes import Arc, Ellipsoid


def upright(mean: Sequence[float], half_widths: Sequence[float], radius: float = 1.0) -> Ellipsoid:
    """Reaches `half_widths` along the axes (times the radius)."""
    return Ellipsoid(np.array(mean, dtype=np.float64), np.diag(np.square(half_widths)), radius, 3, 0.1)


@pytest.mark.parametrize(
    ("between", "expected"),
    [
        ((3.0, 7.0), "between 3 and 7"),
        ((33.1204, 33.1389), "between 33.1204 and 33.1389"),
        ((-0.5, 2.0), "between -0.5 and 2"),
        ((26.6, 26.6), "exactly 26.6"),
        ((0.0, 0.0), "exactly 0"),
        # Half-lines in effect keep both ends.
        ((3.0, 4e6), "at least 3 (at most 4000000)"),
        ((-4e6, -0.25), "at most -0.25 (at least -4000000)"),
        ((-4e6, 3.0), "at most 3 (at least -4000000)"),
        ((0.0, 4e6), "between 0 and 4000000"),
        ((-4e6, 4e6), "between -4000000 and 4000000"),
        ((2000.0, 4e6), "at least 2000 (at most 4000000)"),
        ((5000.0, 4e6), "between 5000 and 4000000"),
    ],
)
def test_intervals(between: tuple[float, float], expected: str) -> None:
    assert span(between) == expected


def test_the_ends_of_a_volume() -> None:
    assert interval(upright([5.0], [2.0], 1.5)) == (2.0, 8.0)
    assert interval(Arc(1.0, 0.25, 2.0)) == (0.75, 1.25)
    # What is beyond floating point numbers ends at the largest one.
    assert interval(upright([0.0], [1e10], 1e308)) == (-np.finfo(float).max, np.finfo(float).max)


@pytest.mark.parametrize(
    ("volume", "expected"),
    [
        (
            upright([1.5, -2], [2, 1]),
            "in the ellipse around (1.5, -2) that reaches 2 along (1, 0) and 1 across",
        ),
        (
            upright([1.5, -2], [1, 2]),
            "in the ellipse around (1.5, -2) that reaches 2 along (0, 1) and 1 across",
        ),
        # Half-axes equal within a percent.
        (upright([1.5, -2], [2, 2.015]), "within 2.02 of (1.5, -2)"),
        (upright([1.5, -2], [0.2, 0.2], 0.0), "exactly at (1.5, -2)"),
        (upright([9, 8, 1], [0.4, 0.4, 0.4]), "within 0.4 of (9, 8, 1)"),
        (
            upright([0.9, 0.8, 0.1], [1, 2, 3], 0.1),
            (
                "in the ellipsoid around (0.9, 0.8, 0.1) that reaches 0.3 along (0, 0, 1), "
                "0.2 along (0, 1, 0) and 0.1 along (1, 0, 0)"
            ),
        ),
        # No scientific notation where plain numbers are short, no minus before a zero.
        (
            upright([123456, -0.001], [1000, 12.3456]),
            "in the ellipse around (123456, 0) that reaches 1000 along (1, 0) and 12.3 across",
        ),
        # The centre is rounded relative to the reach, however small.
        (upright([1582218195.3, 0.00123], [0.2, 0.2]), "within 0.2 of (1582218195.3, 0)"),
        (
            upright([0.00123, -0.2], [0.002, 0.001]),
            "in the ellipse around (0.00123, -0.2) that reaches 0.002 along (1, 0) and 0.001 across",
        ),
        (upright([1, 2], [1e150, 1e150], 1e200), "within 1.8e+308 of (0, 0)"),
        (
            upright([0, 0, 0, 0], [4, 3, 2, 1]),
            (
                "in the ellipsoid around (0, 0, 0, 0) that reaches 4 along (1, 0, 0, 0), "
                "3 along (0, 1, 0, 0), 2 along (0, 0, 1, 0) and at most 1 along the other axes"
            ),
        ),
        (
            upright(range(9), range(1, 10)),
            (
                "in the ellipsoid around (0, 1, 2, 3, ...) that reaches 9 along its longest axis and "
                "1 along its shortest"
            ),
        ),
    ],
)
def test_ellipsoids(volume: Ellipsoid, expected: str) -> None:
    assert region(volume) == expected


def test_an_oblique_ellipse_names_its_long_axis() -> None:
    # Eigenvalues 9 along (1, 1) and 1 along (1, -1).
    oblique = Ellipsoid(np.zeros(2), np.array([[5.0, 4.0], [4.0, 5.0]]), 1.0, 1, 0.1)

    assert region(oblique) == "in the ellipse around (0, 0) that reaches 3 along (0.71, 0.71) and 1 across"


@given(
    st.floats(-math.pi, math.pi),
    st.floats(-3, 3),
    st.floats(-3, 3),
    st.floats(-100, 100),
    st.floats(-100, 100),
)
def test_an_ellipse_drawn_from_its_words_is_the_same(
    turned: float, long: float, short: float, x: float, y: float
) -> None:
    half = np.sort(10.0 ** np.array([short, long]))
    axes = np.array([[-math.sin(turned), math.cos(turned)], [math.cos(turned), math.sin(turned)]])
    volume = Ellipsoid(np.array([x, y]), (axes.T * half**2) @ axes, 1.0, 3, 0.1)
    numbers = [float(text) for text in re.findall(r"-?\d[\d.]*(?:e[+-]\d+)?", region(volume))]
    if len(numbers) == 3:
        radius, *centre = numbers
        along, reach, across = np.array([1.0, 0.0]), radius, radius
    else:
        *centre, reach, first, second, across = numbers
        along = np.array([first, second]) / math.hypot(first, second)
    tips = np.array(centre) + np.array(
        [reach * along, across * np.array([-along[1], along[0]]), -reach * along, [0.0, 0.0]]
    )

    # The three tips lie on the true boundary, and the centre is the true one, within a few percent.
    assert volume.distance(tips[:3]) == pytest.approx(1.0, abs=0.08)
    assert volume.distance(tips[3:]) == pytest.approx(0.0, abs=0.04)


@pytest.mark.parametrize(
    ("mean", "radius", "expected"),
    [
        (1.0, 0.25, "within 0.25 rad of 1 rad"),
        (1.23456, 1e-5, "within 0.00001 rad of 1.23456 rad"),
        (-0.0004, 0.1, "within 0.1 rad of 0 rad"),
        # Turned by a whole circle.
        (2 * math.pi + 1, 0.25, "within 0.25 rad of 1 rad"),
        (1.0, 0.0, "exactly 1 rad"),
        (1.0, math.pi, "at any angle"),
        (1.0, 7.0, "at any angle"),
        # What is left out matters more than what is inside.
        (1.0, math.pi - 0.001, "at least 0.001 rad from -2.14159 rad"),
    ],
)
def test_arcs(mean: float, radius: float, expected: str) -> None:
    assert region(Arc(mean, radius, 2.0)) == expected
