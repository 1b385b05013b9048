from __future__ import annotations

import pytest

from relforest.experiments.calibration.analysis import Rate, figures, rates, summarize
from relforest.experiments.calibration.settings import SETTINGS
from relforest.experiments.table import Row, Table


def rows(test: str, objects: str, n_sets: int, n_accepted: int) -> list[Row]:
    return [
        {
            "test": test,
            "objects": objects,
            "scenes": 100,
            "block": 0,
            "set": number,
            "accepted": number < n_accepted,
        }
        for number in range(n_sets)
    ]


def test_rates_are_shares_of_accepted_sets() -> None:
    table = Table.of([*rows("likelihood-ratio", "1", 10, 4), *rows("permutation", "3-5", 20, 1)])

    assert list(rates(table)) == [Rate("likelihood-ratio", "1", 10, 4), Rate("permutation", "3-5", 20, 1)]
    assert [found.rate for found in rates(table)] == [0.4, 0.05]


def test_the_interval_is_the_central_95_percent_of_a_binomial() -> None:
    # Binomial(400, .05): Pr(X <= 11) = .019, Pr(X <= 12) = .035; Pr(X <= 28) = .971, Pr(X <= 29) = .982
    assert Rate("permutation", "3-5", 400, 20).interval == (12 / 400, 29 / 400)


@pytest.mark.parametrize(("accepted", "is_met"), [(11, False), (12, True), (29, True), (30, False)])
def test_the_permutation_test_must_lie_inside(accepted: int, is_met: bool) -> None:  # noqa: FBT001
    table = Table.of(
        [
            *rows("likelihood-ratio", "3-5", 400, 300),
            *rows("permutation", "1", 400, 30),
            *rows("permutation", "3-5", 400, accepted),
        ]
    )
    findings = summarize(table)

    assert [claim.is_missed for claim in findings.claims] == [not is_met]
    assert "likelihood-ratio      3-5   400       300  0.750             0.030 to 0.072      no" in str(
        findings
    )


def test_the_figure_has_a_line_per_rate() -> None:
    table = Table.of([*rows("likelihood-ratio", "1", 4, 2), *rows("permutation", "3-5", 4, 0)])
    (axes,) = figures(table)["rates.png"].axes

    labels = [label.get_text() for label in axes.get_yticklabels()]
    assert labels == ["likelihood-ratio, 1 objects", "permutation, 3-5 objects"]


def test_every_rate_is_measured_on_at_least_400_sets() -> None:
    sets: dict[tuple[str, str], int] = {}
    for setting in SETTINGS:
        sets[setting.test, setting.objects] = sets.get((setting.test, setting.objects), 0) + setting.n_sets

    assert ("permutation", "3-5") in sets
    assert ("likelihood-ratio", "3-5") in sets
    assert min(sets.values()) >= 400
