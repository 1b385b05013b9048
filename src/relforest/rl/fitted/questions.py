"""Questions with a curve: what the distance from satisfying a condition adds to a value."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise
from typing import Any, Final, NamedTuple, final

import numpy as np

from relforest.forests.conditions import Condition
from relforest.forests.evaluation import Facts
from relforest.forests.measures import measures, work_space
from relforest.forests.packing import Packed
from relforest.forests.statements import Near
from relforest.rl.experience import BoolArray
from relforest.scenes import Scenes, Schema
from relforest.scenes.arrays import FloatArray, IntArray
from relforest.scenes.pairs import NO_PAIRS
from relforest.support.documents import LARGEST_NUMBER, well_formed
from relforest.support.errors import ModelFormatError
from relforest.support.jit import kernel
from relforest.support.options import in_range
from relforest.support.threads import in_threads

N_KNOTS: Final = 5
_QUANTILES: Final = (0.02, 0.25, 0.5, 0.75, 0.98)
# The share of distances that is nearest to each knot.
_WEIGHTS: Final = np.diff([0.0, *((a + b) / 2 for a, b in pairwise(_QUANTILES)), 1.0])
# Knots of a distance that hardly varies are kept apart by so much of its size.
_APART: Final = 1e-6


@final
@dataclass(frozen=True, slots=True)
class Question:
    """A condition, and a piecewise linear function of how far a scene is from satisfying it.

    Parameters
    ----------
    condition : Condition
    knots : tuple of float
        `N_KNOTS` distances in ascending order (`relforest.forests.measures`); beyond the ends, and where no
        choice of objects has a distance (as at the last one), the curve is flat.
    heights : tuple of float
        What the question adds to the value at the knots.
    spread : float
        Standard deviation of what it adds to the values of the actions that were learned from.
    """

    condition: Condition
    knots: tuple[float, ...]
    heights: tuple[float, ...] = (0.0,) * N_KNOTS
    spread: float = 0.0

    @property
    def usual(self) -> float:
        """What it adds on average over distances of which the knots are quantiles, as they were at first."""
        return float(_WEIGHTS @ self.heights)

    def to_dict(self) -> dict[str, Any]:
        """Return the question as plain JSON values."""
        return {
            "condition": self.condition.to_dict(),
            "knots": list(self.knots),
            "heights": list(self.heights),
            "spread": self.spread,
        }

    @classmethod
    def from_dict(cls, document: Any, schema: Schema) -> Question:  # noqa: ANN401 - not checked yet
        """Read what `to_dict` returned.

        Raises
        ------
        ModelFormatError
            If it is not such a document.
        """
        with well_formed("malformed question"):
            condition = Condition.from_dict(document["condition"], schema)
            knots, heights = (_numbers(document[key]) for key in ("knots", "heights"))
            if any(b <= a for a, b in pairwise(knots)):
                raise ModelFormatError("knots must be in ascending order")
            spread = float(in_range("spread", document["spread"], 0.0, LARGEST_NUMBER))
            return cls(condition, knots, heights, spread)


def knots_of(margins: FloatArray) -> tuple[float, ...] | None:
    """Return knots at quantiles of the finite margins (n,); None if there are too few."""
    finite = margins[np.isfinite(margins)]
    if len(finite) < N_KNOTS:
        return None
    knots = np.quantile(finite, _QUANTILES)
    return tuple((knots + np.arange(N_KNOTS) * _APART * (1.0 + abs(knots[-1]))).tolist())


def are_alike(a: Condition, b: Condition) -> bool:
    """Return whether two conditions are about the same place: the centre of one lies within the other."""
    if a.n_free != b.n_free or len(a.statements) != len(b.statements):
        return False
    for one, other in zip(a.statements, b.statements, strict=True):
        if (one.mapping, one.variables) != (other.mapping, other.variables):
            return False
        if (
            isinstance(one.test, Near)
            and isinstance(other.test, Near)
            and len(one.test.centre) == len(other.test.centre)
        ):
            away = np.subtract(one.test.centre, other.test.centre)
            radii = np.maximum(one.test.radii, other.test.radii)
            if one.test.component != other.test.component or ((away / radii) ** 2).sum() > 1.0:
                return False
        elif one.test != other.test:
            return False
    return True


@lru_cache(maxsize=64)
def spokesmen(questions: tuple[Question, ...]) -> tuple[int, ...]:
    """Return the place of the question that stands for each: of those alike, the one that varies most.

    Curves of distances from nearly the same place often cancel, so that none says anything alone.
    """
    found = [0] * len(questions)
    chosen: list[int] = []
    for place in sorted(range(len(questions)), key=lambda place: -questions[place].spread):
        condition = questions[place].condition
        like = (each for each in chosen if are_alike(questions[each].condition, condition))
        found[place] = next(like, place)
        if found[place] == place:
            chosen.append(place)
    return tuple(found)


class Measures(NamedTuple):
    """What conditions say about n scenes."""

    margins: FloatArray  # (n, k): how far a scene is from satisfying a condition, NaN if no choice is near
    counts: FloatArray  # (n, k): how many choices of objects satisfy it
    n_objects: IntArray  # (n,)


def measured(packed: Packed, scenes: Scenes, n_jobs: int = 1) -> Measures:
    """Return what conditions say about scenes, by so many threads."""
    columns = (scenes.rows, scenes.starts, scenes.counts, scenes.arguments)
    out = np.empty((2, len(scenes), len(packed.conditions)))

    def evaluate(begin: int, end: int, stop: BoolArray) -> None:
        work = work_space(packed, scenes.schema.n_parameters, scenes.schema.width)
        measures(
            packed, Facts(scenes.matrix, scenes.pairs, scenes.rows), columns, begin, end, work, out, stop
        )

    in_threads(evaluate, len(scenes), n_jobs)
    return Measures(out[0], out[1], scenes.counts)


def measured_rows(
    packed: Packed, matrix: FloatArray, columns: tuple[IntArray, IntArray, IntArray, IntArray]
) -> Measures:
    """Return what conditions say about scenes given as rows, starts, counts and arguments."""
    out = np.empty((2, len(columns[1]), len(packed.conditions)))
    work = work_space(packed, columns[3].shape[1], matrix.shape[1])
    facts = Facts(matrix, NO_PAIRS, columns[0])
    measures(packed, facts, columns, 0, out.shape[1], work, out, np.zeros(1, dtype=np.bool_))
    return Measures(out[0], out[1], columns[2])


@kernel
def hats(margins: FloatArray, knots: FloatArray, out: np.ndarray[Any, Any]) -> None:
    """Write the share of each knot in each margin (n, k), next to each other: ``out`` is (n, k * N_KNOTS)."""
    for i in range(margins.shape[0]):
        for j in range(margins.shape[1]):
            x, first = margins[i, j], j * N_KNOTS
            out[i, first : first + N_KNOTS] = 0.0
            if not x < knots[j, N_KNOTS - 1]:  # NaN too
                out[i, first + N_KNOTS - 1] = 1.0
                continue
            if x <= knots[j, 0]:
                out[i, first] = 1.0
                continue
            place = 1
            while x >= knots[j, place]:
                place += 1
            share = (x - knots[j, place - 1]) / (knots[j, place] - knots[j, place - 1])
            out[i, first + place - 1], out[i, first + place] = 1.0 - share, share


def features_of(margins: FloatArray, questions: Sequence[Question]) -> np.ndarray[Any, Any]:
    """Return the shares of the knots of all questions in their margins (n, k), (n, k * N_KNOTS) float32."""
    out = np.empty((len(margins), len(questions) * N_KNOTS), dtype=np.float32)
    hats(margins, np.array([question.knots for question in questions]).reshape(-1, N_KNOTS), out)
    return out


@kernel
def curves(margins: FloatArray, knots: FloatArray, heights: FloatArray, out: FloatArray) -> None:
    """Add up the curves (k, N_KNOTS) of the questions at the margins (n, k) of each scene, (n,)."""
    for i in range(margins.shape[0]):
        out[i] = 0.0
        for j in range(margins.shape[1]):
            x = margins[i, j]
            if not x < knots[j, N_KNOTS - 1]:  # NaN too
                out[i] += heights[j, N_KNOTS - 1]
                continue
            place = 0
            while x >= knots[j, place]:
                place += 1
            if place == 0:
                out[i] += heights[j, 0]
                continue
            share = (x - knots[j, place - 1]) / (knots[j, place] - knots[j, place - 1])
            out[i] += (1.0 - share) * heights[j, place - 1] + share * heights[j, place]


def _numbers(entries: object) -> tuple[float, ...]:
    if not isinstance(entries, list) or len(entries) != N_KNOTS:
        raise ModelFormatError(f"knots and heights must be {N_KNOTS} numbers each")
    return tuple(float(in_range("number", entry, -LARGEST_NUMBER, LARGEST_NUMBER)) for entry in entries)
