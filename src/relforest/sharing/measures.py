"""What is measured on objects, as arithmetic that Python, JavaScript and SQL write almost alike.

Every operation is done as the kernels do it, in the same order, so that the numbers are the same to the last
bit. What is undefined is NaN (in SQL, NULL), of which no comparison is true.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple, final

import numpy as np

from relforest.forests.statements import Bound, Is, Near
from relforest.mappings import Mapping
from relforest.scenes import Schema
from relforest.sharing.program import Asked, Measure
from relforest.trees.nodes import variable_name
from relforest.volumes import Arc


@final
@dataclass(frozen=True, slots=True)
class Notation:
    """How a language writes what all of them compute."""

    column: Callable[[str, int], str]
    """Writes a value of an object from the name of its variable and the number of the column."""
    sqrt: str
    absolute: str
    atan2: str
    """These three are functions, to be filled with their arguments."""
    where: str  # the second argument where the first is positive, else undefined
    undefined: str  # whether the argument is undefined
    number: str = "{}"  # a number from its shortest digits
    keeps_names: bool = True  # whether parts of an expression can have names, so that they are written once


class Written(NamedTuple):
    """A measure as text: names for parts of it, in order, its value, and the comparison and limit for yes.

    `wrapped(angle)` moves an angle into [-pi, pi], `differs(x, y)` is 1 where two numbers differ, else 0.
    """

    names: tuple[tuple[str, str], ...]
    value: str
    comparison: str
    limit: str


def letter(variable: int) -> str:
    """Return the name of a variable in code."""
    return variable_name(variable).lower()


def columns_of(measure: Measure, schema: Schema) -> tuple[tuple[str, int], ...]:
    """Return variables, by letter, and columns that a measure depends on."""
    span = schema.columns(measure.mapping.attribute.name)
    return tuple((letter(each), at) for each in measure.variables for at in range(span.start, span.stop))


def write_measure(measure: Measure, schema: Schema, notation: Notation) -> Written:
    """Write a measure in a notation."""
    names: list[tuple[str, str]] = []

    def named(name: str, expression: str) -> str:
        if not notation.keeps_names:
            return f"({expression})"
        names.append((name, expression))
        return name

    def number(value: float) -> str:
        return _number(float(value), notation)

    point = _point(measure.mapping, measure.variables, schema, notation, named)
    form = measure.form
    if isinstance(form, Is):
        value = f"differs({point[0]}, {number(form.category)})"
        return Written(tuple(names), value, ">" if form.negated else "<=", number(0.5))
    if isinstance(form, Bound):
        size = notation.absolute.format(point[form.component]) if form.absolute else point[form.component]
        value, used = size, {form.component}
        comparison, limit = "<=" if form.side == "at most" else ">=", form.limit
    elif isinstance(form, (Near, Arc)):
        comparison = "<="
        if isinstance(form, Near):
            weights, limit = tuple(1.0 / radius**2 for radius in form.radii), 1.0
            first, centre = form.component, form.centre
        else:
            weights, limit, first, centre = (1.0,), form.radius * form.radius, 0, (form.mean,)
        used, terms = set(range(first, first + len(centre))), []
        for i, (middle, weight) in enumerate(zip(centre, weights, strict=True)):
            away = f"{point[first + i]} - {number(middle)}"
            away = named(f"away{i}", f"wrapped({away})" if measure.mapping.space == "circle" else away)
            terms.append(f"{number(weight)} * {away} * {away}")
        value = " + ".join(terms)
    else:
        comparison, limit = "<=", form.radius * form.radius
        aways = [
            named(f"away{i}", f"{x} - {number(m)}")
            for i, (x, m) in enumerate(zip(point, form.mean, strict=True))
        ]
        rows = [
            [f"{number(p)} * {away}" for p, away in zip(row, aways, strict=True)] for row in form.precision
        ]
        value = " + ".join(f"({' + '.join(row)}) * {away}" for row, away in zip(rows, aways, strict=True))
        used = set(range(len(point)))
    # A point is undefined if any of its components is: 0 times an undefined number says so.
    others = [x for i, x in enumerate(point) if i not in used]
    value = " + ".join([value, *(f"{number(0.0)} * {x}" for x in others)])
    return Written(tuple(names), value, comparison, number(limit))


def write_answer(asked: Asked, value: str, written: Written, notation: Notation) -> str:
    """Write that a measure whose value is written as `value` gets the answer of a rule."""
    if asked.answer == "error":
        return notation.undefined.format(value)
    opposite = {"<=": ">", ">=": "<", ">": "<="}[written.comparison]
    return f"{value} {written.comparison if asked.answer == 'yes' else opposite} {written.limit}"


def _point(
    mapping: Mapping,
    variables: tuple[int, ...],
    schema: Schema,
    notation: Notation,
    named: Callable[[str, str], str],
) -> list[str]:
    """Return the components of the value of a mapping; compare `relforest.mappings.kernels.map_point`."""
    span = schema.columns(mapping.attribute.name)
    a, *others = (
        [notation.column(letter(each), column) for column in range(span.start, span.stop)]
        for each in variables
    )
    if mapping.operation == "identity":
        return a
    b = others[0]
    if mapping.operation == "same":
        return [named("same", f"1 - differs({b[0]}, {a[0]})")]
    steps = [named(f"step{i}", f"{to} - {start}") for i, (to, start) in enumerate(zip(b, a, strict=True))]
    squared = " + ".join(f"{step} * {step}" for step in steps)
    if mapping.operation == "difference":
        return [f"wrapped({steps[0]})"] if mapping.space == "circle" else steps
    if mapping.operation == "distance":
        return [named("distance", notation.sqrt.format(squared))]
    seen = [
        named(f"seen{i}", f"{to} - {start}") for i, (to, start) in enumerate(zip(others[1], a, strict=True))
    ]
    squared = named("squared", squared)
    reach = " + ".join(f"{each} * {each}" for each in seen)

    def where(positive: str, expression: str) -> str:
        return notation.where.format(positive, expression)

    if mapping.operation == "scaled_distance":
        return [named("times", where(squared, notation.sqrt.format(f"({reach}) / {squared}")))]
    scale = notation.sqrt.format(squared) if mapping.operation == "reframe" else squared
    along = f"({steps[0]} * {seen[0]} + {steps[1]} * {seen[1]}) / {scale}"
    aside = f"({steps[0]} * {seen[1]} - {steps[1]} * {seen[0]}) / {scale}"
    if mapping.operation == "bearing":
        turned = notation.atan2.format(notation.absolute.format(aside), along)
        return [named("turned", where(squared, where(reach, turned)))]
    return [named("along", where(squared, along)), named("aside", where(squared, aside))]


def _number(value: float, notation: Notation) -> str:
    # Negative numbers in parentheses: two signs in a row begin a comment in SQL.
    digits = repr(value if np.isfinite(value) else 0.0)
    text = digits if "e" in digits else notation.number.format(digits)
    return f"({text})" if text.startswith("-") else text
