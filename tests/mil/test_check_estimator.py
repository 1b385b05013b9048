"""The full suite of scikit-learn's checks on every classifier of bags, nothing excused."""

from __future__ import annotations

import pytest
from sklearn.utils.estimator_checks import check_estimator

from interpreted import compiled_only
from relforest import mil
from relforest.mil import baselines
from relforest.mil.bag_classifier import BagClassifier
from relforest.mil.volume_committee import VolumeCommitteeClassifier

# The number that scikit-learn 1.9.1 runs; older and newer versions may run fewer or more.
CHECKS_OF_1_9 = 56
CLASSIFIERS = [
    found
    for package in (mil, baselines)
    for name in package.__all__
    if isinstance(found := getattr(package, name), type) and issubclass(found, BagClassifier)
]

# The defaults of this one serve the quality of predictions and take long without the compiler.
OPTIONS = {VolumeCommitteeClassifier: {"n_splits": 2, "n_volumes": 4, "n_balls": 60}}


@compiled_only
@pytest.mark.parametrize("classifier", CLASSIFIERS, ids=lambda classifier: classifier.__name__)
def test_no_check_fails_and_none_is_skipped(classifier: type[BagClassifier]) -> None:
    results = check_estimator(classifier(**OPTIONS.get(classifier, {})), on_fail=None, on_skip=None)
    outcomes = {result["check_name"]: (result["status"], result["exception"]) for result in results}

    assert {name: outcome for name, outcome in outcomes.items() if outcome[0] != "passed"} == {}
    assert not any(result["expected_to_fail"] for result in results)
    assert len(results) >= CHECKS_OF_1_9
