from __future__ import annotations

import math

from relforest.experiments.claims import Claim, Findings, Unclaimed


def test_a_claim_is_met_inside_its_bounds_and_at_them() -> None:
    assert Claim("x", 0.5, low=0.5).is_met
    assert Claim("x", 0.5, low=0.1, high=0.5).is_met
    assert not Claim("x", 0.5, high=0.4).is_met
    assert not Claim("x", math.nan, low=0.0).is_met


def test_a_claim_says_its_number_and_its_bounds() -> None:
    assert str(Claim("score", 0.75, low=0.7)) == "met    score: 0.75 (at least 0.7)"
    assert str(Claim("rate", 0.2, low=0.03, high=0.07)) == "MISSED rate: 0.2 (at least 0.03 and at most 0.07)"


def test_findings_are_met_if_all_claims_are() -> None:
    met, missed = Claim("a", 1.0, low=0.0), Claim("b", 1.0, high=0.0)

    assert Findings("text").are_met
    assert Findings("text", (met,)).are_met
    assert not Findings("text", (met, missed)).are_met
    assert str(Findings("text")) == "text"
    assert str(Findings("text", (met, missed))) == f"text\n\nClaims\n{met}\n{missed}"


def test_findings_tell_what_is_not_claimed_once_per_reason() -> None:
    met = Claim("a", 1.0, low=0.0)
    left_out = (
        Unclaimed("lead", ("Fox", "Tiger")),
        Unclaimed("memory", ("Fox",)),
        Unclaimed("time", ("Fox",)),
    )
    findings = Findings.of("text", (*left_out[:1], met, *left_out[1:]))

    assert (findings.claims, findings.unclaimed) == ((met,), left_out)
    assert findings.are_met
    assert str(findings).splitlines()[2:] == [
        "Claims",
        str(met),
        "not claimed, because Fox, Tiger were left out: lead",
        "not claimed, because Fox was left out: memory; time",
    ]
    assert "not claimed" in str(Findings("text", unclaimed=left_out))
