from __future__ import annotations

from collections.abc import Iterable

import numpy as np
import pytest

from relforest.experiments.blocks.analysis import settle_numbers, summarize
from relforest.experiments.blocks.pictures import figures
from relforest.experiments.blocks.settings import (
    ARCHES,
    BALANCE,
    COLOR_REFERENCE,
    COLORS,
    GROUPS,
    LIFT,
    LIFT_REFERENCE,
    OPTION_REFERENCE,
    OUTCOMES,
    POLICIES,
    RANDOM,
    SCENARIOS,
    SETTLE,
    SETTLE_REFERENCE,
    SPEED,
    TOWERS,
)
from relforest.experiments.samples import Samples
from relforest.experiments.table import Row, Table


def rows(part: str, condition: str, measure: str, values: Iterable[float]) -> list[Row]:
    return [
        {"part": part, "condition": condition, "chunk": 0, "measure": measure, "value": float(value)}
        for value in values
    ]


def table(*, gain: float = 1.0) -> Table:
    """Return what a study finds that agrees with all references; each policy gains more than those before."""
    found: list[Row] = []
    for scenario in SCENARIOS:
        reference = SETTLE_REFERENCE[scenario, "author's simulator"]
        # The median lies at the reference, and so does the mean.
        offsets = np.array([-50, -10, 0, 10, 50 + 5 * (reference["mean"] - reference["median"])])
        found += rows(SETTLE, scenario, "steps", offsets + reference["median"])
        found += rows(SETTLE, scenario, "height", [3.0, 3.5])
    for size, (author, _) in LIFT_REFERENCE.items():
        found += rows(LIFT, size, "steps", [float(author)])
    for part, policies in POLICIES.items():
        for place, policy in enumerate(policies):
            # Color grouping has two pairs of a random and a manual policy.
            level = gain * place + (1.0 if part == TOWERS else 0.0)
            found += rows(part, policy, "total", level + np.array([-0.01, 0.0, 0.01]))
    for policy in POLICIES[ARCHES]:
        found += rows(ARCHES, policy, "stands", [0.0, 0.0, 1.0])
    for (part, policy, measure), (known, _) in OPTION_REFERENCE.items():
        found += rows(part, policy, measure, [known - 0.001, known + 0.001])
    for sampling, colors in COLOR_REFERENCE.items():
        for name, value in colors.items():
            found += rows(COLORS, sampling, name, [value])
    found += rows(OUTCOMES, BALANCE, "decided", [1.0, 1.0, 1.0, 0.0])
    found += rows(OUTCOMES, BALANCE, "label", [1.0, 0.0, 0.0])
    found += rows(SPEED, RANDOM, "milliseconds", [20.0, 20.0])
    found += rows(SPEED, RANDOM, "steps", [4000.0, 4400.0])
    return Table.of(found)


def test_settling_is_summed_up() -> None:
    samples = Samples.of(
        Table.of(rows(SETTLE, "x", "steps", [100, 200, 600, 300]) + rows(SETTLE, "x", "height", [1, 2])),
        *("part", "condition", "measure"),
    )

    found = settle_numbers(samples, "x")
    # 90 % of the way from the first to the fourth of four is 0.7 of the way from 300 to 600.
    assert found == {
        "n": 4,
        "mean": 300,
        "median": 250,
        "p90": pytest.approx(510),
        "max": 600,
        "over": 0.25,
        "height": 1.5,
    }


def test_every_claim_is_met_where_all_is_as_in_the_references() -> None:
    missed = [str(claim) for claim in summarize(table()).claims if claim.is_missed]

    assert missed == []


def test_policies_must_be_ordered() -> None:
    missed = {claim.name for claim in summarize(table(gain=0.0)).claims if claim.is_missed}

    assert "high towers, large-first above small-first: lower end of the 95 % interval" in missed
    assert "color grouping, manual above random: lower end of the 95 % interval" in missed
    assert "arch, careful above trainer: lower end of the 95 % interval" in missed
    assert len(missed) == 6


def test_numbers_stand_beside_their_references() -> None:
    lines = [line.split() for line in str(summarize(table())).splitlines()]

    assert ["5", "x", "5", "410", "410", "401"] in lines
    # n, mean and interval (1.96 * sqrt(2) * 0.001 / sqrt(2) rounds to 0), deviation, both references.
    assert any(line[-7:] == ["2", "8.98", "+-", "0.00", "0.00", "8.98", "8.63"] for line in lines)
    assert [*BALANCE.split(), "4", "0.75", "+-", "0.49", "0.33", "+-", "0.65"] in lines
    # 4200 steps in 20 ms.
    assert ["random", "20.0", "+-", "0.0", "4200", "210,000"] in lines


def test_there_is_a_picture_of_each_part() -> None:
    found = figures(table())

    assert set(found) == {"settle.png", "options.png", "totals.png"}
    assert [axes.get_title(loc="left") for axes in found["settle.png"].axes] == list(SCENARIOS)
    durations, successes = found["options.png"].axes
    shown = len(durations.get_yticklabels()) + len(successes.get_yticklabels())
    # All but the number of steps of an episode and the height at its beginning.
    assert shown == len(OPTION_REFERENCE) - 2
    assert len(found["totals.png"].axes) == len((TOWERS, GROUPS, ARCHES))
