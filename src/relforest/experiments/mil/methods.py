"""The methods that are compared: what each is called, and how its learner is made."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Final, TypeAlias, final

import numpy as np

from relforest.mil import CovAggClassifier, VolumeCommitteeClassifier
from relforest.mil.bag_classifier import BagClassifier
from relforest.mil.baselines import (
    APRClassifier,
    BagMarginSVMClassifier,
    DiverseDensityClassifier,
    EMDDClassifier,
    InstanceMarginSVMClassifier,
    MILESClassifier,
    OptimalBallClassifier,
    SingleInstanceSVMClassifier,
)

Parameters: TypeAlias = Mapping[str, float]
"""Parameters of a tuned learner by name; empty for the others."""


@final
@dataclass(frozen=True, slots=True)
class Method:
    """A method with its parameters."""

    title: str  # as tables have it
    key: int  # its number in the names of random streams; never given to another one
    estimator: Callable[..., Any]
    """Makes the learner from keyword arguments. If its parameters include ``random_state``, it is given
    one."""
    is_tuned: bool = False  # whether ``C`` and ``gamma_factor`` are chosen on separate draws of each data set

    def learner(self, seed: np.random.SeedSequence, parameters: Parameters) -> BagClassifier:
        """Make a learner that has not learned anything.

        The parameters are those that differ from the defaults.
        """
        learner = self.estimator(**parameters)
        if "random_state" in learner.get_params():
            learner.set_params(random_state=int(seed.generate_state(1)[0]))
        made: BagClassifier = learner
        return made


COVAGG: Final = "covagg"
IMPROVED: Final = "volume-committee"
OPTIMAL_BALL: Final = "optimal-ball"
DD: Final = "dd"
EM_DD: Final = "em-dd"
APR: Final = "apr"
INSTANCE_MARGIN: Final = "instance-margin-svm"
BAG_MARGIN: Final = "bag-margin-svm"
MILES: Final = "miles"
SINGLE_INSTANCE: Final = "single-instance-svm"

METHODS: Final[Mapping[str, Method]] = {
    COVAGG: Method("CovAgg", 0, CovAggClassifier),
    IMPROVED: Method("committee", 1, VolumeCommitteeClassifier),
    OPTIMAL_BALL: Method("OptBall", 2, OptimalBallClassifier),
    DD: Method("DD", 3, DiverseDensityClassifier),
    EM_DD: Method("EM-DD", 4, EMDDClassifier),
    APR: Method("APR", 5, APRClassifier),
    INSTANCE_MARGIN: Method("mi-SVM", 6, InstanceMarginSVMClassifier),
    BAG_MARGIN: Method("MI-SVM", 7, BagMarginSVMClassifier),
    MILES: Method("MILES", 8, MILESClassifier),
    SINGLE_INSTANCE: Method("SI-SVM", 9, SingleInstanceSVMClassifier),
    f"{INSTANCE_MARGIN}-tuned": Method("mi-SVM*", 10, InstanceMarginSVMClassifier, is_tuned=True),
    f"{BAG_MARGIN}-tuned": Method("MI-SVM*", 11, BagMarginSVMClassifier, is_tuned=True),
    f"{MILES}-tuned": Method("MILES*", 12, MILESClassifier, is_tuned=True),
}
"""Name on the command line -> method, in the order of the tables; those of the source have its columns."""

PEERS: Final = tuple(
    name for name, method in METHODS.items() if name not in (COVAGG, IMPROVED) and not method.is_tuned
)
"""Single methods by others."""
