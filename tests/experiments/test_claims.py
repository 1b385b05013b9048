from __future__ import annotations

import math

from relforest.experiments.claims import Claim, Findings
from relforest.experiments.sheets import Passage, Sheet


def test_a_claim_is_met_inside_its_bounds_and_at_them() -> None:
    assert Claim("x", 0.5, low=0.5).verdict == "met"
    assert Claim("x", 0.5, low=0.1, high=0.5).verdict == "met"
    assert Claim("x", 0.5, high=0.4).verdict == "MISSED"
    assert Claim("x", math.nan, low=0.0).is_missed
    assert Claim("x", low=0.0, missing=("Fox",)).verdict == "not claimed"


def test_a_claim_says_its_number_and_its_bounds() -> None:
    assert str(Claim("score", 0.75, low=0.7)) == "met    score: 0.75 (at least 0.7)"
    assert str(Claim("rate", 0.2, low=0.03, high=0.07)) == "MISSED rate: 0.2 (at least 0.03 and at most 0.07)"


def test_findings_are_met_if_no_claim_is_missed() -> None:
    met, missed = Claim("a", 1.0, low=0.0), Claim("b", 1.0, high=0.0)

    assert Findings("text").are_met
    assert Findings("text", (met, Claim("c", low=0.0, missing=("Fox",)))).are_met
    assert not Findings("text", (met, missed)).are_met


def test_findings_are_laid_out_as_text_and_their_tables_as_markdown() -> None:
    met = Claim("a", 1.0, low=0.0)
    findings = Findings(
        "text", (met,), (Sheet("Scores", {"": "", "one": ".1f"}, (("a", 0.5),)), Passage("T:", "t"))
    )

    assert str(findings) == f"text\n\nScores\n   one\na  0.5\n\nT:\nt\n\nClaims\n{met}"
    assert findings.documents == {
        "tables.md": "Scores\n\n|  | one |\n| --- | ---: |\n| a | 0.5 |\n\nT:\n\n```\nt\n```\n"
    }
    assert str(Findings("text")) == "text"
    assert Findings("text").documents == {}
    assert str(Findings("", (met,))) == f"Claims\n{met}"


def test_findings_tell_what_is_not_claimed_once_per_reason() -> None:
    met = Claim("a", 1.0, low=0.0)
    left_out = (
        Claim("lead", missing=("Fox", "Tiger")),
        Claim("memory", missing=("Fox",)),
        Claim("time", missing=("Fox",)),
    )

    assert str(Findings("text", (*left_out[:1], met, *left_out[1:]))).splitlines()[2:] == [
        "Claims",
        str(met),
        "not claimed, because Fox, Tiger were left out: lead",
        "not claimed, because Fox was left out: memory; time",
    ]
