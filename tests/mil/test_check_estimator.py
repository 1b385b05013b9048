"""The full suite of scikit-learn's checks, nothing excused."""

from __future__ import annotations

from sklearn.utils.estimator_checks import check_estimator

from relforest import CovAggClassifier

# The number that scikit-learn 1.9.1 runs; older and newer versions may run fewer or more.
CHECKS_OF_1_9 = 56


def test_no_check_fails_and_none_is_skipped() -> None:
    results = check_estimator(CovAggClassifier(), on_fail=None, on_skip=None)
    outcomes = {result["check_name"]: (result["status"], result["exception"]) for result in results}

    assert {name: outcome for name, outcome in outcomes.items() if outcome[0] != "passed"} == {}
    assert not any(result["expected_to_fail"] for result in results)
    assert len(results) >= CHECKS_OF_1_9
