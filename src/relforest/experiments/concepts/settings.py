"""The concepts, the learners, how many scenes they learn from, and the scores that trees must reach."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final, Literal, final

Learner = Literal["tree", "boosting", "forest", "rules"]


@final
@dataclass(frozen=True, slots=True)
class ConceptSetting:
    """One model: a concept, a learner and a seed."""

    concept: str  # a key of `TITLES`
    replicate: int  # number of the seed
    n_scenes: int = 500  # scenes in the training set, and in each test set
    alpha: float = 1e-3  # nominal level of the likelihood ratio test of a tree
    max_points: int = 100_000  # expansions of a tree with more points than this are sampled
    learner: Learner = "tree"  # a SMRF tree, or a model of `relforest.forests` with its default parameters

    @property
    def method(self) -> str:
        """The learner, and the level of a tree."""
        return f"tree, {self.alpha:g}" if self.learner == "tree" else self.learner

    def __str__(self) -> str:
        """Return the title of the concept, the method and the number of the seed."""
        return f"{TITLES[self.concept]}, {self.method}, seed {self.replicate}"


TITLES: Final[Mapping[str, str]] = {
    "between": "an object between A and B",
    "between-crowded": "the same among 20 more objects",
    "figure41": "the concept of Figure 4.1",
    "yellow": "a yellow object",
}

SAME: Final = "same"
LARGER: Final = "15 objects"
CROWDED: Final = "20 more objects"

N_OBJECTS: Final = (5, 8)
N_OBJECTS_LARGER: Final = 15
N_DISTRACTORS: Final = 20

THRESHOLDS: Final[Mapping[tuple[str, str], float]] = {
    ("between", SAME): 0.9,
    ("between", LARGER): 0.85,
    ("between-crowded", SAME): 0.85,
    ("figure41", SAME): 0.85,
    ("figure41", LARGER): 0.85,
    ("yellow", SAME): 0.85,
    ("yellow", LARGER): 0.85,
}
"""Mean test score to be reached, by concept and test scenes."""

STRICT_ALPHA: Final = 1e-3
"""The level at which the thresholds must be reached. The likelihood ratio test is anti-conservative: at 0.05
it lets more questions pass that only fit the noise (study ``calibration``)."""
ALPHAS: Final = (STRICT_ALPHA, 0.05)
STRICT_TREE: Final = ConceptSetting("between", 0, alpha=STRICT_ALPHA).method
OTHERS: Final[tuple[Learner, ...]] = ("boosting", "forest", "rules")

N_REPLICATES: Final = 8

SETTINGS: Final = tuple(
    ConceptSetting(concept, replicate, alpha=alpha)
    for alpha in ALPHAS
    for concept in TITLES
    for replicate in range(N_REPLICATES)
) + tuple(
    ConceptSetting(concept, replicate, learner=learner)
    for learner in OTHERS
    for concept in TITLES
    for replicate in range(N_REPLICATES)
)
SMOKE: Final = (
    ConceptSetting("between", 0, 16, max_points=150),
    ConceptSetting("yellow", 0, 16, alpha=0.05, max_points=150),
    ConceptSetting("yellow", 0, 16, max_points=150),
    ConceptSetting("yellow", 0, 16, learner="rules"),
)
