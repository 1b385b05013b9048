from __future__ import annotations

from relforest.experiments.resume.analysis import summarize
from relforest.experiments.table import Row, Table


def row(variant: str, moment: int, differing: str = "") -> Row:
    return {
        "variant": variant,
        "moment": moment,
        "fraction": 0.25,
        "seconds": 1.5,
        "signal": "SIGKILL to the first",
        "alive": True,
        "survivors": moment,
        "iterations": 2,
        "files": 12,
        "differing": differing,
        "identical": not differing,
    }


TABLE = Table.of(
    [row("one", 0), row("one", 1), row("two", 0), row("two", 1, "metrics.jsonl trees/0001-left-1.json")]
)


def test_no_file_may_differ_and_no_process_survive() -> None:
    findings = summarize(TABLE)

    assert [(claim.measured, claim.verdict) for claim in findings.claims] == [
        *((0.0, "met"), (1.0, "MISSED")),
        *((1.0, "MISSED"), (1.0, "MISSED")),
    ]
    assert "no  metrics.jsonl trees/0001-left-1.json" in str(findings)
    lines = [line.split() for line in str(findings).splitlines()]
    assert ["0.250", "1.50", "SIGKILL", "to", "the", "first", "yes", "1", "2", "12", "yes"] in lines
