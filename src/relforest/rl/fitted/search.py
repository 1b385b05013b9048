"""Questions whose distance from being satisfied tells most about a residual."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import chain, product
from typing import Final, NamedTuple

import numpy as np

from relforest.forests.conditions import MOST_FREE, Condition
from relforest.forests.forms import IS, NEAR_ANGLE
from relforest.forests.packing import pack_conditions
from relforest.forests.statements import Bound, Is, Near, Statement, Test
from relforest.forests.tables import ConditionTable, condition_tables
from relforest.mappings.kernels import wrap_angle
from relforest.rl.experience import BoolArray
from relforest.rl.fitted.questions import Question, knots_of, measured
from relforest.rl.fitted.settings import CurveSettings
from relforest.scenes import Scenes
from relforest.scenes.arrays import FloatArray, IntArray
from relforest.support.jit import kernel

# More bound objects say less about any of them, and cost the most.
_MOST_BOUND: Final = 3
_MOST_CHOICES: Final = 1000
# What is never negative is asked from 0, so that only the nearest objects count. Among more objects there is
# more often one that is far enough away, or out of the way, but the others matter no less.
_POSITIVE: Final = frozenset({"distance", "scaled_distance", "bearing"})
_ZERO: Final = np.array([0.0, 0.0, 1.0, 0.0])
_FEW_CHOICES: Final = 10


class _Form(NamedTuple):
    """What a question may be about: a point of the bound objects, and the categories of the free ones."""

    table: ConditionTable
    disc: tuple[int, int, int]  # NEAR or NEAR_ANGLE, first and second column
    categories: tuple[tuple[int, int], ...]  # column, category

    @property
    def is_from_zero(self) -> bool:
        """Whether it asks how small something is, which is one question only."""
        return self.table.columns[self.disc[1]].mapping.operation in _POSITIVE

    def choices(self) -> tuple[IntArray, IntArray]:
        """Return the choices of objects with these categories, and where those of each scene begin."""
        values, starts = self.table.table.values, self.table.table.starts
        allowed = np.ones(values.shape[1], dtype=np.bool_)
        for column, category in self.categories:
            allowed &= values[column] == category
        rows = np.flatnonzero(allowed)
        return rows, np.searchsorted(rows, starts)

    def condition(self, ellipse: FloatArray) -> Condition:
        """Return that objects of these categories exist, with the point in an ellipse."""
        _, first, second = self.disc
        columns, dim = self.table.columns, 1 if second < 0 else 2
        point = columns[first]
        test: Test = Bound(point.component, "at most", 0.0)
        if not self.is_from_zero:
            radii = (1.0 / np.sqrt(ellipse[2 : 2 + dim])).tolist()
            test = Near(point.component, tuple(ellipse[:dim].tolist()), tuple(radii))
        same = [
            Statement(columns[column].mapping, columns[column].variables, Is(category))
            for column, category in self.categories
        ]
        return Condition(self.table.n_free, (*same, Statement(point.mapping, point.variables, test)))


def new_questions(
    scenes: Scenes,
    residuals: FloatArray,
    settings: CurveSettings,
    rng: np.random.Generator,
    asked: Sequence[Question] = (),
) -> list[Question]:
    """Return the best of some random questions, at most `settings.kept`, about different things.

    Parameters
    ----------
    scenes : Scenes
        Of actions of one type.
    residuals : (n_scenes,) float64
        What the questions so far do not explain.
    settings : CurveSettings
    rng : Generator
    asked : sequence of Question
        Those before, which are not asked again.
    """
    if len(scenes) < 2 * settings.min_scenes:
        return []
    max_free = min(MOST_FREE, max(0, _MOST_BOUND - scenes.schema.n_parameters))
    tables = condition_tables(scenes, max_free, most=_MOST_CHOICES, rng=rng)
    known = {question.condition for question in asked}
    forms = [
        form
        for table in tables
        for form in _forms(table, scenes.schema.n_parameters)
        if not (form.is_from_zero and form.condition(_ZERO) in known)
    ]
    if not forms:
        return []
    found: list[tuple[float, int, FloatArray]] = []
    for drawn in rng.integers(len(forms), size=settings.candidates).tolist():
        form = forms[drawn]
        rows, starts = form.choices()
        if len(rows) < _FEW_CHOICES:
            continue
        values, ellipse = form.table.table.values, _ZERO.copy()
        if form.is_from_zero or _place(values, form.disc, rows, starts, residuals, rng, ellipse):
            gain = _gain(values, form.disc, rows, starts, residuals, settings.min_scenes, ellipse)
            if gain > 0.0:
                found.append((gain, drawn, ellipse))
    found.sort(key=lambda each: -each[0])
    kept: dict[int, Question] = {}
    for _, drawn, ellipse in found:
        if len(kept) < settings.kept and drawn not in kept:
            condition = forms[drawn].condition(ellipse)
            seen = measured(pack_conditions(scenes.schema, [condition]), scenes)
            knots = knots_of(seen.margins[:, 0])
            if knots is not None:
                kept[drawn] = Question(condition, knots)
    return list(kept.values())


def _forms(table: ConditionTable, n_arguments: int) -> list[_Form]:
    """Return every point of all free objects with every choice of their categories."""
    arrays, columns = table.table, table.columns
    present: list[list[tuple[tuple[int, int], ...]]] = [
        [
            ((column, category),)
            for form, column, category in arrays.categories.tolist()
            if form == IS and columns[column].variables == (variable,)
        ]
        or [()]
        for variable in range(n_arguments, n_arguments + table.n_free)
    ]
    return [
        _Form(table, tuple(disc), tuple(chain(*chosen)))
        for disc in arrays.discs[: arrays.firsts[2]].tolist()
        for chosen in product(*present)
    ]


@kernel
def _nearest(
    values: FloatArray,
    disc: tuple[int, int, int],
    ellipse: FloatArray,
    rows: IntArray,
    starts: IntArray,
    least: FloatArray,
    witness: IntArray,
) -> None:
    """Write the least squared distance of each scene from the centre, infinite if none, and its choice."""
    form, first, second = disc
    for i in range(len(starts) - 1):
        least[i], witness[i] = np.inf, -1
        for place in range(starts[i], starts[i + 1]):
            x = values[first, rows[place]] - ellipse[0]
            if form == NEAR_ANGLE:
                x = wrap_angle(x)
            squared = ellipse[2] * x * x
            if second >= 0:
                y = values[second, rows[place]] - ellipse[1]
                squared += ellipse[3] * y * y
            if squared < least[i]:
                least[i], witness[i] = squared, rows[place]


@kernel
def _spread(
    values: FloatArray,
    disc: tuple[int, int, int],
    rows: IntArray,
    rng: np.random.Generator,
    moments: FloatArray,
) -> int:
    """Write the means and variances of some random choices; return how many of them are defined."""
    n = 0
    moments[:] = 0.0
    for _ in range(60):
        choice = rows[int(rng.random() * len(rows))]
        x = values[disc[1], choice]
        y = values[disc[2], choice] if disc[2] >= 0 else 0.0
        if not math.isnan(x + y):
            n += 1
            moments[0] += x
            moments[1] += y
            moments[2] += x * x
            moments[3] += y * y
    if n > 0:
        moments /= n
        moments[2] += 1e-6 - moments[0] * moments[0]
        moments[3] += 1e-6 - moments[1] * moments[1]
    return n


@kernel
def _begin(
    values: FloatArray,
    disc: tuple[int, int, int],
    rows: IntArray,
    starts: IntArray,
    side: BoolArray,  # (n_scenes,)
    moments: FloatArray,
    rng: np.random.Generator,
) -> int:
    """Return the choice of a scene on the side that is nearest to a random point; -1 if none is found."""
    for _ in range(40):
        i = int(rng.random() * len(side))
        if not side[i]:
            continue
        x = moments[0] + rng.standard_normal() * math.sqrt(moments[2])
        y = moments[1] + rng.standard_normal() * math.sqrt(moments[3])
        found, least = -1, np.inf
        for place in range(starts[i], starts[i + 1]):
            squared = (values[disc[1], rows[place]] - x) ** 2 / moments[2]
            if disc[2] >= 0:
                squared += (values[disc[2], rows[place]] - y) ** 2 / moments[3]
            if squared < least:
                found, least = rows[place], squared
        if found >= 0:
            return int(found)
    return -1


@kernel
def _gather(
    values: FloatArray,
    disc: tuple[int, int, int],
    side: BoolArray,  # (n_scenes,)
    least: FloatArray,
    witness: IntArray,
    n_nearest: int,
    moments: FloatArray,
    ellipse: FloatArray,
) -> bool:
    """Fit the ellipse to the nearest witnesses of scenes on one side; False if there are too few."""
    own = least[side]
    own = own[own < np.inf]
    if len(own) < 4:
        return False
    limit = np.partition(own, min(n_nearest, len(own)) - 1)[min(n_nearest, len(own)) - 1]
    n, sx, sy, sxx, syy = 0, 0.0, 0.0, 0.0, 0.0
    for i in range(len(least)):
        if side[i] and least[i] <= limit:
            x = values[disc[1], witness[i]] - ellipse[0]
            if disc[0] == NEAR_ANGLE:
                x = wrap_angle(x)
            y = values[disc[2], witness[i]] - ellipse[1] if disc[2] >= 0 else 0.0
            n, sx, sy, sxx, syy = n + 1, sx + x, sy + y, sxx + x * x, syy + y * y
    sx, sy = sx / n, sy / n
    # A few witnesses may lie on one point, so some of the variance of all choices is added.
    ellipse[2] = 1.0 / (sxx / n - sx * sx + 0.1 * moments[2] / n + 1e-9)
    ellipse[3] = 1.0 / (syy / n - sy * sy + 0.1 * moments[3] / n + 1e-9)
    ellipse[0] += sx
    ellipse[1] += sy
    return True


@kernel
def _best_cut(least: FloatArray, residuals: FloatArray, min_scenes: int) -> float:
    """Return by how much the best cut of the distances lowers the squared residuals; 0 if none does."""
    n, total, best, below = len(least), residuals.sum(), 0.0, 0.0
    order = np.argsort(least)
    for rank in range(n - min_scenes):
        below += residuals[order[rank]]
        here, following = least[order[rank]], least[order[rank + 1]]
        if rank + 1 < min_scenes or here == following or not here < np.inf:
            continue
        gain = below**2 / (rank + 1) + (total - below) ** 2 / (n - rank - 1) - total * total / n
        best = max(best, gain)
    return float(best)


@kernel
def _place(
    values: FloatArray,
    disc: tuple[int, int, int],
    rows: IntArray,
    starts: IntArray,
    residuals: FloatArray,
    rng: np.random.Generator,
    ellipse: FloatArray,
) -> bool:
    """Write a random ellipse (centre, 1 / radius^2) around witnesses of one side; False if there are too few.

    It is covariant aggregation in one step: the scenes with residuals above, or below, the mean are the
    positive bags, and the ellipse covers those of their witnesses that are nearest to one of them.
    """
    n = len(residuals)
    moments = np.empty(4)
    above = rng.random() < 0.5
    mean = residuals.sum() / n
    side = (residuals > mean) if above else (residuals <= mean)
    if _spread(values, disc, rows, rng, moments) < 10:
        return False
    centre = _begin(values, disc, rows, starts, side, moments, rng)
    if centre < 0:
        return False
    ellipse[0], ellipse[1] = values[disc[1], centre], values[disc[2], centre] if disc[2] >= 0 else 0.0
    ellipse[2], ellipse[3] = 1.0 / moments[2], 1.0 / moments[3]
    least, witness = np.empty(n), np.empty(n, dtype=np.int64)
    _nearest(values, disc, ellipse, rows, starts, least, witness)
    n_nearest = (8, 25, 80)[int(rng.random() * 3)]
    return bool(_gather(values, disc, side, least, witness, n_nearest, moments, ellipse))


@kernel
def _gain(
    values: FloatArray,
    disc: tuple[int, int, int],
    rows: IntArray,
    starts: IntArray,
    residuals: FloatArray,
    min_scenes: int,
    ellipse: FloatArray,
) -> float:
    """Return by how much the best cut of the distances from an ellipse lowers the squared residuals."""
    n = len(residuals)
    least, witness = np.empty(n), np.empty(n, dtype=np.int64)
    _nearest(values, disc, ellipse, rows, starts, least, witness)
    return float(_best_cut(least, residuals, min_scenes))
