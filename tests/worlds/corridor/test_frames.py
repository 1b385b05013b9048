from __future__ import annotations

import pytest

from relforest.playing.frames import Frame
from relforest.playing.painter import paint
from relforest.playing.shapes import Line, Polygon
from relforest.worlds.corridor.frames import corridor_frame, corridor_stage
from relforest.worlds.corridor.state import CorridorState


def frame(x: float, steps: int = 0) -> Frame:
    return corridor_frame(CorridorState(x, steps), window=0.1, max_steps=10)


@pytest.mark.parametrize("x", [0.0, 0.3, 1.0])
def test_the_agent_is_drawn_where_it_stands(x: float) -> None:
    shown = frame(x, 3)
    agent = shown.things[-1]

    assert (agent.key, agent.x, shown.time) == ("agent", x, 3.0)
    assert paint(corridor_stage(0.1), shown).any()


@pytest.mark.parametrize(("x", "left"), [(0.05, -0.048), (0.95, 0.9)])
def test_the_window_lights_up_while_it_pays(x: float, left: float) -> None:
    (lit,) = frame(x).things[0].shapes

    assert isinstance(lit, Polygon)
    assert min(corner[0] for corner in lit.corners) == pytest.approx(left)
    assert frame(x).band == "lit"
    assert (frame(0.5).things[0].shapes, frame(0.5).band) == ((), "")


def test_the_clock_is_full_at_the_last_step_and_never_overflows() -> None:
    for steps, end in ((0, None), (5, 0.5), (10, 1.0), (25, 1.0)):
        clocks = [shape for shape in frame(0.5, steps).things[0].shapes if isinstance(shape, Line)]
        assert [clock.points[-1][0] for clock in clocks] == ([] if end is None else [end])


@pytest.mark.parametrize("window", [0.0, 0.5])
def test_windows_of_any_width_can_be_drawn(window: float) -> None:
    shown = corridor_frame(CorridorState(0.0, 1), window=window, max_steps=1)
    assert paint(corridor_stage(window), shown).shape[2] == 3
