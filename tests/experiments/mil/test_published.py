from __future__ import annotations

import math

import numpy as np
import pytest

from relforest.experiments.mil.data import DATA_SETS
from relforest.experiments.mil.methods import METHODS
from relforest.experiments.mil.published import SCORES, TIMES
from relforest.experiments.sheets import Estimate

ABORTED = Estimate(math.nan)


@pytest.mark.parametrize(
    ("cell", "expected"),
    [
        (("color", "covagg"), Estimate(0.93, 0.01)),
        (("covariant1", "instance-margin-svm"), Estimate(0.39, 0.03, ">")),
        (("covariant1", "bag-margin-svm"), Estimate(0.73, 0.03)),
        (("disjunctive", "miles"), Estimate(0.47, 0.03, "<")),
        (("mutagenesis-bonds", "bag-margin-svm"), Estimate(0.0, None, ">")),
        (("thioredoxin", "bag-margin-svm"), ABORTED),
        (("thioredoxin", "miles"), Estimate(0.0)),
        (("fox", "optimal-ball"), Estimate(-0.06, 0.08, ">")),
        (("tiger", "em-dd"), Estimate(0.44, 0.14, "<")),
        (("covariant1", "bag-margin-svm-tuned"), Estimate(0.78, 0.01)),
        (("disjunctive", "instance-margin-svm-tuned"), Estimate(0.65, 0.02, "<")),
    ],
)
def test_scores_are_those_of_tables_32_and_33(cell: tuple[str, str], expected: Estimate) -> None:
    assert repr(SCORES[cell]) == repr(expected)


@pytest.mark.parametrize(
    ("cell", "expected"),
    [
        (("color", "bag-margin-svm"), Estimate(0.49, 0.02)),
        (("covariant2", "miles"), Estimate(0.16, 0.0, ">")),
        (("disjunctive", "instance-margin-svm"), Estimate(32.6, 5.2, "<")),
        (("musk2", "covagg"), Estimate(36.0, 5.3)),
        (("musk2", "dd"), Estimate(1358.0, 527.0, "<")),
        (("mutagenesis-chains", "instance-margin-svm"), Estimate(1775.0, 321.0, "<")),
        (("thioredoxin", "optimal-ball"), Estimate(8.56, 0.45, "<")),
        (("thioredoxin", "instance-margin-svm"), ABORTED),
        (("tiger", "instance-margin-svm"), Estimate(53.5, 26.5)),
    ],
)
def test_times_are_those_of_table_34(cell: tuple[str, str], expected: Estimate) -> None:
    assert repr(TIMES[cell]) == repr(expected)


def test_the_tables_are_whole() -> None:
    # 13 data sets and 7 methods, and 3 tuned ones on 4 data sets
    assert (len(SCORES), len(TIMES)) == (13 * 7 + 3 * 4, 13 * 7)
    for data_set, method in (*SCORES, *TIMES):
        assert data_set in DATA_SETS
        assert method in METHODS


def test_sums_of_columns() -> None:
    # Added up once more by hand from the printed tables: they guard against slips in single cells.
    def total(table: dict[tuple[str, str], Estimate], method: str) -> float:
        return sum(float(np.nan_to_num(cell.value)) for key, cell in table.items() if key[1] == method)

    assert total(dict(SCORES), "covagg") == pytest.approx(5.73)
    assert total(dict(SCORES), "optimal-ball") == pytest.approx(5.08)
    assert total(dict(TIMES), "covagg") == pytest.approx(116.82)
