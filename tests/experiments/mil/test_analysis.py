from __future__ import annotations

import pytest

from experiments.mil.results import around, rows
from relforest.experiments.mil.analysis import seconds_format, summarize
from relforest.experiments.table import Table

TABLE = Table.of(
    [
        *rows("covariant1", "covagg", pss=around(0.75), seconds=0.01),
        *rows("covariant1", "optimal-ball", pss=around(0.45), seconds=0.02),
        *rows("covariant1", "miles", pss=around(0.41), seconds=0.5),
        *rows("covariant1", "miles-tuned", pss=around(0.70), chosen=(100.0, 0.25)),
        *rows("thioredoxin", "covagg", pss=around(0.2), seconds=2.5),
        *rows("thioredoxin", "optimal-ball", pss=[None]),
    ]
)


def test_every_table_has_ours_and_the_sources_numbers() -> None:
    lines = str(summarize(TABLE)).splitlines()

    def cells(begin: str, count: int = 2) -> list[str]:
        at = lines.index(begin)
        return [" ".join(line.split()) for line in lines[at + 2 : at + 2 + count]]

    # Half widths: 2.2622 * .1054 / sqrt 10 = .0754
    scores = next(line for line in lines if line.startswith("Marks > and <:"))
    assert cells(scores, 4) == [
        "Covariant 1 0.75 +- 0.08 > 0.45 +- 0.08 > 0.41 +- 0.08",
        "source 0.76 +- 0.02 > 0.46 +- 0.02 > 0.24 +- 0.03",
        "Thioredoxin 0.20 +- 0.08 -",
        "source 0.13 +- 0.14 0.30 +- 0.21 0.00",
    ]
    assert cells("Mean Peirce skill score, parameters tuned on separate draws") == [
        "Covariant 1 0.70 +- 0.08",
        "source 0.73 +- 0.02",
    ]
    assert cells("Tuned parameters: C, factor of the heuristic gamma", 1) == ["Covariant 1 100, 0.25"]
    assert cells("CPU time in that of OptBall", 1) == ["Covariant 1 0.50 1.00 25.0"]
    overall = next(line for line in lines if line.startswith("Mean over the data sets"))
    # Of these two only Thioredoxin was held out.
    assert cells(overall, 3) == [
        "CovAgg 2 0 0.475 0.475 1 0 0.200 0.200",
        "OptBall 2 1 0.225 0.450 1 1 0.000",
        "MILES 1 0 0.410 0.410 0 0",
    ]
    seconds = next(line for line in lines if line.startswith("Mean CPU seconds"))
    assert cells(seconds, 2) == [
        "Covariant 1 0.010 < 0.020 < 0.50",
        "source 0.57 +- 0.02 < 0.92 +- 0.01 > 0.15 +- 0.00",
    ]


def test_the_tables_are_written_as_markdown_too() -> None:
    findings = summarize(TABLE)
    (name,) = findings.documents

    assert name == "tables.md"
    assert (
        "| Covariant 1 | 0.75 \u00b1 0.08 | > 0.45 \u00b1 0.08 | > 0.41 \u00b1 0.08 |"
        in findings.documents[name]
    )
    assert findings.claims


def test_one_cell_is_enough() -> None:
    assert "Musk 1" in str(summarize(Table.of(rows("musk1", "miles", pss=[0.5, 0.6]))))
    assert "Musk 1" in str(summarize(Table.of(rows("musk1", "miles", pss=[None]))))
    assert "Color" in str(summarize(Table.of(rows("color", "miles-tuned", pss=[0.5, 0.6]))))


def test_claims_that_cannot_be_made_are_told() -> None:
    lines = str(summarize(TABLE)).splitlines()
    untold = [line for line in lines if line.startswith("not claimed")]
    reasons = [line.partition(" left out: ")[0] for line in untold]

    assert untold[0].startswith(
        "not claimed, because Covariant 2 was left out: Covariant 2: CovAgg not significantly different from "
        "the source's, p; "
    )
    assert "; Covariant 2, OptBall: difference from the source; " in untold[0]
    assert lines.index(untold[0]) > lines.index("Claims")
    assert len(set(reasons)) == len(reasons)
    assert sum("lead of committee" in line for line in untold) == 2


@pytest.mark.parametrize(
    ("seconds", "form"),
    [
        (1358, ".0f"),
        (36.0, ".1f"),
        (10.2, ".1f"),
        (4.21, ".2f"),
        (0.47, ".2f"),
        (0.047, ".3f"),
        (1e-7, ".4f"),
        (0, ".2f"),
    ],
)
def test_times_have_as_many_digits_as_in_the_source(seconds: float, form: str) -> None:
    assert seconds_format(seconds) == form


def test_known_differences_are_told_with_the_reason() -> None:
    table = Table.of(rows("covariant1", "em-dd", pss=around(0.47)))

    assert "Covariant 1, EM-DD  0.47    0.38  the source's program itself" in str(summarize(table))
