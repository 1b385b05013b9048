"""The tables that conditions are sought in, one for each number of free variables."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, NamedTuple, final

import numpy as np

from relforest.forests.bindings import bindings, column_values
from relforest.forests.columns import Column, columns
from relforest.forests.conditions import Condition
from relforest.forests.forms import (
    AT_LEAST,
    AT_MOST,
    CENTRE,
    FIRST,
    FORM,
    IS,
    IS_NOT,
    LARGE,
    LIMIT,
    NEAR,
    NEAR_ANGLE,
    SECOND,
    SMALL,
    WEIGHT,
)
from relforest.forests.rows import EVERY, Table, holds
from relforest.forests.statements import Bound, Is, Near, Statement, Test, is_category
from relforest.mappings import Related
from relforest.support.progress import report

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from relforest.forests.settings import GrowthSettings
    from relforest.scenes import Scenes

# Components that can have either sign with the same meaning on both sides.
_SIGNED: Final = frozenset({"difference", "reframe", "scaled_reframe"})


class ConditionTable(NamedTuple):
    """All choices of `n_free` objects in a batch of scenes, with the values of all columns."""

    n_free: int
    columns: tuple[Column, ...]
    table: Table  # the same as arrays, for kernels
    n_sampled: int  # scenes of which only a sample of the choices is kept
    related: tuple[int, ...] = ()  # those of the first categories that say that a relation holds


@final
@dataclass(frozen=True, slots=True, eq=False)
class Found:
    """A condition that a search found in one of the tables."""

    table: ConditionTable
    numbers: NDArray[np.float64]  # (n_statements, N_NUMBERS) its statements, see `relforest.forests.forms`
    at_least: int  # how many choices it asks for, or `EVERY`
    gain: float  # twice the decrease of the loss that was found with it

    @property
    def condition(self) -> Condition:
        """The condition as a value."""
        columns = [self.table.columns[int(row[FIRST])] for row in self.numbers]
        statements = tuple(
            Statement(column.mapping, column.variables, _test(row, column.component))
            for row, column in zip(self.numbers, columns, strict=True)
        )
        return Condition(self.table.n_free, statements, max(self.at_least, 1), every=self.at_least == EVERY)

    def holds(self, scenes: NDArray[np.int64]) -> NDArray[np.bool_]:
        """Return for which of the scenes (n,) of the table it holds."""
        out = np.empty(len(scenes), dtype=np.bool_)
        holds(self.table.table, scenes, self.numbers, self.at_least, out)
        return out


def condition_tables(
    scenes: Scenes, max_free: int, *, most: int, rng: np.random.Generator
) -> tuple[ConditionTable, ...]:
    """Return the tables for 0 to `max_free` free variables that have columns and choices.

    There are at most `most` choices per scene on average, see `bindings`.
    """
    tables = []
    for n_free in range(max_free + 1):
        found = columns(scenes.schema, n_free)
        if not found:
            continue
        choices, n_sampled = bindings(scenes, n_free, most=most, rng=rng)
        if len(choices.rows):
            values = column_values(scenes, found, choices)
            free = set(range(scenes.schema.n_parameters, scenes.schema.n_parameters + n_free))
            first = np.array([free <= set(column.variables) for column in found])
            table = _table(found, values, choices.starts, first)
            if table.firsts.any():
                firsts = table.categories[: table.firsts[1]].tolist()
                related = tuple(
                    number
                    for number, (form, column, value) in enumerate(firsts)
                    if isinstance(found[column].mapping, Related) and (form == IS) == (value == 1)
                )
                tables.append(ConditionTable(n_free, found, table, n_sampled, related))
    return tuple(tables)


def searched_tables(
    scenes: Scenes, settings: GrowthSettings, rng: np.random.Generator
) -> tuple[ConditionTable, ...]:
    """Return the tables that trees with these settings are grown from."""
    max_free = settings.max_free
    if max_free is None:
        max_free = 1 if scenes.schema.n_parameters else 2
    report("choices of objects listed", 0)
    return condition_tables(scenes, max_free, most=settings.max_choices, rng=rng)


def _table(
    found: tuple[Column, ...],
    values: NDArray[np.float64],
    starts: NDArray[np.int64],
    first: NDArray[np.bool_],
) -> Table:
    bounds: list[tuple[int, int]] = []
    categories: list[tuple[int, int, int]] = []
    discs: list[tuple[int, int, int]] = []
    scales = np.ones(len(found))
    for number, column in enumerate(found):
        defined = values[number][~np.isnan(values[number])]
        mapping = column.mapping
        if len(defined) == 0 or defined.min() == defined.max():
            continue
        if is_category(mapping):
            forms = (IS, IS_NOT)
            # Of two categories, being one is not being the other.
            present = np.unique(defined).astype(int).tolist()
            chosen = (
                [(IS, each) for each in present]
                if len(present) == 2
                else [(form, each) for form in forms for each in present]
            )
            categories += [(form, number, each) for form, each in chosen]
            continue
        scales[number] = defined.std()
        if mapping.space == "circle":
            discs.append((NEAR_ANGLE, number, -1))
            continue
        bounds += [(AT_MOST, number), (AT_LEAST, number)]
        if mapping.operation in _SIGNED:
            bounds += [(SMALL, number), (LARGE, number)]
        if mapping.dim == 2:
            if column.component == 0:
                discs.append((NEAR, number, number + 1))
        else:
            discs.append((NEAR, number, -1))
    possible = [
        np.array(entries, dtype=np.int64).reshape(-1, width)
        for entries, width in ((bounds, 2), (categories, 3), (discs, 3))
    ]
    firsts = np.array([np.count_nonzero(first[rows[:, 1]]) for rows in possible])
    by_rank = [rows[np.argsort(~first[rows[:, 1]], kind="stable")] for rows in possible]
    least = _least(by_rank[0][: firsts[0]], values, starts)
    order = np.argsort(least, axis=1, kind="stable")
    return Table(values, starts, by_rank[0], by_rank[1], by_rank[2], firsts, scales, least, order)


def _least(
    bounds: NDArray[np.int64], values: NDArray[np.float64], starts: NDArray[np.int64]
) -> NDArray[np.float64]:
    """Return the least value of each half-line in each scene, (n_bounds, n_scenes), infinite if none."""
    n_choices = np.diff(starts)
    some = np.flatnonzero(n_choices)
    least = np.full((len(bounds), len(n_choices)), np.inf)
    for number, (form, column) in enumerate(bounds.tolist()):
        x = np.abs(values[column]) if form in {SMALL, LARGE} else values[column]
        x = -x if form in {AT_LEAST, LARGE} else x
        least[number, some] = np.fmin.reduceat(x, starts[some])
    return np.where(np.isnan(least), np.inf, least)


def _test(row: NDArray[np.float64], component: int) -> Test:
    form, limit = int(row[FORM]), float(row[LIMIT])
    match form:
        case _ if form in {AT_MOST, SMALL}:
            return Bound(component, "at most", limit, absolute=form == SMALL)
        case _ if form in {AT_LEAST, LARGE}:
            return Bound(component, "at least", -limit, absolute=form == LARGE)
        case _ if form in {IS, IS_NOT}:
            return Is(int(row[CENTRE]), negated=form == IS_NOT)
    dim = 1 if row[SECOND] < 0 else 2
    centre = row[CENTRE : CENTRE + dim].tolist()
    radii = np.sqrt(limit / row[WEIGHT : WEIGHT + dim]).tolist()
    return Near(component, tuple(centre), tuple(radii))
