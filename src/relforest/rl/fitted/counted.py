"""Random conditions on how another object lies to the arguments of an action, to be counted."""

from __future__ import annotations

from itertools import groupby
from typing import Final

import numpy as np

from relforest.forests.bindings import bindings, column_values
from relforest.forests.columns import Column, columns
from relforest.forests.conditions import Condition
from relforest.forests.statements import Bound, Is, Near, Statement, Test, is_category
from relforest.scenes import Scenes, Schema
from relforest.scenes.arrays import FloatArray

_MOST_CHOICES: Final = 1000
_MOST_SCENES: Final = 600
# Components whose sign has a meaning, and those that are never negative.
_SIGNED: Final = frozenset({"difference", "reframe", "scaled_reframe"})
_POSITIVE: Final = frozenset({"distance", "scaled_distance", "bearing"})
_N_STATEMENTS: Final = (1, 2, 2, 3)
# How often a further statement is about the free object alone.
_ALONE: Final = 0.3
# Less than this share of the spread is no difference.
_NO_DIFFERENCE: Final = 1e-3


def own_numbers(schema: Schema) -> list[Condition]:
    """Return a condition for each number of the arguments: how far it fails is that number or category."""
    found = []
    for column in columns(schema, 0):
        mapping = column.mapping
        tests: list[Test] = [Bound(column.component, "at most", 0.0)]
        if is_category(mapping):
            n_values = 2 if mapping.operation == "same" else len(mapping.attribute.categories)
            tests = [Is(category) for category in range(n_values - 1)]
        elif mapping.space == "circle":
            tests = [Near(column.component, (0.0,), (1.0,))]
        found += [Condition(0, (Statement(mapping, column.variables, test),)) for test in tests]
    return found


def counted_conditions(scenes: Scenes, n: int, rng: np.random.Generator) -> list[Condition]:
    """Return up to `n` random conditions on a free object, of one to three statements.

    They say how it lies to an argument and what it is itself, such as "near B, and small"; their limits are
    numbers of the scenes.

    Parameters
    ----------
    scenes : Scenes
        Of actions of one type.
    n : int
    rng : Generator
    """
    sample = scenes.take(np.sort(rng.permutation(len(scenes))[:_MOST_SCENES]))
    n_arguments = scenes.schema.n_parameters
    possible = columns(scenes.schema, 1)
    choices, _ = bindings(sample, 1, most=_MOST_CHOICES, rng=rng)
    if not len(choices.rows):
        return []
    values = column_values(sample, possible, choices)
    alone = _groups(possible, values, (n_arguments,))
    with_arguments = [_groups(possible, values, (first, n_arguments)) for first in range(n_arguments)]
    groups = [group for own in with_arguments for group in own] if n_arguments else alone
    if not groups:
        return []
    # Where things are decides more often than any other attribute.
    places = [group for group in groups if possible[group[0]].mapping.attribute.role == "location"] or groups
    found = []
    for _ in range(n):
        choice = int(rng.integers(values.shape[1]))
        statements = []
        for turn in range(_N_STATEMENTS[rng.integers(len(_N_STATEMENTS))]):
            among = groups if turn == 0 or rng.random() < 0.5 else places
            if turn and alone and rng.random() < _ALONE:
                among = alone
            group = among[rng.integers(len(among))]
            number = group[rng.integers(len(group))]
            column, numbers = possible[number], values[number]
            if not np.isnan(numbers[choice]):
                test = _test(column, numbers, float(numbers[choice]), rng)
                statements.append(Statement(column.mapping, column.variables, test))
        if statements:
            found.append(Condition(1, tuple(statements)))
    return found


def _groups(possible: tuple[Column, ...], values: FloatArray, variables: tuple[int, ...]) -> list[list[int]]:
    """Return the columns of these variables that vary, those of one mapping together."""
    kept = [
        number
        for number, column in enumerate(possible)
        if column.variables == variables
        and np.nanmin(values[number], initial=np.inf) < np.nanmax(values[number], initial=-np.inf)
    ]
    return [list(group) for _, group in groupby(kept, key=lambda number: possible[number].mapping)]


def _test(column: Column, numbers: FloatArray, here: float, rng: np.random.Generator) -> Test:
    """Return a random test that the number of a choice often passes."""
    mapping, component = column.mapping, column.component
    if is_category(mapping):
        return Is(int(here))
    if mapping.space == "circle":
        return Near(component, (here,), (float(rng.uniform(0.2, 1.2)),))
    is_signed = mapping.operation in _SIGNED
    if mapping.operation in _POSITIVE or (is_signed and rng.random() < 0.5):
        limit = float(np.nanquantile(np.abs(numbers), rng.uniform(0.05, 0.5)))
        return Bound(component, "at most" if rng.random() < 0.9 else "at least", limit, absolute=is_signed)
    spread = float(np.nanstd(numbers))
    if is_signed and rng.random() < 0.5:
        limit = _NO_DIFFERENCE * spread
        return (
            Bound(component, "at least", limit) if rng.random() < 0.5 else Bound(component, "at most", -limit)
        )
    radius = spread * float(np.exp(rng.uniform(np.log(0.2), np.log(1.5))))
    form = rng.random()
    if form < 0.5:
        return Near(component, (here,), (radius,))
    if form < 0.75:
        return Bound(component, "at most", here + radius)
    return Bound(component, "at least", here - radius)
