from __future__ import annotations

import pytest

from experiments.mil.results import around, results_of, rows
from relforest.experiments.claims import Claim
from relforest.experiments.mil import settings
from relforest.experiments.mil.bounds import exceptions, verdicts
from relforest.experiments.mil.data import COMPARED, HELD_OUT
from relforest.experiments.mil.methods import IMPROVED, METHODS, PEERS
from relforest.experiments.mil.results import Results
from relforest.experiments.mil.settings import EXPLAINED, REPRODUCED
from relforest.experiments.table import Row
from relforest.metrics import SampleMoments, two_sample_p_value


def claims(results: Results) -> list[Claim]:
    return [verdict for verdict in verdicts(results, 300.0) if not verdict.missing]


def unclaimed(results: Results) -> list[Claim]:
    return [verdict for verdict in verdicts(results, 300.0) if verdict.missing]


def found(results: Results, part: str) -> list[Claim]:
    return [claim for claim in claims(results) if part in claim.name]


def test_scores_are_tested_against_the_sources() -> None:
    near = results_of(rows("covariant1", "covagg", pss=around(0.76)))
    above = results_of(rows("covariant1", "covagg", pss=around(0.95)))
    (same,), (other,) = (found(results, "not significantly different") for results in (near, above))

    assert same.measured == pytest.approx(1.0)
    # The source: .76 +- .02 of 100 draws, t(.975; 99) = 1.98422, so the deviation is .2 / 1.98422 = .1008.
    expected = two_sample_p_value(SampleMoments.of(around(0.95)), SampleMoments(0.76, 0.1008, 100))
    assert other.measured == pytest.approx(expected, rel=1e-2)
    assert (same.is_missed, other.is_missed) == (False, True)


def test_standard_sets_may_be_better_but_not_worse() -> None:
    # The source: .17 +- .14 of 10 folds, deviation .14 * sqrt 10 / 2.26216 = .1957; ours .1054.
    # Error of the difference: sqrt((.1957^2 + .1054^2) / 10) = .0703. -.2: t = 5.3; -.1: t = 1.0.
    for mean, is_met in ((0.6, True), (0.07, True), (-0.2, False)):
        (claim,) = found(results_of(rows("tiger", "covagg", pss=around(mean))), "not significantly below")
        assert claim.is_missed != is_met
    (claim,) = found(results_of(rows("tiger", "covagg", pss=around(0.6))), "not significantly below")
    assert claim.measured == 1.0


def test_a_score_on_synthetic_sets_may_miss_its_threshold_by_one_standard_error() -> None:
    # Deviation .1054 of ten scores: standard error .0333 below .26.
    for mean, is_met in ((0.23, True), (0.22, False)):
        (claim,) = found(results_of(rows("disjunctive", "covagg", pss=around(mean))), "at least")
        assert claim.low == pytest.approx(0.26 - 0.1054 / 10**0.5, abs=1e-4)
        assert claim.is_missed != is_met


def test_color_is_compared_with_nothing() -> None:
    results = results_of(rows("color", "covagg", pss=around(0.2)), rows("color", "em-dd", pss=around(0.2)))

    assert [claim.name for claim in claims(results) if "source" in claim.name] == []


def test_peers_are_near_the_source_or_explained(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(settings, "EXPLAINED", {("covariant1", "miles"): "another implementation"})
    results = results_of(
        rows("covariant2", "optimal-ball", pss=around(0.2)),
        rows("covariant2", "dd", pss=around(0.2)),
        rows("covariant2", "em-dd", pss=[None]),
        rows("covariant2", "apr", pss=around(0.9)),
        rows("covariant1", "miles", pss=around(0.41)),
        rows("disjunctive", "miles", pss=around(0.40)),
    )
    verdicts = {claim.name: not claim.is_missed for claim in found(results, "difference from the source")}

    assert verdicts == {
        "Covariant 2, OptBall: difference from the source": True,  # .20 - .13
        "Covariant 2, DD: difference from the source": False,  # .20 - .06
        "Covariant 2, EM-DD: difference from the source": False,
        "Disjunctive, MILES: difference from the source": True,  # .40 - .47
    }
    ((title, ours, source, reason),) = exceptions(results)
    assert (title, round(ours, 9), source) == ("Covariant 1, MILES", 0.41, 0.24)
    assert reason == "another implementation"


def test_the_fastest_of_the_slow_peers_counts() -> None:
    results = results_of(
        rows("musk2", "covagg", pss=[0.5, 0.5], seconds=[4.0, 6.0]),
        rows("musk2", "dd", pss=[None]),
        rows("musk2", "em-dd", pss=[0.5, 0.5], seconds=20.0),
        rows("musk2", "optimal-ball", pss=[0.5, 0.5], seconds=0.1),
        rows("elephant", "covagg", pss=[0.5, 0.5], seconds=5.0),
        rows("elephant", "dd", pss=[0.5, 0.5], seconds=1.0),
    )
    (ratio,), (longest,) = found(results, "fastest of"), found(results, "longest fold")

    assert ratio.name == "Musk 2: CPU time of the fastest of DD, EM-DD in CovAgg's"
    assert (ratio.measured, ratio.low) == (4.0, 1.0)
    assert (longest.measured, longest.high) == (6.0, 10.0)


def test_a_stopped_peer_needed_the_limit_at_least() -> None:
    results = results_of(
        rows("musk2", "covagg", pss=[0.5, 0.5], seconds=3.0), rows("musk2", "dd", pss=[None])
    )

    assert [claim.measured for claim in found(results, "fastest of")] == [100.0]


def test_covagg_itself_must_not_be_stopped() -> None:
    results = results_of(
        rows("musk2", "covagg", pss=[0.5, None]), rows("musk2", "dd", pss=[0.5, 0.5], seconds=1.0)
    )

    assert len(claims(results)) == 3
    assert all(claim.is_missed for claim in claims(results))


def whole() -> list[list[Row]]:
    parts = [rows(name, IMPROVED, pss=[0.5, 0.5]) for name in COMPARED]
    parts += [rows(name, "dd", pss=[0.3, 0.3]) for name in COMPARED]
    parts += [rows(name, "apr", pss=[0.45, 0.45] if name != "fox" else [None]) for name in COMPARED]
    return parts


def test_the_lead_is_claimed_over_all_data_sets_or_not_at_all() -> None:
    over_all, over_held_out = found(results_of(*whole()), "lead")
    title = METHODS[IMPROVED].title

    assert (
        over_all.name
        == f"lead of {title} in the mean score of 13 data sets, over the best of 2 baselines, APR"
    )
    assert (over_all.measured, over_held_out.measured) == pytest.approx((0.05, 0.05))
    without_color = results_of(*whole()[1:])
    (still,) = found(without_color, "lead")
    assert "8 data sets that it was not designed with" in still.name
    (not_made,) = (claim for claim in unclaimed(without_color) if "lead" in claim.name)
    assert not_made.name == f"lead of {title} in the mean score of 13 data sets, over the best peer"
    assert not_made.missing == (f"{title} on Color",)
    (alone, _) = (claim for claim in unclaimed(results_of(*whole()[: len(COMPARED)])) if "lead" in claim.name)
    assert alone.missing == ("every peer on at least one of them",)
    assert {"dd", "apr"} <= set(PEERS)


def test_sets_of_the_design_do_not_count_in_the_lead_over_those_held_out() -> None:
    designed = [rows(name, IMPROVED, pss=[1.0, 1.0]) for name in COMPARED if name not in HELD_OUT]
    others = [rows(name, IMPROVED, pss=[0.2, 0.2]) for name in HELD_OUT]
    peers = [rows(name, "dd", pss=[0.3, 0.3]) for name in COMPARED]
    over_all, over_held_out = found(results_of(*designed, *others, *peers), "lead")

    # (5 * 1 + 8 * .2) / 13 - .3 and .2 - .3
    assert over_all.measured == pytest.approx(6.6 / 13 - 0.3)
    assert over_held_out.measured == pytest.approx(-0.1)
    assert (over_all.is_missed, over_held_out.is_missed) == (False, True)


def test_what_is_missing_is_named_as_broadly_as_possible() -> None:
    results = results_of(
        rows("covariant1", "covagg", pss=around(0.76)),
        rows("covariant2", "dd", pss=around(0.1)),
        rows("covariant1", "optimal-ball", pss=around(0.4)),
    )
    missing = {claim.name: claim.missing for claim in unclaimed(results)}

    assert missing["Tiger: CovAgg not significantly below the source's, p"] == ("Tiger",)
    assert missing["Covariant 1, MILES: difference from the source"] == ("MILES",)
    assert missing["Covariant 1, DD: difference from the source"] == ("DD on Covariant 1",)
    assert missing["Covariant 2: CPU time of the fastest of DD in CovAgg's"] == ("CovAgg on Covariant 2",)
    assert missing["Thioredoxin: largest memory, MB"] == ("Thioredoxin",)
    assert "Covariant 1: CovAgg not significantly different from the source's, p" not in missing


def test_only_excesses_are_exceptions() -> None:
    # The source has .38 and .19.
    results = results_of(
        rows("covariant1", "em-dd", pss=around(0.47)), rows("disjunctive", "em-dd", pss=around(0.26))
    )

    ((title, ours, source, reason),) = exceptions(results)
    assert (title, round(ours, 9), source) == ("Covariant 1, EM-DD", 0.47, 0.38)
    assert reason.startswith("the source's program itself")


def test_explanations_rest_on_their_own_data_set() -> None:
    assert len(set(EXPLAINED.values())) == len(EXPLAINED)


def test_memory_is_that_of_the_largest() -> None:
    results = results_of(
        rows("thioredoxin", "dd", pss=[None], peak=300_000_000),
        rows("thioredoxin", "apr", pss=[0.1, 0.1], peak=1_200_000_000),
        rows("musk1", "apr", pss=[0.1, 0.1], peak=2_000_000_000),
    )
    (claim,) = found(results, "memory")

    assert (claim.name, claim.measured, claim.high) == (
        "Thioredoxin: largest memory, MB (APR)",
        1200.0,
        1000.0,
    )


def test_every_explanation_is_of_a_peer_that_would_be_compared() -> None:
    assert all(data_set in REPRODUCED and method in PEERS for data_set, method in EXPLAINED)
