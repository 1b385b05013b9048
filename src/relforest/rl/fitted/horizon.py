"""Q by the number of actions that remain: a forest of randomised trees for each number and action type.

With h actions left, an action is worth its reward and the best action with h - 1 left. What is learned is how
much better it is than an average action of its state with one action less: values grow with h, but what an
action is good for hardly does, so that the trees need not learn the former.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any, Final, final

import numpy as np
from numpy.typing import NDArray

from relforest.forests.conditions import Condition
from relforest.forests.packing import Packed, pack_conditions
from relforest.rl.fitted.counted import counted_conditions, own_numbers
from relforest.rl.fitted.evidence import Evidence
from relforest.rl.fitted.forest_arrays import (
    LEAST_EXAMPLES,
    ForestArrays,
    forest_mean,
    joined,
    path_parts,
    randomised,
)
from relforest.rl.fitted.questions import Measures, measured
from relforest.rl.fitted.settings import ForestSettings
from relforest.scenes import Schema
from relforest.scenes.arrays import FloatArray, IntArray
from relforest.support.documents import well_formed
from relforest.support.options import in_range
from relforest.support.progress import report

# Trees only compare: what stands for "undefined" must lie outside of everything else.
_UNDEFINED: Final = -1e6
_FAR: Final = 1e6
# The share of features that is compared at a node where there are many that hardly matter.
_SMALL_SHARE: Final = 0.1


@final
@dataclass(frozen=True, slots=True)
class Measured:
    """A condition that is measured, and how much it matters.

    Parameters
    ----------
    condition : Condition
        Trees compare how far it fails and, if it has free variables, how many objects satisfy it.
    importance : float
        The share of what all trees explain that is due to it.
    """

    condition: Condition
    importance: float = 0.0

    def to_dict(self) -> dict[str, Any]:
        """Return it as plain JSON values."""
        return {"condition": self.condition.to_dict(), "importance": self.importance}

    @classmethod
    def from_dict(cls, document: Any, schema: Schema) -> Measured:  # noqa: ANN401 - not checked yet
        """Read what `to_dict` returned; `ModelFormatError` if it is not such a document."""
        with well_formed("malformed measure"):
            importance = float(in_range("importance", document["importance"], 0.0, 1.0))
            return cls(Condition.from_dict(document["condition"], schema), importance)


@final
@dataclass(frozen=True, slots=True, eq=False)
class Horizon:
    """How much better actions are than an average one, for each number of actions that remain.

    Parameters
    ----------
    schemas : tuple of Schema
        Of the scenes of each action type.
    measured : tuple of tuple of Measured
        What is measured of actions of each type.
    trees : ForestArrays
        Of these measures and the number of objects.
    """

    schemas: tuple[Schema, ...]
    measured: tuple[tuple[Measured, ...], ...]
    trees: ForestArrays
    packed: tuple[Packed, ...] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        packed = [
            pack_conditions(schema, [each.condition for each in own])
            for schema, own in zip(self.schemas, self.measured, strict=True)
        ]
        object.__setattr__(self, "packed", tuple(packed))

    def offered(self, places: Sequence[int | None], schemas: tuple[Schema, ...]) -> Horizon:
        """Return what is measured, without trees, for actions of other types; see `Sum.offered`."""
        measured = tuple(() if place is None else self.measured[place] for place in places)
        return Horizon(schemas, measured, joined([[[] for _ in schemas]]))

    @property
    def base(self) -> None:
        """No action type has a value that is added to the others'."""
        return

    @property
    def size(self) -> tuple[int, int]:
        """Number of trees and of their leaves."""
        return int((self.trees.roots >= 0).sum()), int((self.trees.feature < 0).sum())

    def worth(self, number: int, seen: Measures, remaining: int | None) -> FloatArray:
        """Return what actions (n,) of one type are worth with so many left, 0 where nothing was learned."""
        return forest_mean(self.trees, *self._asked(number, seen, remaining))

    def shares(self, number: int, seen: Measures, remaining: int | None) -> FloatArray:
        """Return the parts of `worth`, (n, k + 2): the type as such, each measure, the number of objects."""
        is_counted = np.array([each.condition.n_free > 0 for each in self.measured[number]], dtype=np.bool_)
        found = path_parts(self.trees, *self._asked(number, seen, remaining))
        n = len(is_counted)
        out = np.column_stack([found[:, : 1 + n], found[:, -1]])
        out[:, 1 + np.flatnonzero(is_counted)] += found[:, 1 + n : -1]
        return out

    def told(self, number: int, place: int) -> tuple[Condition | None, int]:
        """Return what is measured at a place among an action type's measures; None: the number of objects."""
        own = self.measured[number]
        return own[place].condition if place < len(own) else None, 1

    def _asked(
        self, number: int, seen: Measures, remaining: int | None
    ) -> tuple[IntArray, NDArray[np.float32]]:
        """Return the roots of the trees for so many actions left, and what they compare."""
        roots = self.trees.roots
        left = len(roots) if remaining is None else min(max(remaining, 1), len(roots))
        return roots[left - 1, number], _features([each.condition for each in self.measured[number]], seen)


def _features(conditions: Sequence[Condition], seen: Measures) -> NDArray[np.float32]:
    """Return what the trees compare, (n, k): margins, counts where there are any, the number of objects."""
    is_counted = np.array([condition.n_free > 0 for condition in conditions], dtype=np.bool_)
    margins = np.where(np.isnan(seen.margins), np.where(is_counted, _FAR, _UNDEFINED), seen.margins)
    return np.hstack([margins, seen.counts[:, is_counted], seen.n_objects[:, None]]).astype(np.float32)


def learned_backwards(
    schemas: tuple[Schema, ...],
    evidence: Evidence,
    settings: ForestSettings,
    rng: np.random.Generator,
    offered: Horizon | None = None,
) -> Horizon:
    """Return what is learned from all experience, from the last action to the first.

    Parameters
    ----------
    schemas : tuple of Schema
        Of the scenes of each action type.
    evidence : Evidence
        Of a task that limits the number of actions.
    settings : ForestSettings
    rng : Generator
    offered : Horizon, optional
        What was known before: half of the counts are those that mattered most there.

    References
    ----------
    Geurts, Ernst and Wehenkel, Extremely randomized trees (2006).
    """
    report("counting objects")
    conditions = tuple(
        (*own_numbers(schema), *_counted(number, evidence, settings, offered, rng))
        for number, schema in enumerate(schemas)
    )
    columns = [
        _features(own, measured(pack_conditions(schema, own), scenes, evidence.n_jobs))
        for schema, own, scenes in zip(schemas, conditions, evidence.scenes, strict=True)
    ]
    examples = [evidence.examples(number, is_base=False) for number in range(len(schemas))]
    importances = [np.zeros(own.shape[1]) for own in columns]
    values = np.zeros(len(evidence.owner))
    grown: list[list[list[Any]]] = []
    horizon = int(evidence.remaining.max())
    for remaining in range(horizon):
        report("numbers of remaining actions", remaining, horizon)
        average = evidence.mean(values)
        best = evidence.best(values)[evidence.next_states]
        targets = evidence.rewards + (evidence.discounts > 0.0) * best - average[evidence.states]
        values = average[evidence.owner]
        grown.append([])
        for number, (transitions, rows) in enumerate(examples):
            trees: list[Any] = []
            if len(rows) > LEAST_EXAMPLES:
                model = randomised(settings, settings.share, rng, evidence.n_jobs)
                model.fit(columns[number][rows], targets[transitions])
                trees = [tree.tree_ for tree in model.estimators_]
                own = joined([[trees]])
                values[evidence.candidates[number]] += forest_mean(own, own.roots[0, 0], columns[number])
                importances[number] += model.feature_importances_
            grown[-1].append(trees)
    found = tuple(_with_importance(*each) for each in zip(conditions, importances, strict=True))
    return Horizon(schemas, found, joined(grown))


def _counted(
    number: int,
    evidence: Evidence,
    settings: ForestSettings,
    offered: Horizon | None,
    rng: np.random.Generator,
) -> Iterator[Condition]:
    """Yield the conditions whose objects are counted for actions of one type."""
    known = () if offered is None else offered.measured[number]
    kept = _most_important([each for each in known if each.condition.n_free], settings.counts // 2)
    yield from kept
    scenes, n = evidence.scenes[number], settings.counts - len(kept)
    if not len(scenes):
        return
    transitions, rows = evidence.examples(number, is_base=False)
    # Among more conditions than transitions, chance would choose.
    new = counted_conditions(scenes, max(n, min(settings.tried, len(rows))), rng)
    if len(new) > n and len(rows) > LEAST_EXAMPLES:
        some = np.sort(rng.permutation(len(rows))[: settings.max_scenes])
        tried = [*own_numbers(scenes.schema), *new]
        seen = measured(pack_conditions(scenes.schema, tried), scenes.take(rows[some]), evidence.n_jobs)
        # What is earned at once is known, and other conditions can still turn out to matter later.
        model = randomised(settings, _SMALL_SHARE, rng, evidence.n_jobs)
        model.fit(_features(tried, seen), evidence.rewards[transitions[some]])
        found = _with_importance(tried, model.feature_importances_)
        new = _most_important([each for each in found if each.condition.n_free], n)
    yield from new[:n]


def _most_important(known: Sequence[Measured], n: int) -> list[Condition]:
    return [each.condition for each in sorted(known, key=lambda each: -each.importance)[:n]]


def _with_importance(conditions: Sequence[Condition], importances: FloatArray) -> tuple[Measured, ...]:
    """Return conditions with the importance of their features, as shares of all."""
    n = len(conditions)
    of_condition, total = importances[:n].copy(), importances.sum()
    of_condition[[condition.n_free > 0 for condition in conditions]] += importances[n:-1]
    shares = of_condition / total if total > 0.0 else of_condition
    return tuple(Measured(*each) for each in zip(conditions, shares.tolist(), strict=True))
