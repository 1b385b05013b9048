"""What the source says about its forests, as tests: our numbers, p values, and whether it holds here."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import product
from typing import Final

from scipy.stats import ttest_1samp

from relforest.experiments.outcomes.settings import BALANCE, CURVE, KEEPAWAY, LARGE, SIZES, SMALL, TASKS
from relforest.experiments.samples import Samples
from relforest.experiments.sheets import Estimate, Sheet
from relforest.metrics import SampleMoments, two_sample_p_value

_LEVEL: Final = 0.05
_NEARLY: Final = 0.95
_MANY: Final = 0.25
_FOREST: Final = f"{CURVE[-1]} + {CURVE[-1]}"
_SMALL_FOREST: Final = f"{CURVE[4]} + {CURVE[4]}"

Statement = tuple[str, Estimate, float, str]


def statements(samples: Samples) -> Sheet:
    """List the statements of section 5.3 about which something was measured."""
    caption = (
        f"The source's statements about {_FOREST} SMRF trees (section 5.3), with a linear machine on a\n"
        "second set of scenes (+-: 95 % of the mean over draws of trees), p by t-tests over these draws"
    )
    found = [
        *_nearly_perfect(samples),
        *_transfers(samples),
        *_own_or_transferred(samples),
        *_saturates(samples),
    ]
    rows = (*found, *_stubs(samples))
    return Sheet(caption, {"the source says": "", "here": ".3f", "p": ".1e", "": ""}, rows)


def _verdict(*, holds: bool) -> str:
    return "holds" if holds else "does not hold"


def _nearly_perfect(samples: Samples) -> Iterator[Statement]:
    for size in SIZES:
        scores = samples["protocol", BALANCE, size, size, _FOREST, "pss"]
        if len(scores):
            mean = Estimate.of(scores)
            name = f"balance scale, {size} scenes: nearly perfect"
            yield name, mean, math.nan, _verdict(holds=mean.value >= _NEARLY)


def _transfers(samples: Samples) -> Iterator[Statement]:
    for task, (trained, tested) in product(TASKS, ((SMALL, LARGE), (LARGE, SMALL))):
        scores = samples["protocol", task, trained, tested, _FOREST, "pss"]
        if len(scores) > 1:
            # The same score in all draws is as certain as can be.
            p = float(ttest_1samp(scores, 0.0).pvalue) if scores.std() else 0.0
            name = f"{TASKS[task]}, {trained} to {tested} scenes: above chance"
            yield name, Estimate.of(scores), p, _verdict(holds=scores.mean() > 0.0 and p < _LEVEL)


def _own_or_transferred(samples: Samples) -> Iterator[Statement]:
    own, other = (samples["protocol", KEEPAWAY, trained, LARGE, _FOREST, "pss"] for trained in (LARGE, SMALL))
    if min(len(own), len(other)) > 1:
        lead = Estimate.of(other).minus(Estimate.of(own))
        p = two_sample_p_value(SampleMoments.of(own), SampleMoments.of(other))
        name = "keepaway, 4 against 3: better predicted by a forest from 3 against 2 (its lead)"
        yield name, lead, p, _verdict(holds=lead.value > 0.0 and p < _LEVEL)


def _saturates(samples: Samples) -> Iterator[Statement]:
    for task in TASKS:
        few, many = (samples["protocol", task, SMALL, SMALL, n, "pss"] for n in (_SMALL_FOREST, _FOREST))
        if min(len(few), len(many)) > 1 and few.std() + many.std() > 0.0:
            lost = Estimate.of(many).minus(Estimate.of(few))
            p = two_sample_p_value(SampleMoments.of(many), SampleMoments.of(few))
            name = f"{TASKS[task]}, small scenes: {_SMALL_FOREST} trees are enough (what they lose)"
            yield name, lost, p, _verdict(holds=not (lost.value > 0.0 and p < _LEVEL))


def _stubs(samples: Samples) -> Iterator[Statement]:
    share = samples["protocol", KEEPAWAY, LARGE, LARGE, "all trees", "stubs"]
    if len(share):
        value = float(share.mean())
        name = "keepaway, 4 against 3: many trees without questions (their share)"
        yield name, Estimate(value), math.nan, _verdict(holds=value >= _MANY)
