"""An explanation as a page: one HTML file that works offline."""

from __future__ import annotations

import base64
import html
import io
from typing import Final

import numpy as np
from PIL import Image

from relforest.explaining.decision_map import DecisionMap
from relforest.explaining.explanation import PredictionExplanation
from relforest.explaining.moves import check_plane, region_of
from relforest.forests.explanations import Reason
from relforest.playing.document import asset, colors, filled
from relforest.playing.frames import Stage
from relforest.playing.svg import svg
from relforest.reports.scene_picture import arrow, frame_of, stage_of

_FOR: Final = (0, 114, 178)
_AGAINST: Final = (213, 94, 0)
_LEAST: Final = 36
_MOST: Final = 150


def explanation_page(explanation: PredictionExplanation, *, title: str) -> str:
    """Return a page with the scene, what decided, and what would turn it.

    Colors behind the scene tell what would be predicted if one object were there. Whoever points at a reason
    sees the objects that it is about.

    Parameters
    ----------
    explanation : PredictionExplanation
        Of a scene in the plane.
    title : str

    Raises
    ------
    InputError
        If the scene is not in the plane.
    """
    check_plane(explanation.scene.schema)
    region = region_of(explanation.scene, explanation.region)
    stage, frame = stage_of(explanation.scene, region), frame_of(explanation.scene, region)
    if explanation.move is not None:
        move = explanation.move
        frame = frame._replace(notes=arrow(move.start, move.end, region))
    chosen = explanation.map
    picture = svg(stage, frame, label="The scene", underlay="" if chosen is None else _image(chosen, stage))
    told = "" if chosen is None else _legend(explanation, chosen)
    most = max((abs(reason.contribution) for reason in explanation.reasons), default=1.0) or 1.0
    return filled(
        asset("relforest.explaining", "page.html"),
        {
            "title": html.escape(title),
            "colors": colors(stage),
            "picture": picture,
            "legend": told,
            "headline": html.escape(explanation.headline),
            "grounds": html.escape(explanation.grounds),
            "turning": html.escape(explanation.turning),
            "unit": html.escape(explanation.unit),
            "reasons": "\n".join(_reason(explanation, each, most) for each in explanation.reasons),
        },
    )


def _reason(explanation: PredictionExplanation, reason: Reason, most: float) -> str:
    rows = explanation.rows_of(reason)
    names = ", ".join(explanation.name_of(row) for row in rows)
    more = f"and {reason.n_questions - 1} more like it" if reason.n_questions > 1 else ""
    about = f"<small>{html.escape('; '.join(filter(None, [names, more])))}</small>"
    said = reason.sentence if reason.holds else f"it is not so that {reason.sentence}"
    sign = "for" if reason.contribution >= 0.0 else "against"
    share = abs(reason.contribution) / most
    return (
        f'<li tabindex="0" class="{sign}" data-rows="{" ".join(map(str, rows))}">'
        f"<b>{reason.contribution:+.2f}</b><span>{html.escape(said)}{about}</span>"
        f'<i style="--share:{share:.3f}"></i></li>'
    ).replace("-0.00", "0.00")


def _legend(explanation: PredictionExplanation, chosen: DecisionMap) -> str:
    name = html.escape(explanation.name_of(chosen.row))
    above, below = (
        ("more", "less") if isinstance(explanation.predicted, float) else (explanation.outcome, "otherwise")
    )
    return (
        f'Behind the scene, what would be predicted if {name} stood there: <span class="key for"></span> '
        f'{html.escape(above)}, <span class="key against"></span> {html.escape(below)}.'
    )


def _image(chosen: DecisionMap, stage: Stage) -> str:
    """Return a map as an SVG image, the stronger colored the farther from the boundary."""
    above = chosen.values - chosen.boundary
    most_above, most_below = (max(float(side.max()), 1e-12) for side in (above, -above))
    strength = np.where(above >= 0.0, above / most_above, -above / most_below)
    pixels = np.empty((*above.shape, 4), dtype=np.uint8)
    pixels[..., :3] = np.where((above >= 0.0)[..., None], _FOR, _AGAINST)
    pixels[..., 3] = _LEAST + (_MOST - _LEAST) * strength
    stream = io.BytesIO()
    Image.fromarray(pixels[::-1]).save(stream, "PNG")
    data = base64.b64encode(stream.getvalue()).decode("ascii")
    left, right, low, high = stage.view
    scale = stage.pixels / max(right - left, high - low)
    # Points of the grid are the centres of pixels.
    dx, dy = (scale * float(axis[1] - axis[0]) for axis in (chosen.x, chosen.y))
    x, y = scale * (chosen.x[0] - left) - dx / 2, scale * (high - chosen.y[-1]) - dy / 2
    width, height = dx * len(chosen.x), dy * len(chosen.y)
    return (
        f'<image x="{x:.1f}" y="{y:.1f}" width="{width:.1f}" height="{height:.1f}" '
        f'preserveAspectRatio="none" href="data:image/png;base64,{data}"/>'
    )
