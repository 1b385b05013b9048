"""Values as notebooks show them: drawn, with sentences and counts, without a script.

The pictures are on white paper, also in dark notebooks; see `relforest.support.notebook`.
"""

from __future__ import annotations

from collections.abc import Callable
from html import escape
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from matplotlib.figure import Figure

from relforest.forests import Ensemble
from relforest.forests.descriptions import strongest_questions
from relforest.mappings import Mapping
from relforest.reports.figure_files import svg_text
from relforest.reports.question_panel import volume_table
from relforest.reports.style import BLUE, GREY, INK, PALE, PAPER, SERIES, styled
from relforest.reports.tree_figure import tree_figure
from relforest.reports.volume_panel import draw_volume
from relforest.scenes import Attribute, Scenes, Schema
from relforest.scenes.ids import plain
from relforest.support.numerals import number
from relforest.trees import Tree
from relforest.trees.nodes import counted
from relforest.volumes import Aggregation, Arc, Volume

if TYPE_CHECKING:
    from relforest.rl import Evaluation

MOST_NODES: Final = 60
"""Trees with more nodes are told in words, and not drawn."""
_MOST_SCENES: Final = 6
_SIDE: Final = 150.0


def as_html(value: object) -> str:
    """Return a value as HTML; an unknown one as its text."""
    drawing = _DRAWINGS.get(type(value).__name__)
    return _text(repr(value)) if drawing is None else drawing(value)


def _scenes(scenes: Scenes) -> str:
    shown = "".join(_scene(each, _window(scenes)) for each in scenes[:_MOST_SCENES])
    more = len(scenes) - _MOST_SCENES
    rest = f"<p>and {counted(more, 'more scene')}</p>" if more > 0 else ""
    kinds = _table(
        ["attribute", "kind", "defined"],
        [
            [
                attribute.name,
                ", ".join(attribute.categories)
                or (
                    f"{attribute.dim} numbers"
                    if attribute.dim > 1
                    else attribute.kind.replace("euclidean", "number")
                ),
                f"{_defined(scenes, attribute):.0%}",
            ]
            for attribute in scenes.schema.attributes
        ],
    )
    return f"<div><p>{escape(repr(scenes))}</p>{shown}{rest}{kinds}</div>"


def _defined(scenes: Scenes, attribute: Attribute) -> float:
    values = scenes.values[attribute.name]
    return float((~np.isnan(values).any(axis=1)).mean()) if len(values) else 0.0


def _plane(schema: Schema) -> list[int]:
    """Return up to two columns to be drawn: those of a location, or else the first numbers."""
    numbers = [each for each in schema.attributes if each.kind == "euclidean"]
    chosen = sorted(numbers, key=lambda each: each.role != "location")
    return [at for each in chosen for at in range(schema.offset(each.name), schema.columns(each.name).stop)][
        :2
    ]


def _window(scenes: Scenes) -> np.ndarray[Any, np.dtype[np.float64]]:
    """Return the low and high ends (2, n) of the columns that are drawn, with equal scales."""
    values = scenes.matrix[:, _plane(scenes.schema)]
    known = values[~np.isnan(values).any(axis=1)] if values.size else np.zeros((1, values.shape[1]))
    known = known if len(known) else np.zeros((1, values.shape[1]))
    low, high = known.min(axis=0), known.max(axis=0)
    half = 0.55 * max(float((high - low).max(initial=0.0)), 1e-9)
    return np.stack([(low + high) / 2 - half, (low + high) / 2 + half])


def _scene(scene: Scenes, window: np.ndarray[Any, np.dtype[np.float64]]) -> str:
    """Return a small picture of a scene: objects by place, colored by category, and arguments by name."""
    schema, marks = scene.schema, []
    teams = [schema.offset(each.name) for each in schema.attributes if each.kind == "category"]
    bound = dict(zip(scene.arguments[0].tolist(), schema.parameters, strict=True))
    for row in scene.objects(0).tolist():
        places = (scene.matrix[row, _plane(schema)] - window[0]) / (window[1] - window[0]) * _SIDE
        if np.isnan(places).any():
            continue
        x, y = [*places.tolist(), _SIDE / 2, _SIDE / 2][:2]
        team = scene.matrix[row, teams[0]] if teams else np.nan
        fill = GREY if np.isnan(team) else SERIES[int(team) % len(SERIES)]
        name = escape(str(plain(scene.object_ids[row])))
        marks.append(
            f'<circle cx="{x:.1f}" cy="{_SIDE - y:.1f}" r="{6 if row in bound else 4}" fill="{fill}" '
            f'stroke="{INK}"><title>{name}</title></circle>'
        )
        if row in bound:
            end = "start" if x < _SIDE / 2 else "end"
            marks.append(
                f'<text x="{x:.1f}" y="{_SIDE - y - 8:.1f}" text-anchor="{end}">{escape(bound[row])}</text>'
            )
    title = escape(f"scene {plain(scene.scene_ids[0])}: {counted(int(scene.counts[0]), 'object')}")
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{_SIDE:.0f}" height="{_SIDE + 16:.0f}" '
        f'viewBox="0 -16 {_SIDE:.0f} {_SIDE + 16:.0f}" font-family="sans-serif" font-size="10" role="img" '
        f'aria-label="{title}" style="margin: 2px; border: 1px solid {PALE}">'
        f'<rect y="-16" width="100%" height="100%" fill="{PAPER}"/>'
        f'<text x="2" y="-5" fill="{GREY}">{title}</text>{"".join(marks)}</svg>'
    )


def _tree(tree: Tree) -> str:
    picture = svg_text(tree_figure(tree)) if len(tree.nodes) <= MOST_NODES else ""
    return f"<div>{picture}{_text(str(tree), summary='in words' if picture else '')}</div>"


def _ensemble(ensemble: Ensemble) -> str:
    found = strongest_questions(ensemble)
    head = f"{counted(len(ensemble.trees), 'tree')} with {counted(len(found), 'question')}"
    bar = '<svg width="80" height="10" role="img"><rect width="{:.1f}" height="10" fill="{}"/></svg>'
    rows = [
        [
            bar.format(80.0 * each.share / (found[0].share or 1.0), BLUE),
            f"{each.share:.1%}",
            f"{each.yes:+.3f}",
            f"{each.no:+.3f}",
            escape(each.said),
        ]
        for each in found[: _MOST_SCENES * 2]
    ]
    columns = ["", "share of the gain", "a yes adds", "a no adds", "question"]
    return f"<div><p>{head}; those that gain most:</p>{_table(columns, rows, is_html=True)}</div>"


def _volume(volume: Volume) -> str:
    kind = "angle" if isinstance(volume, Arc) else "euclidean"
    with styled():
        figure = Figure(figsize=(2.8, 2.2), layout="constrained")
        draw_volume(figure.subplots(), Mapping("identity", Attribute("component", volume.dim, kind)), volume)
        picture = svg_text(figure)
    table = _table(["", type(volume).__name__], [list(row) for row in volume_table(volume)])
    return f"<div>{picture}{table}</div>"


def _aggregation(found: Aggregation) -> str:
    told = f"score {number(found.score)}, the best of {counted(found.n_models, 'volume')} that were tried"
    return f"<div><p>{told}</p>{_volume(found.volume)}</div>"


def _evaluation(played: Evaluation) -> str:
    rewards = played.rewards
    with styled():
        figure = Figure(figsize=(4.0, 1.8), layout="constrained")
        axes = figure.subplots()
        axes.hist(rewards, bins=min(20, max(len(rewards), 1)), color=BLUE)
        axes.set_xlabel("total reward of an episode")
        axes.set_ylabel("episodes")
        picture = svg_text(figure)
    rows = [
        [
            name,
            f"{number(float(values.mean()))}",
            f"{number(float(values.std()))}",
            number(values.min()),
            number(values.max()),
        ]
        for name, values in (("reward", rewards), ("duration", played.durations))
        if len(values)
    ]
    columns = ["", "mean", "standard deviation", "least", "most"]
    return f"<div><p>{counted(len(rewards), 'episode')}</p>{picture}{_table(columns, rows)}</div>"


def _table(columns: list[str], rows: list[list[str]], *, is_html: bool = False) -> str:
    def line(cells: list[str], tag: str) -> str:
        open_tag = f'<{tag} style="text-align: left">'
        return f"<tr>{''.join(f'{open_tag}{cell}</{tag}>' for cell in cells)}</tr>"

    body = "".join(line(row if is_html else [escape(cell) for cell in row], "td") for row in rows)
    return f"<table><thead>{line(columns, 'th')}</thead><tbody>{body}</tbody></table>"


def _text(text: str, summary: str = "") -> str:
    told = f'<pre style="white-space: pre-wrap">{escape(text)}</pre>'
    return f"<details><summary>{summary}</summary>{told}</details>" if summary else told


# By name, so that values of layers that are slow to load need not be loaded.
_DRAWINGS: Final[MappingProxyType[str, Callable[[Any], str]]] = MappingProxyType(
    {
        "Aggregation": _aggregation,
        "Arc": _volume,
        "Ellipsoid": _volume,
        "Ensemble": _ensemble,
        "Evaluation": _evaluation,
        "Scenes": _scenes,
        "Slab": _volume,
        "Tree": _tree,
    }
)
