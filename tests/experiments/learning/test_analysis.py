from __future__ import annotations

import numpy as np
import pytest

from relforest.experiments.learning import settings
from relforest.experiments.learning.analysis import interval, summarize
from relforest.experiments.registry import STUDIES
from relforest.experiments.sheets import Span
from relforest.experiments.table import Row, Table
from relforest.experiments.tasks import TASKS


def rows(condition: str, played: str, rewards: dict[int, list[float]]) -> list[Row]:
    return [
        {
            "task": "keepaway",
            "condition": condition,
            "run": run,
            "played": played,
            "episodes": episodes,
            "reward": reward,
            "train": None,
            "leaves": None,
            "paid": 0.5,
        }
        for episodes, values in rewards.items()
        for run, reward in enumerate(values)
    ]


def table() -> Table:
    ours = rows(
        "smrf-q",
        "keepaway",
        {0: [58.0] * 4, 500: [150.0, 180.0, 190.0, 200.0], 1000: [184.0, 185.0, 186.0, 185.0]},
    )
    there = rows("smrf-q", "keepaway-4v3", {1000: [90.0, 96.0]})
    linear = rows("linear-q", "keepaway", {500: [150.0, 160.0, 170.0], 1000: [170.0, 171.0, 172.0]})
    hand = [*rows("hand", "keepaway", {0: [165.0]}), *rows("hand", "keepaway-4v3", {0: [79.0]})]
    return Table.of([*ours, *there, *linear, *hand])


def test_the_interval_covers_the_mean_and_needs_three_values() -> None:
    found = interval(np.arange(20.0))
    assert isinstance(found, Span)
    assert found.low < 9.5 < found.high
    assert interval(np.array([1.0, 2.0])) is None


def test_claims_are_about_means_and_the_worst_run() -> None:
    verdicts = {claim.name: claim.verdict for claim in summarize("keepaway", table()).claims}
    assert verdicts == {
        "smrf-q: mean reward after 500 episodes": "met",
        "smrf-q: mean reward after 1000 episodes": "met",
        "smrf-q: least reward of a run after 500 episodes": "MISSED",
        "smrf-q: p of no more reward than linear-q after 500 episodes": "MISSED",
        "smrf-q: p of no more reward than linear-q after 1000 episodes": "met",
        "smrf-q: least reward of a run after 1000 episodes, bound: hand": "met",
        "smrf-q: mean reward in keepaway-4v3 without learning there": "MISSED",
    }


def test_towers_are_compared_run_by_run_with_the_policy_that_played_the_same_draws() -> None:
    hand = [4.0, 8.0, 12.0, 16.0]
    better = [reward + 0.3 + 0.1 * run for run, reward in enumerate(hand)]
    found = Table.of(
        [*rows("large-first", "high-towers", {0: hand}), *rows("smrf-q", "high-towers", {1000: better})]
    )
    (claim,) = [each for each in summarize("high-towers", found).claims if "large-first" in each.name]
    # The mean lead, 0.45, is far below the spread of the runs.
    assert claim.verdict == "met"


def test_arches_are_counted_and_compared_with_the_trainer() -> None:
    ours = rows("smrf-q", "arch", {1500: [25.0, 16.0], 3000: [30.0, 33.0]})
    found = Table.of([*rows("trainer", "arch", {0: [17.0]}), *ours])
    assert {claim.name: claim.verdict for claim in summarize("arch", found).claims} == {
        "smrf-q: share of test episodes that end with an arch after 3000 episodes": "MISSED",
        "smrf-q: mean reward after 3000 episodes": "met",
        "smrf-q: mean reward after 1500 episodes, bound: trainer": "met",
    }


@pytest.mark.parametrize("task", settings.SETTINGS)
def test_settings_are_about_tasks_and_methods_that_exist(task: str) -> None:
    for setting in (*settings.SETTINGS[task], *settings.SMOKE[task]):
        assert setting.task in TASKS
        if setting.episodes:
            assert settings.LEARNERS[setting.condition].method in TASKS[task].pictures
    assert set(settings.LARGER) <= set(TASKS)


@pytest.mark.parametrize(
    "name", ["keepaway-learning", "high-towers-learning", "color-learning", "arch-learning"]
)
def test_studies_have_their_names(name: str) -> None:
    assert STUDIES[name].name == name
