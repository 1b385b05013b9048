from __future__ import annotations

import pytest

from relforest.experiments.mil.data import DATA_SETS
from relforest.experiments.mil.methods import METHODS
from relforest.experiments.mil.published import SCORES, TIMES, Published


@pytest.mark.parametrize(
    ("cell", "expected"),
    [
        (("color", "covagg"), Published(0.93, 0.01)),
        (("covariant1", "instance-margin-svm"), Published(0.39, 0.03, ">")),
        (("covariant1", "bag-margin-svm"), Published(0.73, 0.03)),
        (("disjunctive", "miles"), Published(0.47, 0.03, "<")),
        (("mutagenesis-bonds", "bag-margin-svm"), Published(0.0, None, ">")),
        (("thioredoxin", "bag-margin-svm"), Published(None)),
        (("thioredoxin", "miles"), Published(0.0)),
        (("fox", "optimal-ball"), Published(-0.06, 0.08, ">")),
        (("tiger", "em-dd"), Published(0.44, 0.14, "<")),
        (("covariant1", "bag-margin-svm-tuned"), Published(0.78, 0.01)),
        (("disjunctive", "instance-margin-svm-tuned"), Published(0.65, 0.02, "<")),
    ],
)
def test_scores_are_those_of_tables_32_and_33(cell: tuple[str, str], expected: Published) -> None:
    assert SCORES[cell] == expected


@pytest.mark.parametrize(
    ("cell", "expected"),
    [
        (("color", "bag-margin-svm"), Published(0.49, 0.02)),
        (("covariant2", "miles"), Published(0.16, 0.0, ">")),
        (("disjunctive", "instance-margin-svm"), Published(32.6, 5.2, "<")),
        (("musk2", "covagg"), Published(36.0, 5.3)),
        (("musk2", "dd"), Published(1358.0, 527.0, "<")),
        (("mutagenesis-chains", "instance-margin-svm"), Published(1775.0, 321.0, "<")),
        (("thioredoxin", "optimal-ball"), Published(8.56, 0.45, "<")),
        (("thioredoxin", "instance-margin-svm"), Published(None)),
        (("tiger", "instance-margin-svm"), Published(53.5, 26.5)),
    ],
)
def test_times_are_those_of_table_34(cell: tuple[str, str], expected: Published) -> None:
    assert TIMES[cell] == expected


def test_the_tables_are_whole() -> None:
    # 13 data sets and 7 methods, and 3 tuned ones on 4 data sets
    assert (len(SCORES), len(TIMES)) == (13 * 7 + 3 * 4, 13 * 7)
    for data_set, method in (*SCORES, *TIMES):
        assert data_set in DATA_SETS
        assert method in METHODS


def test_sums_of_columns() -> None:
    # Added up once more by hand from the printed tables: they guard against slips in single cells.
    def total(table: dict[tuple[str, str], Published], method: str) -> float:
        return sum(cell.mean or 0 for key, cell in table.items() if key[1] == method)

    assert total(dict(SCORES), "covagg") == pytest.approx(5.73)
    assert total(dict(SCORES), "optimal-ball") == pytest.approx(5.08)
    assert total(dict(TIMES), "covagg") == pytest.approx(116.82)
