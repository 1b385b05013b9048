"""What matters most to a policy of ``smrf-q``: conditions over scenes of its experience, and their effect."""

from __future__ import annotations

import math
from typing import Any, Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LinearSegmentedColormap, to_rgb
from matplotlib.figure import Figure
from numpy.typing import NDArray

from relforest.reports.style import GREY, INK, NEGATIVE, PALE, PAPER, POSITIVE, SERIES, mixed, styled
from relforest.reports.text_size import drawable, line_height, wrapped
from relforest.rl.experience import Experience
from relforest.rl.fitted.influence import Influence, influences
from relforest.rl.fitted.standing import in_words, is_number, unit_of, witnesses
from relforest.rl.fitted.sum import Sum
from relforest.rl.fitted.value import QValue
from relforest.scenes import Attribute, Scenes, Schema
from relforest.scenes.arrays import FloatArray
from relforest.support.errors import InputError

MOST_DRAWN: Final = 6
"""Conditions in a picture."""

_COLUMNS: Final = 2
_CELL: Final = 5.4
_SIDE: Final = 2.3
_GAP: Final = 0.75
_MARGIN: Final = 0.25
_TEXT: Final = 8.0
_LINES: Final = 4
_HEAD: Final = 0.75
_SIGNS: Final = "Star: the scene on the left; dots: other actions that were taken"
_OF_SUMS: Final = (
    "Colors, line: what its curve adds (blue) or takes (orange) if the ringed object is there; "
    f"inside the dark line the condition is true.\n{_SIGNS}, with what trees add."
)
_GRID: Final = 120
_MOST_POINTS: Final = 400
# Of the distances, the scene that is drawn is at this quantile: it is nearly so.
_SHOWN: Final = 0.2
_ADDED: Final = LinearSegmentedColormap.from_list(
    "added",
    [mixed(NEGATIVE, 0.75), mixed(NEGATIVE, 0.3), to_rgb(PAPER), mixed(POSITIVE, 0.3), mixed(POSITIVE, 0.75)],
)


def policy_figure(
    value: QValue, experience: Experience, *, most: int = MOST_DRAWN, title: str = ""
) -> Figure:
    """Draw the conditions that matter most, each over a scene and beside what it adds.

    The scene is one of those in which the condition is nearly true: arguments have their names, and the
    objects that come nearest to satisfying it are ringed. Where the value is a sum of curves, the colors show
    what would be added if the last of these objects were there; inside the dark line the condition is true.
    The points beside it are actions of the experience.

    Parameters
    ----------
    value : QValue
    experience : Experience
        What was experienced in the world that it was learned in.
    most : int
        Number of conditions.
    title : str

    Raises
    ------
    InputError
        If no condition adds anything.
    """
    found = influences(value, experience, most)
    if not found:
        raise InputError("this policy has no conditions yet: no action seems better than another one")
    told = [_lines(value, each, rank) for rank, each in enumerate(found, start=1)]
    text = max(map(len, told)) * line_height(_TEXT) + 0.05
    rows, cell = math.ceil(len(found) / _COLUMNS), text + _SIDE + _GAP
    width, height = _COLUMNS * _CELL + _MARGIN, _HEAD + rows * cell
    legend = _OF_SUMS if isinstance(value.learned, Sum) else f"{_SIGNS}."
    with styled():
        figure = Figure(figsize=(width, height))
        figure.text(_MARGIN / width, 1.0 - 0.12 / height, title, va="top", weight="bold", parse_math=False)
        figure.text(_MARGIN / width, 1.0 - 0.34 / height, legend, va="top", fontsize=_TEXT, color=GREY)
        for place, (each, lines) in enumerate(zip(found, told, strict=True)):
            left, top = _MARGIN + place % _COLUMNS * _CELL, _HEAD + place // _COLUMNS * cell
            for number, line in enumerate(lines):
                y = 1.0 - (top + number * line_height(_TEXT)) / height
                figure.text(left / width, y, line, va="top", fontsize=_TEXT, parse_math=False)
            _draw(figure, (left, top + text + _SIDE), value, each)
    return figure


def _lines(value: QValue, each: Influence, rank: int) -> list[str]:
    """Return the condition in words, broken into lines."""
    action, (words, _) = (
        value.action_types[each.number].name,
        in_words(each.condition, each.scenes.schema, 0.0, 0.0),
    )
    more = f" ({len(each.questions)} questions)" if len(each.questions) > 1 else ""
    lines = wrapped(f"{rank}. {action}: {words}{more}", _CELL - 0.3, _TEXT)
    return lines if len(lines) <= _LINES else [*lines[: _LINES - 1], f"{lines[_LINES - 1]}…"]


def _draw(figure: Figure, corner: tuple[float, float], value: QValue, each: Influence) -> None:
    """Draw a condition over a scene and what it adds, above the lower left corner of its place (inches)."""
    (left, bottom), (width, height) = corner, figure.get_size_inches().tolist()
    finite = np.flatnonzero(np.isfinite(each.margins))
    row = int(finite[np.argsort(each.margins[finite])[int(_SHOWN * len(finite))]]) if len(finite) else 0
    location = next((one for one in value.view.attributes if one.role == "location" and one.dim <= 2), None)
    first, low = left + 0.4, 1.0 - bottom / height
    if location is not None:
        axes = figure.add_axes((left / width, low, _SIDE / width, _SIDE / height))
        _draw_scene(axes, value, each, each.scenes.take([row]), location)
        first = left + _SIDE + 0.55
    axes = figure.add_axes((first / width, low, (left + _CELL - 0.2 - first) / width, _SIDE / height))
    _draw_adds(axes, each, row)


def _draw_adds(axes: Axes, each: Influence, row: int) -> None:
    """Draw what is added over the distance from satisfying the condition, and where the drawn scene is."""
    scale, unit = unit_of(each.condition)
    margins = scale * each.margins
    some = np.unique(np.linspace(0, len(margins) - 1, _MOST_POINTS).astype(np.int64))
    axes.scatter(margins[some], each.adds[some], s=6, color=GREY, alpha=0.35, linewidths=0, zorder=2)
    axes.axhline(0.0, color=PALE, linewidth=0.8, zorder=0)
    if len(each.questions) == 1:
        (question,) = each.questions
        knots, heights = scale * np.array(question.knots), np.array(question.heights) - question.usual
        axes.plot(knots, heights, color=INK, marker="o", markersize=3, zorder=3)
    axes.plot(margins[row], each.adds[row], marker="*", ms=13, color=PAPER, mec=INK, mew=1.2, zorder=4)
    finite = margins[np.isfinite(margins)]
    if len(finite):
        low, high = np.quantile(finite, [0.01, 0.99]).tolist()
        low, high = min(low, margins[row]), max(high, margins[row])
        room = 0.06 * (high - low) or 0.5
        axes.set_xlim(low - room, high + room)
    what = "how far from true" if not is_number(each.condition) else "that number"
    if not is_number(each.condition):
        axes.axvline(0.0, color=GREY, linewidth=0.8, linestyle=":", zorder=1)
    axes.set_xlabel(f"{what}{f', {unit}' if unit else ''}", labelpad=2.0, fontsize=_TEXT)
    axes.set_ylabel("adds to the value", labelpad=1.0, fontsize=_TEXT)
    axes.tick_params(labelsize=7.5, length=2.5, pad=1.5)


def _draw_scene(axes: Axes, value: QValue, each: Influence, scene: Scenes, location: Attribute) -> None:
    """Draw the objects of a scene, and where the last one that is asked about would count."""
    columns = scene.schema.columns(location.name)
    rows = scene.objects(0)
    every = each.scenes.matrix[each.scenes.rows][:, columns]
    low, high = np.nanquantile(every, [0.005, 0.995], axis=0)
    here = scene.matrix[rows][:, columns]
    low, high = np.nanmin([low, *here], axis=0), np.nanmax([high, *here], axis=0)
    room = 0.08 * (high - low).max() or 0.5
    window = _flat(np.stack([low - room, high + room]))
    if location.dim == 1:
        window[:, 1] = 0.5 * (window[1, 0] - window[0, 0]) * np.array([-1.0, 1.0])
    arguments, nearest = scene.arguments[0].tolist(), witnesses(each.condition, scene)
    chosen = np.array([*arguments, *nearest], dtype=np.int64)
    if len(nearest) == each.condition.n_free and (chosen >= 0).all():
        _draw_map(axes, each, scene, location, chosen, window)
    at = _flat(scene.matrix[:, columns])
    for row in rows.tolist():
        axes.scatter(
            at[row, 0],
            at[row, 1],
            s=42,
            color=[_color(value, scene.schema, scene.matrix[row])],
            edgecolors=INK,
            linewidths=0.8,
            zorder=4,
        )
    if len(arguments) == 2 and min(arguments) >= 0:
        axes.plot(*at[arguments].T, color=INK, linewidth=0.7, linestyle="--", zorder=3)
    names = [*scene.schema.parameters, *([""] if each.condition.n_free == 1 else "CD")]
    for name, row in zip(names, chosen.tolist(), strict=False):
        if row < 0:
            continue
        if row in nearest:
            axes.scatter(
                at[row, 0], at[row, 1], s=150, facecolors="none", edgecolors=INK, linewidths=1.6, zorder=5
            )
        share = (at[row, 0] - window[0, 0]) / (window[1, 0] - window[0, 0])
        side = "left" if share < 0.2 else "right" if share > 0.8 else "center"
        box = {"facecolor": PAPER, "alpha": 0.6, "edgecolor": "none", "pad": 0.8}
        style: dict[str, Any] = {"ha": side, "fontsize": 7.5, "zorder": 6, "parse_math": False, "bbox": box}
        if name:
            axes.annotate(drawable(name), at[row], (0, 8), textcoords="offset points", **style)
    axes.set_xlim(*window[:, 0])
    axes.set_ylim(*window[:, 1])
    axes.set_aspect("equal", anchor="N")
    axes.set_xticks([])
    axes.set_yticks([])
    for spine in axes.spines.values():
        spine.set(visible=True, color=PALE)


def _draw_map(
    axes: Axes,
    each: Influence,
    scene: Scenes,
    location: Attribute,
    chosen: NDArray[np.int64],
    window: FloatArray,
) -> None:
    """Color the plane by what would be added, and draw the line within which the condition is true."""
    asked = [one for one in each.condition.statements if one.mapping.attribute.name == location.name]
    if not asked:
        return
    moving = max(max(one.variables) for one in asked)
    x, y = np.linspace(window[0], window[1], _GRID).T
    points = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)[:, : location.dim]
    n = len(scene.matrix)
    moved = np.repeat(scene.matrix[chosen[moving]][None], len(points), axis=0)
    moved[:, scene.schema.columns(location.name)] = points
    choices = np.repeat(chosen[None], len(points), axis=0)
    choices[:, moving] = n + np.arange(len(points))
    margins, adds = each.of_choices(scene, np.vstack([scene.matrix, moved]), choices)
    most = float(np.abs(adds).max()) or 1.0
    extent = (*window[:, 0].tolist(), *window[:, 1].tolist())
    shape: dict[str, Any] = {
        "extent": extent,
        "origin": "lower",
        "aspect": "auto",
        "interpolation": "bilinear",
    }
    axes.imshow(adds.reshape(_GRID, _GRID), cmap=_ADDED, vmin=-most, vmax=most, zorder=0, **shape)
    levels = np.nan_to_num(margins, nan=1e9).reshape(_GRID, _GRID)
    if levels.min() < 0.0 < levels.max():
        axes.contour(x, y, levels, levels=[0.0], colors=[INK], linewidths=1.1, zorder=2)


def _flat(places: FloatArray) -> FloatArray:
    """Return places (n, 1 or 2) in the plane, (n, 2)."""
    return places if places.shape[1] == 2 else np.column_stack([places, np.zeros(len(places))])


def _color(value: QValue, schema: Schema, row: FloatArray) -> Any:  # noqa: ANN401 - any of Matplotlib's
    """Return the color of an object: its own if it has one, or that of its first category."""
    known = dict(value.view.values)
    for seen, attribute in zip(schema.attributes, value.view.world.attributes, strict=True):
        own = row[schema.columns(seen.name)]
        if np.isnan(own).any():
            continue
        if attribute.role == "color" and attribute.dim == 3:
            rgb = known[attribute.name][int(own[0])] if attribute.name in known else own
            if (rgb >= 0.0).all() and (rgb <= 1.0).all():
                return tuple(rgb.tolist())
        if seen.kind == "category":
            return SERIES[int(own[0]) % len(SERIES)]
    return GREY
