"""The search for conditions: limits by brute force, gains as defined, tables that agree with evaluation."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from forest_scenes import TEAM, random_scenes, related
from relforest.forests import Ensemble, GrowthSettings
from relforest.forests.bindings import bindings
from relforest.forests.columns import columns
from relforest.forests.forms import AT_LEAST, AT_MOST, LARGE, SMALL
from relforest.forests.growth import grow_tree
from relforest.forests.kernels import Plan, Search, Targets, best_limit, order_scenes, work_space
from relforest.forests.rows import Choices, allow_all, least_values, restrict
from relforest.forests.tables import condition_tables
from relforest.forests.words import sentence
from relforest.scenes import Attribute, Scenes, Schema


def score(targets: Targets, chosen: NDArray[Any], penalty: float) -> float:
    g, h = targets.gradients[chosen].sum(axis=0), targets.curvatures[chosen].sum(axis=0)
    return float((g**2 / (h + penalty)).sum())


def searched(least: NDArray[np.float64], n_outputs: int) -> Search:
    """Work space with these least values, in order."""
    n = len(least)
    none = Choices(np.empty(0, dtype=np.int64), np.zeros(1, dtype=np.int64))
    sums = np.empty((2, 2, n_outputs))
    work = Search(least, np.empty(n, dtype=np.int64), np.ones(n, dtype=np.bool_), none, none, sums)
    order_scenes(np.arange(n), work)
    return work


@pytest.mark.parametrize("seed", range(5))
def test_the_best_limit_is_that_of_brute_force(seed: int) -> None:
    rng = np.random.default_rng(seed)
    n, least_scenes, penalty = 30, 1 + seed, 0.5
    values = rng.integers(0, 12, n).astype(np.float64)
    values[rng.random(n) < 0.2] = np.inf
    targets = Targets(rng.standard_normal((n, 2)), rng.uniform(0.1, 1, (n, 2)))
    plan = Plan(1, 1, 0, least_scenes, 1.0, 1.0, penalty, 1.0)

    is_category = False
    gain, limit = best_limit(np.arange(n), targets, is_category, plan, searched(values.copy(), 2))

    gains = {}
    for threshold in np.unique(values[values < np.inf]):
        inside = values <= threshold
        if least_scenes <= inside.sum() <= n - least_scenes:
            gains[threshold] = (
                score(targets, inside, penalty)
                + score(targets, ~inside, penalty)
                - score(targets, np.ones(n, bool), penalty)
            )
    best = max(gains, key=lambda threshold: gains[threshold])
    assert gain == pytest.approx(gains[best])
    assert np.array_equal(values <= limit, values <= best)


@pytest.mark.parametrize("has_relations", [False, True])
@pytest.mark.parametrize(
    ("n_parameters", "options"),
    [(0, {}), (1, {"max_count": 3}), (2, {}), (0, {"every": True}), (1, {"every": True, "max_count": 2})],
)
def test_a_grown_tree_gains_what_it_says_and_answers_as_in_the_tables(
    n_parameters: int,
    options: dict[str, Any],
    has_relations: bool,  # noqa: FBT001 - a parameter of the test
) -> None:
    rng = np.random.default_rng(n_parameters)
    n = 40
    scenes = random_scenes(rng, n, n_parameters, 4)
    scenes = related(rng, scenes) if has_relations else scenes
    targets = Targets(rng.standard_normal((n, 1)), np.ones((n, 1)))
    settings = GrowthSettings(max_leaves=5, penalty=2.0, **options)
    tables = condition_tables(scenes, 2, most=1000, rng=rng)

    grown = grow_tree(tables, np.arange(n), targets, settings, rng)

    tree = grown.tree
    ensemble = Ensemble(scenes.schema, np.zeros(1), (tree,), np.ones(1))
    leaves = ensemble.leaves(scenes)[:, 0]
    assert np.array_equal(leaves, grown.leaves(np.arange(n)))
    assert len(tree.leaves) == 5
    assert "every" in options or not any(split.condition.every for split in tree.splits)
    assert np.bincount(leaves).tolist() == [tree.nodes[leaf].n_scenes for leaf in tree.leaves]  # type: ignore[union-attr]
    assert np.bincount(leaves).min() >= settings.min_scenes
    for number, value in enumerate(tree.values[:, 0]):
        inside = leaves == number
        assert value == pytest.approx(-targets.gradients[inside].sum() / (inside.sum() + 2.0))
    total = sum(score(targets, leaves == number, 2.0) for number in range(5))
    gained = 0.5 * (total - score(targets, np.ones(n, bool), 2.0))
    assert sum(split.gain for split in tree.splits) == pytest.approx(gained)


@pytest.mark.parametrize("n_parameters", [0, 2])
def test_least_values_are_those_of_the_choices_that_earlier_statements_allow(n_parameters: int) -> None:
    rng = np.random.default_rng(n_parameters)
    tables = condition_tables(random_scenes(rng, 12, n_parameters), 2, most=1000, rng=rng)
    scenes = np.array([1, 4, 5, 9])
    for table in (each.table for each in tables):
        work = work_space(table, scenes, 1)
        for number, (form, column) in enumerate(table.bounds[: table.firsts[0]]):
            statement = np.array([form, column, -1, 0, 0, 0, 0, 1.0])
            earlier = np.array([AT_MOST, 0, -1, 0, 0, 0, 0, 1.0])
            sign = -1.0 if form in {AT_LEAST, LARGE} else 1.0
            values = sign * (np.abs(table.values) if form in {SMALL, LARGE} else table.values)[column]
            spans = [slice(table.starts[scene], table.starts[scene + 1]) for scene in scenes]

            allow_all(table, scenes, work.inside)
            least_values(table, scenes, work.inside, statement, 2, work.least)
            assert [second(values[span]) for span in spans] == work.least[scenes].tolist()
            assert [min(known(values[span])) for span in spans] == table.least[number, scenes].tolist()
            ordered = table.least[number, table.order[number]].tolist()
            assert ordered == sorted(ordered)

            restrict(table, earlier, work.inside)
            least_values(table, scenes, work.inside, statement, 2, work.least)
            allowed = [values[span][table.values[0, span] <= 1.0] for span in spans]
            assert [second(each) for each in allowed] == work.least[scenes].tolist()


def known(values: NDArray[np.float64]) -> list[float]:
    """Defined values, or an infinite one."""
    return [*values[~np.isnan(values)].tolist(), np.inf]


def second(values: NDArray[np.float64]) -> float:
    """The second smallest value, infinite if there are fewer."""
    return float(sorted([*known(values), np.inf])[1])


def test_a_condition_about_one_kind_is_found_where_that_kind_alone_tells_nothing() -> None:
    # A guest and a home player at mirrored places: without their teams, all scenes look alike.
    guests = np.repeat([2.0, 8.0], 6)
    matrix = np.column_stack([np.ravel([guests, 10.0 - guests], "F"), np.tile([1.0, 0.0], 12)])
    schema = Schema([Attribute("x"), TEAM])
    scenes = Scenes(schema, matrix, np.arange(24), np.arange(0, 24, 2), np.full(12, 2))
    targets = Targets(np.where(guests < 5, -1.0, 1.0)[:, None], np.ones((12, 1)))
    rng = np.random.default_rng(0)
    tables = condition_tables(scenes, 1, most=1000, rng=rng)
    settings = GrowthSettings(max_leaves=2, max_statements=2, share=1.0, n_discs=0)
    grown = grow_tree(tables, np.arange(12), targets, settings, rng)

    assert np.unique(grown.leaves(np.arange(6))).size == 1
    assert grown.tree.splits[0].gain == pytest.approx(0.5 * (36 / 7 + 36 / 7))


def test_the_limit_of_a_category_separates_right_from_wrong() -> None:
    # Two scenes where it is right, two where it is wrong, two without a choice; these differ most.
    work = searched(np.array([0.0, 0.0, 1.0, 1.0, np.inf, np.inf]), 1)
    targets = Targets(np.array([[1.0], [1], [0], [0], [-9], [-9]]), np.ones((6, 1)))
    is_category = True
    gain, limit = best_limit(np.arange(6), targets, is_category, Plan(1, 1, 0, 1, 1.0, 1.0, 1.0, 1.0), work)

    # 2^2 / 3 + 18^2 / 5 - 16^2 / 7.
    assert gain == pytest.approx(4 / 3 + 324 / 5 - 256 / 7)
    assert limit == 0.5


def test_every_object_without_a_partner_is_found() -> None:
    """Is every object within 2 of another one?"""
    rng = np.random.default_rng(0)
    counts = np.arange(60) % 5
    starts = np.cumsum(counts) - counts
    n = int(counts.sum())
    schema = Schema([Attribute("weight", operations=["distance"])])
    scenes = Scenes(schema, rng.uniform(0, 12, (n, 1)), np.arange(n), starts, counts)
    wanted = np.zeros(60)
    for scene in range(60):
        weights = scenes.matrix[scenes.objects(scene), 0]
        gaps = np.abs(weights[:, None] - weights) + 100 * np.eye(len(weights))
        wanted[scene] = len(weights) > 0 and (gaps.min(axis=1) <= 2.0).all()
    targets = Targets(0.5 - wanted[:, None], np.ones((60, 1)))
    settings = GrowthSettings(max_leaves=2, max_statements=1, n_discs=0, every=True)
    tables = condition_tables(scenes, 2, most=1000, rng=rng)
    grown = [grow_tree(tables, np.arange(60), targets, settings, rng).tree for _ in range(8)]
    best = max(grown, key=lambda tree: tree.splits[0].gain)
    condition = best.splits[0].condition

    assert condition.every
    assert sentence(condition, schema).startswith("every object C has another, D, such that D is within")
    leaves = Ensemble(schema, np.zeros(1), (best,), np.ones(1)).leaves(scenes)[:, 0]
    assert ((leaves == 0) == wanted).all()
    # Where pairs are sampled, the partners of an object are not known.
    some = condition_tables(scenes, 2, most=2, rng=rng)
    for _ in range(8):
        tree = grow_tree(some, np.arange(60), targets, settings, rng).tree
        assert not any(split.condition.every for split in tree.splits)


def test_columns_see_free_objects_from_the_arguments() -> None:
    schema = Schema([Attribute("location", 2, operations=["distance", "reframe"])], ["passer", "target"])

    found = {(each.mapping.name, each.variables) for each in columns(schema, 1)}

    # 0 and 1 are passer and target, 2 is free: of three objects it comes last.
    assert found == {
        ("distance(location)", (0, 1)),
        ("distance(location)", (0, 2)),
        ("distance(location)", (1, 2)),
        *(
            (f"{operation}(location)", order)
            for operation in ("reframe", "scaled_distance", "bearing")
            for order in ((0, 1, 2), (1, 0, 2))
        ),
    }


@pytest.mark.parametrize("n_free", [0, 1, 2])
def test_all_choices_of_free_objects_are_listed_once(n_free: int) -> None:
    rng = np.random.default_rng(n_free)
    scenes = random_scenes(rng, 20, 2)
    found, n_sampled = bindings(scenes, n_free, most=1000, rng=rng)

    assert n_sampled == 0
    for scene in range(20):
        rows = found.rows[found.starts[scene] : found.starts[scene + 1]]
        free = set(scenes.objects(scene).tolist()) - set(scenes.arguments[scene].tolist())
        k = len(free)
        assert len(rows) == [1, k, k * (k - 1)][n_free]
        assert (rows[:, :2] == scenes.arguments[scene]).all()
        chosen = {tuple(row) for row in rows[:, 2:].tolist()}
        assert len(chosen) == len(rows)
        assert all(set(choice) <= free and len(set(choice)) == n_free for choice in chosen)


def test_too_many_choices_are_sampled_evenly() -> None:
    rng = np.random.default_rng(0)
    scenes = random_scenes(rng, 30, 0, most=9)
    everything, _ = bindings(scenes, 2, most=1000, rng=rng)
    some, n_sampled = bindings(scenes, 2, most=5, rng=rng)

    sizes, all_sizes = np.diff(some.starts), np.diff(everything.starts)
    assert np.array_equal(sizes, np.minimum(all_sizes, 5))
    assert n_sampled == np.count_nonzero(all_sizes > 5)
    for scene in range(30):
        chosen = {tuple(row) for row in some.rows[some.starts[scene] : some.starts[scene + 1]].tolist()}
        possible = everything.rows[everything.starts[scene] : everything.starts[scene + 1]].tolist()
        assert len(chosen) == sizes[scene]
        assert chosen <= {tuple(row) for row in possible}
