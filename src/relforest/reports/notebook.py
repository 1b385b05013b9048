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
from relforest.playing.svg import svg
from relforest.reports.figure_files import svg_text
from relforest.reports.question_panel import volume_table
from relforest.reports.scene_picture import frame_of, stage_of, window_of
from relforest.reports.style import BLUE, GREY, PALE, PAPER, styled
from relforest.reports.tree_figure import tree_figure
from relforest.reports.volume_panel import draw_volume
from relforest.scenes import Attribute, Scenes
from relforest.scenes.arrays import FloatArray
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
_SIDE: Final = 320


def as_html(value: object) -> str:
    """Return a value as HTML; an unknown one as its text."""
    drawing = _DRAWINGS.get(type(value).__name__)
    return _text(repr(value)) if drawing is None else drawing(value)


def _scenes(scenes: Scenes) -> str:
    window = window_of(scenes)
    shown = "".join(_scene(each, window) for each in scenes[:_MOST_SCENES])
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


def _scene(scene: Scenes, window: FloatArray) -> str:
    """Return a small picture of a scene below its name."""
    title = escape(f"scene {plain(scene.scene_ids[0])}: {counted(int(scene.counts[0]), 'object')}")
    stage = stage_of(scene, window, pixels=_SIDE)
    style = f"display: inline-block; width: {_SIDE}px; margin: 2px; border: 1px solid {PALE}"
    paper = f"background: {PAPER}; color: {GREY}; font-family: sans-serif"
    drawn = svg(stage, frame_of(scene, window), label=title, on_paper=True)
    return f'<figure style="{style}; {paper}"><figcaption>{title}</figcaption>{drawn}</figure>'


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
