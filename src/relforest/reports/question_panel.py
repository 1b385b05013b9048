"""The panel of a question: the name, picture and numbers of its decision volume."""

from __future__ import annotations

from typing import Any, Final

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from relforest.reports.page_layout import Page, Place
from relforest.reports.question_points import QuestionPoints
from relforest.reports.style import GREY
from relforest.reports.text_size import line_height, shortened
from relforest.reports.volume_panel import draw_volume
from relforest.trees import Question
from relforest.trees.nodes import variable_name
from relforest.volumes import Arc, Slab, Volume

PANEL_WIDTH: Final = 2.85
_PLOT_WIDTH: Final = 2.05
_PLOT_HEIGHT: Final = 1.75
_PLOT_LEFT: Final = 0.55
_TITLE_HEIGHT: Final = 0.4
_AXIS_HEIGHT: Final = 0.42
_SPACE_BELOW: Final = 0.25
_TITLE: Final = 9.0
_TABLE: Final = 7.5
_NAME_WIDTH: Final = 0.95
_MOST_AXES: Final = 3
_MOST_NUMBERS: Final = 4


def volume_table(volume: Volume) -> tuple[tuple[str, str], ...]:
    """Return names and values: mean and scaled eigenvectors of an ellipsoid, or the parameters of an arc.

    A scaled eigenvector reaches from the mean to the boundary. A slab has the values of its interval.
    """
    if isinstance(volume, Slab):
        return volume_table(volume.interval)
    if isinstance(volume, Arc):
        rows = (("mean", volume.mean), ("radius", volume.radius), ("kappa", volume.kappa))
        return tuple((name, f"{value:.3g}{'' if name == 'kappa' else ' rad'}") for name, value in rows)
    axes = volume.axes[:_MOST_AXES]
    names = ["extent"] if volume.dim == 1 else [f"extent {number + 1}" for number in range(len(axes))]
    table = [
        ("mean", _vector(volume.mean)),
        *((name, _vector(axis)) for name, axis in zip(names, axes, strict=True)),
    ]
    if volume.dim > _MOST_AXES:
        table.append(("", f"and {volume.dim - _MOST_AXES} shorter ones"))
    return tuple(table)


def panel_height(volumes: list[Volume]) -> float:
    """Return the height in inches of panels with room for the table of every volume."""
    lines = max((len(volume_table(volume)) for volume in volumes), default=0)
    return _TITLE_HEIGHT + _PLOT_HEIGHT + _AXIS_HEIGHT + lines * line_height(_TABLE) + _SPACE_BELOW


def draw_panel(
    figure: Figure,
    page: Page,
    place: Place,
    question: tuple[str, Question],
    points: QuestionPoints | None,
    witness: NDArray[np.float64] | None,
) -> None:
    """Draw the panel of a question, with its top left corner at ``place`` on the page (inches).

    ``question`` is a pair of short name and question; see `draw_volume` for points and witness.
    """
    name, node = question
    left, top = place
    variables = ", ".join(map(variable_name, node.variables))
    title = shortened(f"{name}  {node.mapping.name}", PANEL_WIDTH - 0.2, _TITLE, "bold")
    _write(figure, page, (left + 0.1, top), title, fontsize=_TITLE, fontweight="bold")
    _write(
        figure, page, (left + 0.1, top + line_height(_TITLE)), f"of {variables}", fontsize=_TABLE, color=GREY
    )
    plot_left, plot_top = left + _PLOT_LEFT, top + _TITLE_HEIGHT
    axes = figure.add_axes(page.bounds((plot_left, plot_top), _PLOT_WIDTH, _PLOT_HEIGHT))
    axes.tick_params(labelsize=_TABLE, length=2.5, pad=1.5)
    axes.xaxis.label.set_fontsize(_TABLE)
    axes.yaxis.label.set_fontsize(_TABLE)
    axes.locator_params(nbins=4)
    draw_volume(axes, node.mapping, node.volume, points, witness)
    y = plot_top + _PLOT_HEIGHT + _AXIS_HEIGHT
    for row, value in volume_table(node.volume):
        _write(figure, page, (plot_left, y), row, fontsize=_TABLE, color=GREY)
        text = shortened(value, PANEL_WIDTH - _PLOT_LEFT - _NAME_WIDTH + 0.4, _TABLE)
        _write(figure, page, (plot_left + _NAME_WIDTH - 0.4, y), text, fontsize=_TABLE)
        y += line_height(_TABLE)


def _write(figure: Figure, page: Page, place: Place, text: str, **style: Any) -> None:  # noqa: ANN401
    figure.text(*page.at(place), text, ha="left", va="top", parse_math=False, **style)


def _vector(values: NDArray[np.float64]) -> str:
    numbers = [f"{value:.3g}" for value in (np.round(values, 3) + 0.0)[:_MOST_NUMBERS].tolist()]
    rest = ["…"] if len(values) > _MOST_NUMBERS else []
    return numbers[0] if len(values) == 1 else f"({', '.join([*numbers, *rest])})"
