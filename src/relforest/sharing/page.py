"""A page in which the objects of a scene can be moved, while a model says what it predicts, and why."""

from __future__ import annotations

import html
import json
from typing import Any, Final

import numpy as np

from relforest.forests.statements import Bound, Is, Near
from relforest.playing.document import asset, embedded, filled
from relforest.reports.scene_picture import plane_of
from relforest.scenes import Scenes, Schema
from relforest.scenes.ids import plain
from relforest.sharing.measures import Notation, Written, letter
from relforest.sharing.program import Branch, Measure, Program, Rule, Step, Walk
from relforest.sharing.rule_text import steps_along_no, written_measures
from relforest.support.errors import InputError
from relforest.volumes import Arc

_PACKAGE: Final = "relforest.sharing"
_NOTATION: Final = Notation(
    column=lambda variable, column: f"{variable}[{column}]",
    sqrt="Math.sqrt({})",
    absolute="Math.abs({})",
    atan2="Math.atan2({}, {})",
    where="({0} > 0.0 ? {1} : NaN)",
    undefined="Number.isNaN({})",
)
MOST_BYTES: Final = 1_000_000
"""Largest size of a page."""


def play_page(program: Program, scene: Scenes, *, title: str = "") -> str:
    """Return a page that shows a scene, whose objects can be moved, and what the model says about it.

    Parameters
    ----------
    program : Program
    scene : Scenes
        A single scene of the schema of the program; the objects of other scenes in its matrix say how far
        the picture reaches.
    title : str
        Name of the page. Default: the id of the scene.

    Returns
    -------
    str
        HTML with style, script, model and scene included; it can be opened from disk.

    Raises
    ------
    InputError
        If there is not exactly one scene, or the page would be larger than `MOST_BYTES`.
    """
    if len(scene) != 1:
        raise InputError(
            f"a page shows a single scene, got {len(scene)}: select it with scenes.take([position])"
        )
    scene = scene.recoded(program.schema)
    title = title or f"Scene {plain(scene.scene_ids[0])}"
    x, y = [*plane_of(program.schema), -1, -1][:2]
    heading = [each.name for each in program.schema.attributes if each.kind == "angle"]
    team = [each.name for each in program.schema.attributes if each.kind == "category"]
    data = scene_document(scene) | {
        "title": title,
        "x": x,
        "y": y,
        "heading": program.schema.offset(heading[0]) if heading else -1,
        "color": program.schema.offset(team[0]) if team else -1,
        "view": _view(scene, x, y),
    }
    parts = {
        "title": html.escape(title),
        "style": asset(_PACKAGE, "play.css"),
        "script": f"{evaluation_script(program)}\n{asset(_PACKAGE, 'play.js')}",
        "data": embedded(data),
    }
    page = filled(asset(_PACKAGE, "play.html"), parts)
    if len(page.encode()) > MOST_BYTES:
        raise InputError(
            f"the page would take {len(page.encode()):,} bytes, more than {MOST_BYTES:,}: "
            "the model is too large to play with, so fit fewer or smaller trees"
        )
    return page


def evaluation_script(program: Program) -> str:
    """Return JavaScript with `evaluate(objects, arguments)` and the `model` that it evaluates.

    It returns the leaf and the path in every tree, the scores and the probabilities of the classes.
    """
    written = written_measures(program, _NOTATION)
    functions = [_function(measure, text) for measure, text in zip(program.measures, written, strict=True)]
    rules: list[Rule] = []
    trees = [
        _walk_document(step, walks) if walks else _step_document(step, rules)
        for step, walks in zip(program.trees, program.walks, strict=True)
    ]
    attributes = [attribute for attribute in program.schema.attributes for _ in range(attribute.dim)]
    names = [name for _, own in program.layout.attributes for name in own]
    model = {
        "outcome": program.outcome,
        "link": program.link,
        "classes": [str(label) for label in program.classes],
        "threshold": program.threshold,
        "start": program.start.tolist(),
        "values": [values.tolist() for values in program.values],
        "says": program.says,
        "parameters": program.schema.parameters,
        "columns": [
            {"name": name, "kind": attribute.kind, "categories": attribute.categories}
            for name, attribute in zip(names, attributes, strict=True)
        ],
        "measures": [_measure_document(*each) for each in zip(program.measures, written, strict=True)],
        "rules": [_rule_document(program.schema, rule) for rule in rules],
        "trees": trees,
    }
    return "\n".join(
        [
            asset(_PACKAGE, "evaluate.js"),
            "const measures = [",
            *functions,
            "];",
            f"const model = {embedded(model)};",
            "const evaluate = evaluator(model, measures);",
        ]
    )


def scene_document(scene: Scenes) -> dict[str, Any]:
    """Return the objects of a single scene as plain values, None = undefined, and where its arguments are."""
    rows = scene.objects(0).tolist()
    return {
        "ids": [str(plain(scene.object_ids[row])) for row in rows],
        "objects": [
            [None if np.isnan(value) else value for value in scene.matrix[row].tolist()] for row in rows
        ],
        "arguments": [rows.index(row) if row >= 0 else -1 for row in scene.arguments[0].tolist()],
    }


def _function(measure: Measure, written: Written) -> str:
    names = ", ".join(map(letter, measure.variables))
    parts = "".join(f"const {name} = {expression}; " for name, expression in written.names)
    return f"({names}) => {{ {parts}return {written.value}; }},"


def _measure_document(measure: Measure, written: Written) -> dict[str, Any]:
    form = measure.form
    document: dict[str, Any] = {
        "variables": measure.variables,
        "comparison": written.comparison,
        "limit": json.loads(written.limit.strip("()")),
    }
    if isinstance(form, (Bound, Near, Is)):
        return document
    if isinstance(form, Arc):
        return document | {"sharpness": form.kappa, "circular": True}
    return document | {"sharpness": form.density_sharpness, "circular": False}


def _walk_document(first: Step, walks: tuple[Walk, ...]) -> dict[str, Any]:
    """Return the nodes of a SMRF tree, and what each leaf asks for."""
    leaves = {step.yes: step.rule.asked for step in steps_along_no(first) if isinstance(step, Branch)}
    asked = [[each._asdict() for each in leaves[leaf]] for leaf in sorted(leaves)]  # type: ignore[type-var]
    return {"nodes": [walk._asdict() for walk in walks], "asked": asked}


def _step_document(first: Step, rules: list[Rule]) -> Any:  # noqa: ANN401 - nested lists
    """Return a leaf, or pairs of a rule's number and the step if it holds, and a last step."""
    if not isinstance(first, Branch):
        return first
    options: list[Any] = []
    for step in steps_along_no(first):
        if isinstance(step, Branch):
            rules.append(step.rule)
            options.append([len(rules) - 1, _step_document(step.yes, rules)])
        else:
            options.append(step)
    return options


def _rule_document(schema: Schema, rule: Rule) -> dict[str, Any]:
    return {
        "free": rule.n_free,
        "said": rule.said,
        "atLeast": rule.at_least,
        "every": rule.every,
        "names": [*schema.parameters, *("CD"[: rule.n_free])],
        "asked": [{"measure": asked.measure} for asked in rule.asked],
    }


def _view(scene: Scenes, x: int, y: int) -> list[float]:
    """Return left, right, low and high of the picture."""
    view = []
    for column in (x, y):
        values = scene.matrix[:, column] if column >= 0 else np.empty(0)
        values = values[~np.isnan(values)]
        low, high = (float(values.min()), float(values.max())) if len(values) else (0.0, 1.0)
        room = 0.08 * (high - low) or 0.5
        view += [low - room, high + room]
    return view
