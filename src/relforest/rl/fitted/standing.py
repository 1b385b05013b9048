"""How a scene stands to a condition: which objects come nearest to satisfying it, and how near, in words."""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from relforest.forests.bindings import bindings
from relforest.forests.conditions import Condition
from relforest.forests.packing import pack_conditions
from relforest.forests.statements import Bound, Is
from relforest.forests.words import sentence
from relforest.rl.fitted.questions import measured_rows
from relforest.scenes import Scenes, Schema
from relforest.scenes.arrays import FloatArray, IntArray
from relforest.support.numerals import number

_ALL: Final = 10**9


def margins_of_choices(
    condition: Condition, schema: Schema, matrix: FloatArray, choices: IntArray
) -> FloatArray:
    """Return how far choices of objects are from satisfying a condition, (n,), NaN where one is impossible.

    Parameters
    ----------
    condition : Condition
    schema : Schema
        Of the scenes that the condition is about.
    matrix : (r, schema.width) float64
        Objects.
    choices : (n, n_parameters + n_free) int64
        Rows of the matrix: the arguments, then an object for each free variable.
    """
    # An object that is given is an argument.
    names = [f"free object {place}" for place in range(condition.n_free)]
    given = Schema(schema.attributes, (*schema.parameters, *names))
    packed = pack_conditions(given, [Condition(0, condition.statements)])
    nothing = np.zeros(len(choices), dtype=np.int64)
    return measured_rows(packed, matrix, (nothing[:0], nothing, nothing, choices)).margins[:, 0]


def witnesses(condition: Condition, scene: Scenes) -> tuple[int, ...]:
    """Return the rows of the free objects that come nearest to satisfying a condition in a single scene.

    Without free variables, or if no objects can satisfy it, there are none.
    """
    n_free = condition.n_free
    choices = bindings(scene, n_free, most=_ALL, rng=np.random.default_rng(0))[0].rows
    margins = margins_of_choices(condition, scene.schema, scene.matrix, choices)
    if n_free == 0 or np.isnan(margins).all():
        return ()
    return tuple(choices[int(np.nanargmin(margins)), -n_free:].tolist())


def unit_of(condition: Condition) -> tuple[float, str]:
    """Return what distances from satisfying a condition are multiplied by to be told, and their unit.

    They have the unit of what the condition compares; only angles that its sentence tells in degrees differ.
    """
    numbers = [each for each in condition.statements if not isinstance(each.test, Is)]
    if numbers and all(each.mapping.operation == "bearing" for each in numbers):
        return math.degrees(1.0), "degrees"
    return 1.0, ""


def in_words(condition: Condition, schema: Schema, margin: float, count: float) -> tuple[str, str]:
    """Return a condition as a sentence, and how far a scene is from satisfying it, or how many choices do.

    Examples
    --------
    >>> from relforest import Attribute, Schema
    >>> from relforest.forests.statements import Bound, Near, Statement
    >>> from relforest.mappings import Mapping
    >>> place = Attribute("location", 2, operations=["bearing", "identity"])
    >>> schema = Schema([place], ["start", "end"])
    >>> beside = Condition(1, (Statement(Mapping("bearing", place), (0, 1, 2), Near(0, (0.1,), (0.05,))),))
    >>> in_words(beside, schema, 0.25, 0)  # doctest: +NORMALIZE_WHITESPACE
    ('some object is seen from the start between 2.86 and 8.59 degrees away from the end',
    'off by 14.3 degrees')
    >>> height = Condition(0, (Statement(Mapping("identity", place), (0,), Bound(1, "at most", 0.0)),))
    >>> in_words(height, schema, 3.5, 0)
    ('the start has y', '3.5')
    """
    said = sentence(condition, schema)
    if math.isnan(margin):
        return said, "cannot be said" if condition.n_free == 0 else "no such object"
    if is_number(condition) and " at most 0" in said:
        return said.replace(" at most 0", "", 1), number(margin)
    if margin <= 0.0:
        return said, f"true of {count:.0f}" if count > 1 else "true"
    if all(isinstance(each.test, Is) for each in condition.statements):
        return said, "not true"
    scale, unit = unit_of(condition)
    return said, " ".join(filter(None, ("off by", number(scale * margin), unit)))


def is_number(condition: Condition) -> bool:
    """Return whether a condition stands for a number of the arguments, by which it fails."""
    test = condition.statements[0].test
    return condition.n_free == 0 and isinstance(test, Bound) and test == Bound(test.component, "at most", 0.0)
