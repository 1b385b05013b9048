from __future__ import annotations

import pytest

from relforest.experiments.mil_ablation.analysis import figures, loss, mean_over_sets, summarize
from relforest.experiments.mil_ablation.settings import COMMITTEE, PUBLISHED
from relforest.experiments.table import Table

SCORES = {
    ("covariant1", PUBLISHED): [0.7, 0.5],
    ("covariant1", COMMITTEE): [0.7, 0.7],
    ("disjunctive", PUBLISHED): [0.2, 0.2],
    ("disjunctive", COMMITTEE): [0.6, 0.6],
}
TABLE = Table.of(
    {"data_set": data_set, "variant": variant, "draw": draw, "pss": pss}
    for (data_set, variant), values in SCORES.items()
    for draw, pss in enumerate(values)
)


def test_means_over_sets() -> None:
    # (.6 + .2) / 2 and (.7 + .6) / 2
    assert mean_over_sets(TABLE, PUBLISHED) == pytest.approx(0.4)
    assert mean_over_sets(TABLE, COMMITTEE) == pytest.approx(0.65)


def test_losses_are_compared_draw_by_draw() -> None:
    # Differences 0, .2 (mean .1, squared standard error .01) and .4, .4 (0). Mean (.1 + .4) / 2, standard
    # error sqrt(.01) / 2 = .05 with one degree of freedom: t(.975; 1) = 12.7062.
    found = loss(TABLE, PUBLISHED)

    assert found.mean == pytest.approx(0.25)
    assert found.half_width == pytest.approx(0.635310, abs=1e-5)


def test_the_summary_has_a_row_per_variant_and_claims() -> None:
    findings = summarize(TABLE)

    assert "CovAgg     0.400  -0.250 +- 0.635         0.60         0.20" in findings.text
    assert [round(claim.measured, 9) for claim in findings.claims] == [0.25, 0.1]
    assert findings.are_met


def test_the_figure_has_a_line_per_variant_but_the_committee() -> None:
    (axes,) = figures(TABLE)["changes.png"].axes

    assert [label.get_text() for label in axes.get_yticklabels()] == [PUBLISHED]
