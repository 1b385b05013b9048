from __future__ import annotations

import numpy as np
import pytest

from relforest.worlds.corridor.state import CorridorState
from relforest.worlds.corridor.viewer import HEIGHT, WIDTH, CorridorViewer

AGENT_BLUE = (38, 84, 150)


@pytest.fixture
def viewer() -> CorridorViewer:
    return CorridorViewer(window=0.1, max_steps=10)


@pytest.mark.parametrize("x", [0.0, 0.1, 0.5, 1.0])
def test_pictures_have_the_form_that_gymnasium_wants(viewer: CorridorViewer, x: float) -> None:
    picture = viewer.draw(CorridorState(x, 10))
    assert picture.shape == (HEIGHT, WIDTH, 3)
    assert picture.dtype == np.uint8


def test_the_agent_is_drawn_where_it_stands(viewer: CorridorViewer) -> None:
    def agent_columns(x: float) -> np.ndarray[tuple[int], np.dtype[np.intp]]:
        return np.flatnonzero((viewer.draw(CorridorState(x)) == AGENT_BLUE).all(axis=2).any(axis=0))

    centers = [agent_columns(x).mean() for x in (0.0, 0.5, 1.0)]
    assert centers[1] == pytest.approx((WIDTH - 1) / 2, abs=0.5)
    assert centers[1] - centers[0] == pytest.approx(centers[2] - centers[1], abs=1.0)
    assert centers[2] - centers[0] == pytest.approx(496, abs=1.0)  # the corridor is 496 pixels long


def test_the_picture_changes_with_location_and_time_only(viewer: CorridorViewer) -> None:
    picture = viewer.draw(CorridorState(0.3, 2))
    np.testing.assert_array_equal(picture, viewer.draw(CorridorState(0.3, 2)))
    assert (picture != viewer.draw(CorridorState(0.31, 2))).any()
    assert (picture != viewer.draw(CorridorState(0.3, 3))).any()


@pytest.mark.parametrize(("x", "corner"), [(0.02, 30), (0.98, WIDTH - 30)])
def test_the_window_lights_up_while_it_pays(viewer: CorridorViewer, x: float, corner: int) -> None:
    row = 60  # above the agent, inside the floor
    dark = viewer.draw(CorridorState(0.5))[row, corner]
    lit = viewer.draw(CorridorState(x))[row, corner]
    assert dark.tolist() == [178, 223, 200]
    assert lit.tolist() == [88, 190, 140]


def test_the_clock_is_full_at_the_last_step_and_never_overflows(viewer: CorridorViewer) -> None:
    last, beyond = viewer.draw(CorridorState(0.5, 10)), viewer.draw(CorridorState(0.5, 25))
    np.testing.assert_array_equal(last, beyond)


@pytest.mark.parametrize("window", [0.0, 0.5])
def test_extreme_windows_can_be_drawn(window: float) -> None:
    viewer = CorridorViewer(window=window, max_steps=1)
    assert viewer.draw(CorridorState(0.0, 1)).shape == (HEIGHT, WIDTH, 3)
