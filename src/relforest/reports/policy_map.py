"""The actions of a keepaway policy if the takers stood elsewhere, as in Figure 7.19 of Palmer (2015)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Final, final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator
from numpy.typing import ArrayLike, NDArray

from relforest.reports.style import BLUE, GOLD, GREEN, GREY, INK, ORANGE, PAPER, PINK, SKY, styled
from relforest.support.errors import InputError
from relforest.support.options import at_least, in_range
from relforest.worlds.keepaway.decisions.variables import n_variables, state_variables

Evaluate = Callable[[NDArray[np.float64]], NDArray[np.float64]]
"""Maps states, (m, n, c) as `Formation.players`, to action values, (m, actions)."""

ACTION_COLORS: Final = (ORANGE, GREEN, BLUE, PINK, GOLD, SKY)
"""Hold, pass to 2, pass to 3 (reddish, greenish and bluish as in the source), and so on."""

_PANEL: Final = 2.8
_BESIDE: Final = 0.5
_BELOW: Final = 0.7
_PER_PANEL: Final = 3
_PALEST: Final = 0.22
_HALO: Final = {"boxstyle": "circle,pad=0.18", "facecolor": PAPER, "edgecolor": INK, "linewidth": 0.9}


@final
@dataclass(frozen=True, slots=True, eq=False)
class Formation:
    """The players of a map: keepers stay in place, takers move together.

    Letters: n players.
    """

    players: NDArray[np.float64]
    """(n, c): x and y in metres, keepers first; further columns, such as velocities, are passed on
    unchanged."""
    actor: int = 0  # the keeper with the ball
    title: str = ""  # title of the panel


@final
@dataclass(frozen=True, slots=True, eq=False)
class Preferences:
    """The actions that a policy prefers, by position of the takers' centre."""

    x: NDArray[np.float64]
    y: NDArray[np.float64]
    """(columns,) and (rows,): positions of the takers' centre, in metres, ascending."""
    actions: NDArray[np.int64]  # (rows, columns) the preferred action
    margins: NDArray[np.float64]  # (rows, columns) its lead over the next best action


def policy_map_figure(
    formations: Sequence[Formation],
    evaluate: Evaluate,
    *,
    keepers: int,
    field: tuple[float, float] = (20.0, 20.0),
    step: float = 0.25,
    title: str = "",
) -> Figure:
    """Draw, for each formation, the actions that a policy prefers if the takers stood elsewhere.

    The color at a position is the action preferred if the centre of the takers were there, darker the
    more its value exceeds the next best. Numbers are the keepers: 1 has the ball, 2 is its nearest teammate
    and so on. Asterisks are the takers in their actual positions. As in the monitor of the RoboCup 2-D
    server, y points down.

    Parameters
    ----------
    formations : sequence of Formation
        One panel each.
    evaluate : callable
        The policy: maps states, (m, n, c), to the values of actions, (m, keepers). Action 0 = hold, k = pass
        to the k-th nearest teammate.
    keepers : int
        Number of keepers.
    field : (float, float)
        Length (along x) and width, in metres.
    step : float
        Distance between positions, in metres.
    title : str

    Raises
    ------
    InputError
        If no formation is given, or a shape, an action or an option is invalid.

    References
    ----------
    Palmer (2015), Figure 7.19.
    """
    if not formations:
        raise InputError("nothing to draw: pass at least one formation")
    maps = [preferences(item, evaluate, keepers=keepers, field=field, step=step) for item in formations]
    scale = float(np.quantile(np.concatenate([item.margins.ravel() for item in maps]), 0.95))
    named = 0.25 * any(formation.title for formation in formations)
    legend = 0.2 * (keepers // (_PER_PANEL * len(maps)) + 1) + 0.15 * (scale > 0)
    height = _PANEL * field[1] / field[0] + _BELOW + legend + named + (0.3 if title else 0.0)
    with styled():
        figure = Figure(figsize=((_PANEL + 0.2) * len(maps) + _BESIDE, height), layout="constrained")
        panels = figure.subplots(1, len(maps), sharey=True, squeeze=False)[0]
        for axes, formation, found in zip(panels, formations, maps, strict=True):
            _draw_map(axes, found, scale, step)
            _draw_players(axes, formation, keepers)
            axes.set_xlim(-field[0] / 2, field[0] / 2)
            axes.set_ylim(field[1] / 2, -field[1] / 2)
            for axis in (axes.xaxis, axes.yaxis):
                axis.set_major_locator(MaxNLocator(nbins=5, steps=(1, 2, 5, 10)))
            axes.set_xlabel("x of the takers' centre (m)")
            if formation.title:
                axes.set_title(formation.title, loc="left", parse_math=False)
        panels[0].set_ylabel("y of the takers' centre (m)")
        _explain(figure, _PER_PANEL * len(maps), keepers, scale)
        if title:
            figure.suptitle(title, x=0.01, ha="left", fontsize=11, parse_math=False)
    return figure


def preferences(
    formation: Formation,
    evaluate: Evaluate,
    *,
    keepers: int,
    field: tuple[float, float] = (20.0, 20.0),
    step: float = 0.25,
) -> Preferences:
    """Return the preferences of a policy by position of the takers' centre; see `policy_map_figure`.

    Raises
    ------
    InputError
        If a shape, an action or an option is invalid.
    """
    step = in_range("step", step, 0.0, min(field), open_low=True)
    players = np.asarray(formation.players, dtype=np.float64)
    keepers = at_least("keepers", keepers, 2)
    if players.ndim != 2 or players.shape[1] < 2 or len(players) <= keepers:
        raise InputError(
            f"players must have one row of at least x and y for each of {keepers} keepers and some takers, "
            f"got the shape {players.shape}"
        )
    if not 0 <= formation.actor < keepers:
        raise InputError(f"actor must be one of the {keepers} keepers, got {formation.actor}")
    x, y = (_places(side, step) for side in field)
    centres = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 1, 2)
    states = np.repeat(players[None], len(centres), axis=0)
    states[:, keepers:, :2] += centres - players[keepers:, :2].mean(axis=0)
    answers = np.asarray(evaluate(states), dtype=np.float64)
    form = (len(y), len(x))
    if answers.shape != (len(states), keepers):
        raise InputError(
            f"the policy must return one value per state and action, {(len(states), keepers)}, got the shape "
            f"{answers.shape}"
        )
    if not np.isfinite(answers).all():
        raise InputError("the policy returns values that are not finite, which have no order: mend it")
    ordered = np.sort(answers, axis=1)
    margins = ordered[:, -1] - ordered[:, -2]
    return Preferences(x, y, answers.argmax(axis=1).reshape(form), margins.reshape(form))


def on_variables(
    function: Callable[[NDArray[np.float64]], ArrayLike], *, keepers: int, actor: int = 0
) -> Evaluate:
    """Turn a policy on the state variables of the benchmark into one for `policy_map_figure`.

    It maps the variables of one state, (13,) for 3 keepers and 2 takers, to the values of the actions,
    (keepers,). The ball is assumed to be at the actor, the keeper that has it.
    """

    def evaluate(states: NDArray[np.float64]) -> NDArray[np.float64]:
        answers = []
        for players in states:
            variables = np.empty(n_variables(keepers, len(players) - keepers))
            state_variables(players, players[actor, :2], keepers, variables)
            answers.append(function(variables))
        return np.asarray(answers)

    return evaluate


def _places(side: float, step: float) -> NDArray[np.float64]:
    """Return the centres of equal cells along a side."""
    count = max(1, round(side / step))
    half = side / count / 2
    return np.linspace(half - side / 2, side / 2 - half, count)


def _draw_map(axes: Axes, found: Preferences, scale: float, step: float) -> None:
    colors = np.array([to_rgb(color) for color in ACTION_COLORS])[found.actions % len(ACTION_COLORS)]
    strength = np.full(found.actions.shape, 0.6)
    if scale > 0:
        strength = _PALEST + (1 - _PALEST) * np.clip(found.margins / scale, 0, 1)
    ground = np.ones((*found.actions.shape, 3))
    image = ground + strength[:, :, None] * (colors - ground)
    halves = [
        (values[-1] - values[0]) / 2 / max(len(values) - 1, 1) or step / 2 for values in (found.x, found.y)
    ]
    extent = (
        found.x[0] - halves[0],
        found.x[-1] + halves[0],
        found.y[-1] + halves[1],
        found.y[0] - halves[1],
    )
    axes.imshow(image, extent=extent, interpolation="nearest", zorder=0)


def _draw_players(axes: Axes, formation: Formation, keepers: int) -> None:
    players, actor = formation.players, formation.actor
    away = np.hypot(*(players[:keepers, :2] - players[actor, :2]).T)
    # Of teammates at equal distance, the one with the higher number comes first, as in the game.
    order = sorted(range(keepers), key=lambda keeper: (keeper != actor, away[keeper], -keeper))
    for number, keeper in enumerate(order, start=1):
        axes.text(
            float(players[keeper, 0]),
            float(players[keeper, 1]),
            str(number),
            ha="center",
            va="center",
            fontsize=8.5,
            fontweight="bold",
            bbox=_HALO,
            zorder=3,
        )
    axes.plot(
        *players[keepers:, :2].T, "*", color=INK, markersize=11, mec=PAPER, mew=0.8, zorder=3, clip_on=False
    )


def _explain(figure: Figure, columns: int, keepers: int, scale: float) -> None:
    names = ["hold", *(f"pass to {number}" for number in range(2, keepers + 1))]
    marks = [
        Patch(facecolor=ACTION_COLORS[action % len(ACTION_COLORS)], label=name)
        for action, name in enumerate(names)
    ]
    legend = figure.legend(
        handles=marks,
        loc="outside lower left",
        ncols=columns,
        handlelength=1.0,
        title=f"darkest: better than the next by {scale:.3g} or more" if scale > 0 else None,
        title_fontsize=8.0,
        alignment="left",
    )
    legend.get_title().set_color(GREY)
