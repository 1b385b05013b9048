from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from numpy.typing import NDArray

from relforest.reports.policy_map import (
    ACTION_COLORS,
    Evaluate,
    Formation,
    on_variables,
    policy_map_figure,
    preferences,
)
from relforest.support.errors import InputError
from reports.drawn_trees import texts_of

# Keeper 2 is nearer to keeper 0 than keeper 1 is; the takers' centre is (0, 1).
PLAYERS = np.array([[-5.0, 0.0, 7.0], [8.0, 0.0, 7.0], [0.0, -6.0, 7.0], [1.0, 1.0, 7.0], [-1.0, 1.0, 7.0]])


def by_side(states: NDArray[np.float64]) -> NDArray[np.float64]:
    """Holding is worth the x of the takers' centre, passing to the nearest 0, to the farthest -100."""
    x = states[:, 3:, 0].mean(axis=1)
    return np.stack([x, np.zeros(len(x)), np.full(len(x), -100.0)], axis=1)


def draw(evaluate: Evaluate = by_side, **options: Any) -> Figure:
    return policy_map_figure([Formation(PLAYERS)], evaluate, keepers=3, step=2.0, **options)


def image_of(figure: Figure, panel: int = 0) -> NDArray[np.float64]:
    (image,) = figure.axes[panel].images
    return np.asarray(image.get_array(), dtype=np.float64)


def test_takers_move_together_and_keepers_stay() -> None:
    seen = []

    def evaluate(states: NDArray[np.float64]) -> NDArray[np.float64]:
        seen.append(states.copy())
        return by_side(states)

    preferences(Formation(PLAYERS), evaluate, keepers=3, field=(4.0, 2.0), step=1.0)
    (states,) = seen

    # Cells of 1 m: centres at x = -1.5 ... 1.5 and y = -0.5, 0.5; the second row comes later.
    assert states.shape == (8, 5, 3)
    assert (states[:, :3] == PLAYERS[:3]).all()
    assert states[:, 3:, :2].mean(axis=1).tolist() == [
        *([x, -0.5] for x in (-1.5, -0.5, 0.5, 1.5)),
        *([x, 0.5] for x in (-1.5, -0.5, 0.5, 1.5)),
    ]
    assert (states[:, 3, 0] - states[:, 4, 0] == 2.0).all()
    assert (states[:, :, 2] == 7.0).all()


def test_the_best_action_and_its_lead_are_found() -> None:
    found = preferences(Formation(PLAYERS), by_side, keepers=3, field=(4.0, 2.0), step=1.0)

    assert found.x.tolist() == [-1.5, -0.5, 0.5, 1.5]
    assert found.y.tolist() == [-0.5, 0.5]
    assert found.actions.tolist() == [[1, 1, 0, 0]] * 2
    assert found.margins.tolist() == [[1.5, 0.5, 0.5, 1.5]] * 2


def test_color_is_the_action_and_darkness_the_lead() -> None:
    image = image_of(draw())
    # Ten cells of 2 m; leads are 9, 7, 5, 3, 1 on both sides, and 9 is the 95 % quantile.
    assert image.shape == (10, 10, 3)
    assert image[0, 0] == pytest.approx(to_rgb(ACTION_COLORS[1]))
    assert image[9, 9] == pytest.approx(to_rgb(ACTION_COLORS[0]))
    darkness = 3.0 - image[4].sum(axis=1)
    assert (np.diff(darkness[:5]) < 0).all()
    assert (np.diff(darkness[5:]) > 0).all()


def test_equal_values_everywhere_are_no_reason_to_divide_by_zero() -> None:
    figure = draw(lambda states: np.zeros((len(states), 3)))

    assert len(np.unique(image_of(figure).reshape(-1, 3), axis=0)) == 1


def test_keepers_are_numbered_from_the_one_with_the_ball_and_takers_are_asterisks() -> None:
    (axes,) = draw().axes
    numbers = {text.get_text(): text.get_position() for text in axes.texts}
    (takers,) = [line for line in axes.lines if line.get_marker() == "*"]

    assert numbers == {"1": (-5.0, 0.0), "2": (0.0, -6.0), "3": (8.0, 0.0)}
    assert np.asarray(takers.get_xydata()).tolist() == PLAYERS[3:, :2].tolist()
    # y points down.
    assert axes.get_ylim() == (10.0, -10.0)


def test_formations_stand_side_by_side_on_the_same_scale() -> None:
    formations = [Formation(PLAYERS, title="first"), Formation(PLAYERS, actor=1, title="second")]
    figure = policy_map_figure(formations, by_side, keepers=3, step=2.0, field=(24.0, 16.0), title="a policy")
    first, second = figure.axes

    assert np.array_equal(image_of(figure, 0), image_of(figure, 1))
    assert [text.get_position() for text in second.texts if text.get_text() == "1"] == [(8.0, 0.0)]
    assert first.get_xlim() == (-12.0, 12.0)
    assert {"first", "second", "a policy", "hold", "pass to 2", "pass to 3"} <= set(texts_of(figure))


def test_policies_of_state_variables_can_be_drawn() -> None:
    seen = []

    def policy(variables: NDArray[np.float64]) -> list[float]:
        seen.append(variables)
        return [5.0, 10.0 - variables[3], 0.0]

    evaluate = on_variables(policy, keepers=3, actor=0)
    found = preferences(Formation(PLAYERS), evaluate, keepers=3, field=(20.0, 2.0), step=2.0)

    # The first variable is the distance of the actor to the centre, the fourth that to the nearest taker.
    # With the takers' centre at (x, 0), the takers stand at x - 1 and x + 1, so one is less than 5 m from
    # the actor at x = -5 if -11 < x < 1.
    assert all(variables.shape == (13,) and variables[0] == 5.0 for variables in seen)
    assert found.x[found.actions[0] == 1].tolist() == [-9.0, -7.0, -5.0, -3.0, -1.0]


@pytest.mark.parametrize(
    ("evaluate", "message"),
    [
        (lambda states: np.zeros((len(states), 2)), "one value per state and action"),
        (lambda states: np.full((len(states), 3), np.nan), "values that are not finite"),
        (lambda states: np.zeros(len(states)), "got the shape"),
    ],
)
def test_wrong_answers_of_a_policy_are_refused(evaluate: Evaluate, message: str) -> None:
    with pytest.raises(InputError, match=message):
        draw(evaluate)


@pytest.mark.parametrize(
    ("formation", "options", "message"),
    [
        (Formation(PLAYERS[:3]), {}, r"3 keepers and some takers, got the shape \(3, 3\)"),
        (Formation(PLAYERS[:, :1]), {}, "at least x and y"),
        (Formation(PLAYERS, actor=3), {}, "actor must be one of the 3 keepers, got 3"),
        (Formation(PLAYERS), {"step": 0.0}, "step must be"),
        (Formation(PLAYERS), {"step": np.nan}, "step must be"),
    ],
)
def test_wrong_formations_are_refused(formation: Formation, options: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        preferences(formation, by_side, keepers=3, **options)
    with pytest.raises(InputError, match="at least one formation"):
        policy_map_figure([], by_side, keepers=3)
