from __future__ import annotations

from collections.abc import Mapping, Sequence

import pytest

from relforest.experiments.mil_ablation.analysis import change, figures, mean_over_sets, summarize
from relforest.experiments.mil_ablation.settings import COMMITTEE, MODELLED, PUBLISHED, TITLES
from relforest.experiments.table import Table

SCORES = {
    ("covariant1", PUBLISHED): [0.7, 0.5],
    ("covariant1", COMMITTEE): [0.7, 0.7],
    ("disjunctive", PUBLISHED): [0.2, 0.2],
    ("disjunctive", COMMITTEE): [0.6, 0.6],
}
SETS = ("covariant1", "disjunctive")


def table(scores: Mapping[tuple[str, str], Sequence[float]]) -> Table:
    return Table.of(
        {"data_set": data_set, "variant": variant, "draw": draw, "pss": pss}
        for (data_set, variant), values in scores.items()
        for draw, pss in enumerate(values)
    )


TABLE = table(SCORES)


def test_means_over_sets() -> None:
    # (.6 + .2) / 2 and (.7 + .6) / 2
    assert mean_over_sets(TABLE, PUBLISHED, SETS) == pytest.approx(0.4)
    assert mean_over_sets(TABLE, COMMITTEE, SETS) == pytest.approx(0.65)
    assert mean_over_sets(TABLE, COMMITTEE, ["disjunctive"]) == pytest.approx(0.6)


def test_changes_are_compared_draw_by_draw() -> None:
    # Differences 0, -.2 (mean -.1, squared standard error .01) and -.4, -.4 (0). Mean (-.1 - .4) / 2,
    # standard error sqrt(.01) / 2 = .05 with one degree of freedom: t(.975; 1) = 12.7062.
    found = change(TABLE, PUBLISHED, SETS)

    assert found.value == pytest.approx(-0.25)
    assert found.spread == pytest.approx(0.635310, abs=1e-5)


def test_the_summary_has_a_row_per_variant_and_claims() -> None:
    findings = summarize(TABLE)

    assert "CovAgg     0.400  -0.250 +- 0.635         0.60         0.20" in str(findings)
    assert [round(claim.measured, 9) for claim in findings.claims if not claim.missing] == [0.25, 0.1]
    assert findings.are_met


def test_sets_modelled_on_published_ones_are_left_out_of_second_means() -> None:
    more = {**SCORES, ("rare", PUBLISHED): [0.0, 0.0], ("rare", COMMITTEE): [0.5, 0.5]}
    (sheet,) = summarize(table(more)).parts
    lines = sheet.to_text().splitlines()

    # (.6 + .2 + 0) / 3 and a change of -(.1 + .4 + .5) / 3, then those without the last
    assert " ".join(lines[-2].split()[:9]) == "CovAgg 0.267 -0.333 +- 0.424 0.400 -0.250 +- 0.635"
    assert lines[-1].split()[:3] == ["committee", "0.600", "0.650"]
    assert "mean*" in lines[-3]
    assert any(line.startswith("*: without") and "(rare)" in line for line in lines)
    assert "*" not in summarize(TABLE).parts[0].caption
    assert set(MODELLED) <= set(TITLES)


def test_claims_about_sets_left_out_are_told() -> None:
    assert [claim.missing for claim in summarize(TABLE).claims] == [(), (), ("Covariant 2",)]


def test_the_figure_has_a_line_per_variant_but_the_committee() -> None:
    (axes,) = figures(TABLE)["changes.png"].axes

    assert [label.get_text() for label in axes.get_yticklabels()] == [PUBLISHED]
