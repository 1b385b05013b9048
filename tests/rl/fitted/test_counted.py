from __future__ import annotations

import numpy as np

from interpreted import compiled_only
from relforest.forests.statements import Bound, Near
from relforest.rl.fitted import ForestSettings
from relforest.rl.fitted.counted import counted_conditions
from relforest.rl.fitted.evidence import Evidence
from relforest.rl.fitted.horizon import Horizon, learned_backwards
from relforest.rl.fitted.view import View
from relforest.rl.policy import RandomPolicy
from relforest.rl.rollout import rollout
from rl.small_worlds import ACTION_TYPES, PICK, Limited

pytestmark = compiled_only


def evidence() -> Evidence:
    world = Limited(things=4)
    batch = rollout(world, RandomPolicy(), 60, np.random.SeedSequence(0))
    view = View.of(world.schema, batch.matrix, 6)
    return Evidence.of([batch], view, view.schemas(ACTION_TYPES), 1.0)


def learned(settings: ForestSettings, offered: Horizon | None = None) -> Horizon:
    found = evidence()
    schemas = tuple(scenes.schema for scenes in found.scenes)
    return learned_backwards(schemas, found, settings, np.random.default_rng(1), offered)


def test_conditions_begin_with_how_an_object_lies_to_an_argument() -> None:
    found = counted_conditions(evidence().scenes[PICK], 200, np.random.default_rng(0))
    variables = [[statement.variables for statement in each.statements] for each in found]
    assert {len(own) for own in variables} == {1, 2, 3}
    assert all(own[0] == (0, 1) for own in variables)
    # What the other object is itself comes later.
    assert any((1,) in own[1:] for own in variables)


def test_without_arguments_conditions_say_what_an_object_is_itself() -> None:
    found = counted_conditions(evidence().scenes[0], 50, np.random.default_rng(0))
    assert {statement.variables for each in found for statement in each.statements} == {(0,)}
    assert all(isinstance(each.statements[0].test, (Bound, Near)) for each in found)


def test_half_of_the_counts_are_those_that_mattered_most_before() -> None:
    settings = ForestSettings(counts=6, tried=40, trees=4)
    first = learned(settings)
    second = learned(settings, first)
    counts = [[each for each in own.measured[PICK] if each.condition.n_free] for own in (first, second)]
    assert [len(own) for own in counts] == [6, 6]
    best = sorted(counts[0], key=lambda each: -each.importance)[:3]
    assert [each.condition for each in counts[1][:3]] == [each.condition for each in best]


def test_new_counts_are_chosen_among_those_tried() -> None:
    chosen, all_of_them = (learned(ForestSettings(counts=4, tried=tried, trees=8)) for tried in (80, 0))
    importance = [
        sum(each.importance for each in own.measured[PICK] if each.condition.n_free)
        for own in (chosen, all_of_them)
    ]
    assert importance[0] > importance[1]
