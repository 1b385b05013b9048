from __future__ import annotations

import pytest

from relforest.experiments.covagg.analysis import figures, scores, standard_error, summarize
from relforest.experiments.covagg.settings import EXPECTED, TITLES
from relforest.experiments.table import Table


def table(**pss: list[float]) -> Table:
    return Table.of(
        {"data_set": name.replace("_", "-"), "pair": pair, "pss": value}
        for name, values in pss.items()
        for pair, value in enumerate(values)
    )


def test_scores_are_means_with_student_intervals() -> None:
    found = scores(table(covariant2=[0.1, 0.2, 0.3], disjunctive=[0.5, 0.5, 0.5]))

    # sd .1, standard error .1 / sqrt 3 = .057735, t(.975; 2) = 4.302653: half width .248413
    assert found["covariant2"].mean == pytest.approx(0.2)
    assert found["covariant2"].half_width == pytest.approx(0.248413, abs=1e-6)
    assert found["disjunctive"].half_width == 0.0


def test_a_score_may_miss_its_threshold_by_one_standard_error() -> None:
    # Thresholds .24 and .26; standard error .1 / sqrt 4 * sqrt(4 / 3) = .0577
    met = table(covariant2=[0.1, 0.3, 0.1, 0.3])
    missed = table(disjunctive=[0.1, 0.3, 0.1, 0.3])

    assert standard_error(met, "covariant2") == pytest.approx(0.057735, abs=1e-6)
    assert [claim.is_met for claim in summarize(met).claims] == [True]
    assert [claim.is_met for claim in summarize(missed).claims] == [False]
    assert summarize(missed).claims[0].low == pytest.approx(0.26 - 0.057735, abs=1e-6)


def test_the_summary_names_every_data_set_and_the_sources_score() -> None:
    text = summarize(table(covariant1_sqrt2=[0.7, 0.8], covariant1_printed=[0.9, 0.94])).text

    assert "Covariant 1, means at distance 2  0.750 +- 0.635       0.050  0.76 +- 0.02       0.75" in text
    assert "Covariant 1, means as printed" in text


def test_the_figure_has_a_line_per_data_set() -> None:
    (axes,) = figures(table(covariant2=[0.1, 0.2], disjunctive=[0.3, 0.4]))["scores.png"].axes

    assert [label.get_text() for label in axes.get_yticklabels()] == ["Covariant 2", "Disjunctive"]


def test_every_data_set_has_an_expectation() -> None:
    assert set(EXPECTED) == set(TITLES)
