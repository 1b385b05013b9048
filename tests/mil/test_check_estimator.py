"""The full suite of scikit-learn's checks on every classifier of bags."""

from __future__ import annotations

from typing import Any

import pytest
from sklearn.utils.estimator_checks import check_estimator

from interpreted import compiled_only
from relforest import mil
from relforest.mil import baselines
from relforest.mil.bag_classifier import BagClassifier, WeightedBagClassifier
from relforest.mil.volume_committee import VolumeCommitteeClassifier

# The number that scikit-learn 1.9.1 runs; older and newer versions may run fewer or more.
CHECKS_OF_1_9 = 55
CLASSIFIERS = [
    found
    for package in (mil, baselines)
    for name in package.__all__
    if isinstance(found := getattr(package, name), type) and issubclass(found, BagClassifier)
]

# The defaults of this one serve the quality of predictions and take long without the compiler.
OPTIONS: dict[type[BagClassifier], dict[str, Any]] = {
    VolumeCommitteeClassifier: {"n_splits": 2, "n_volumes": 4, "n_balls": 60}
}
# Scikit-learn excuses its own machines by LIBSVM, and what cross-validates, from this check: repeated bags
# change the kernel width, what is sampled, and the splits that probabilities of three classes come from.
EQUIVALENCE = {
    "check_sample_weight_equivalence_on_dense_data": "repetition changes widths, samples and splits"
}


@compiled_only
@pytest.mark.parametrize("classifier", CLASSIFIERS, ids=lambda classifier: classifier.__name__)
def test_no_other_check_fails_and_none_is_skipped(classifier: type[BagClassifier]) -> None:
    excused = EQUIVALENCE if issubclass(classifier, WeightedBagClassifier) else {}
    results = check_estimator(
        classifier(**OPTIONS.get(classifier, {})), expected_failed_checks=excused, on_fail=None, on_skip=None
    )
    outcomes = {result["check_name"]: (result["status"], result["exception"]) for result in results}

    failed = {name: outcome for name, outcome in outcomes.items() if outcome[0] != "passed"}
    assert {name: outcome for name, outcome in failed.items() if name not in excused} == {}
    assert len(results) >= CHECKS_OF_1_9
