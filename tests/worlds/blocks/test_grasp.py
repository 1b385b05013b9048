from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from relforest.worlds.blocks.grasp import TOTAL_FORCE, forces, springs


@pytest.mark.parametrize(
    ("eccentricity", "main", "support"),
    [
        (0.0, 1136.4, 681.8),
        (0.1, 1463.2, 518.4),
        (0.2, 1794.4, 352.8),
        (0.3, 2080.4, 209.8),
        (0.5, 2409.6, 45.2),
        (0.7, 2492.7, 3.63),
        (0.8, 2499.0, 0.48),
    ],
)
def test_forces_are_those_of_the_source(eccentricity: float, main: float, support: float) -> None:
    along = forces((eccentricity * 3.0, 0.0), (3.0, 2.0))
    across = forces((0.5 * eccentricity * 3.0, -eccentricity * 2.0), (3.0, 2.0))

    assert along == pytest.approx((main, support), abs=0.05)
    assert across == pytest.approx(along)


def test_a_block_held_near_its_edge_hangs_from_one_point() -> None:
    held = springs((2.7, 0.0), (3.0, 2.0))

    assert [spring.point for spring in held] == [(2.7, 0.0)]
    # At 0.9 the supports would have 0.6 * 0.1 ** 5 = 6e-6 of the main force, and are left out.
    assert held[0].max_force == pytest.approx(2499.97, abs=0.01)


def test_supports_stand_across_the_thinner_side() -> None:
    wide, tall = springs((0.3, 0.2), (4.0, 2.0)), springs((0.3, 0.2), (2.0, 4.0))
    square = springs((0.3, 0.2), (2.0, 2.0))

    assert [spring.point for spring in wide] == [(0.3, 0.2), (0.3, -2.0), (0.3, 2.0)]
    assert [spring.point for spring in tall] == [(0.3, 0.2), (-2.0, 0.2), (2.0, 0.2)]
    assert [spring.point for spring in square] == [(0.3, 0.2), (0.3, -2.0), (0.3, 2.0)]


def test_stiffness_grows_with_mass_but_force_does_not() -> None:
    light, heavy = springs((0.0, 0.0), (0.5, 0.5))[0], springs((0.0, 0.0), (5.0, 5.0))[0]

    # Box2D multiplies by the mass itself: frequencies are equal. Damping: 3.87298 * sqrt(mass 1 and 100).
    assert (light.frequency, heavy.frequency) == pytest.approx((12.9099, 12.9099), abs=1e-4)
    assert (light.damping, heavy.damping) == pytest.approx((3.87298, 38.7298), abs=1e-4)
    assert light.max_force == heavy.max_force


@given(x=st.floats(-1.0, 1.0), y=st.floats(-1.0, 1.0), width=st.floats(0.5, 5.0), height=st.floats(0.5, 5.0))
def test_all_springs_together_always_have_the_same_force(
    x: float, y: float, width: float, height: float
) -> None:
    total = sum(spring.max_force for spring in springs((x * width, y * height), (width, height)))

    assert total == pytest.approx(TOTAL_FORCE, rel=2.1e-4)
    assert math.isfinite(total)
