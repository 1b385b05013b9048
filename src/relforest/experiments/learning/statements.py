"""What sections 7.4 and 7.5 of the source say about learning, by task, and how it is judged here.

References
----------
Palmer (2015), sections 7.4.1 to 7.4.3 and 7.5.2.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from itertools import pairwise
from typing import Final

import numpy as np

from relforest.experiments.learning.settings import (
    ARCH,
    COLORS,
    HAND,
    KEEPAWAY,
    LARGER,
    RGB,
    SARSA,
    STANDING,
    TOWERS,
)
from relforest.experiments.statements import (
    LEVEL,
    Judge,
    Sample,
    Statement,
    Values,
    above,
    correlated,
    not_above,
    reached,
)
from relforest.experiments.table import Table

END: Final = -1
"""Stands for the training episodes of the last policy."""

_PUBLISHED: Final = "smrf-rpi-500"
_LONG: Final = "smrf-rpi-500-long"
_ONCE: Final = "smrf-rpi-500-once"
_SHARED: Final = "cmac-sarsa-shared-500"
_LARGER: Final = LARGER[0]
_VARIANTS: Final = {
    "smrf-rpi-50": ("several rounds on 50 episodes", 50),
    "smrf-rpi-500-single": ("one round on 500", 500),
    "smrf-rpi-500-single-tree": ("one round and one tree on 500", 500),
    "smrf-rpi-50-single": ("one round on 50", 50),
}
"""Variants of several rounds on 500 episodes -> what they are, and the episodes of their first batch."""


def measured(table: Table, played: str, condition: str, episodes: int, column: str = "reward") -> Values:
    """Return a column of all runs of a condition after so many training episodes, (runs,), maybe none."""
    own = [row for row in table.rows if (row["played"], row["condition"]) == (played, condition)]
    wanted = max((int(row["episodes"] or 0) for row in own), default=0) if episodes == END else episodes
    kept = [row[column] for row in own if row["episodes"] == wanted and row[column] is not None]
    return np.array(kept, dtype=np.float64)


def training_and_test(table: Table, played: str, condition: str) -> tuple[Values, Values]:
    """Return the rewards of all policies of a condition in training and in tests, (n_policies,) each.

    Policies are tested before the batch in which they are trained further, and those before learning are left
    out, because all play alike. From every reward the mean of all runs at that time is taken away, as the
    source does.
    """
    own = [row for row in table.rows if (row["played"], row["condition"]) == (played, condition)]
    episodes = sorted({int(row["episodes"] or 0) for row in own})
    found: tuple[list[Values], list[Values]] = ([], [])
    for now, later in pairwise(episodes[1:]):
        both = (measured(table, played, condition, *what) for what in ((later, "train"), (now, "reward")))
        for values, deviations in zip(both, found, strict=True):
            deviations.append(values - values.mean())
    train, test = (np.concatenate(each) if each else np.empty(0) for each in found)
    return train, test


def _after(played: str, condition: str, episodes: int = END, column: str = "reward") -> Sample:
    return partial(measured, played=played, condition=condition, episodes=episodes, column=column)


def _improves(played: str, condition: str) -> Judge:
    return above(_after(played, condition), _after(played, condition, 0))


def _correlated(played: str, condition: str) -> Judge:
    return correlated(partial(training_and_test, played=played, condition=condition))


_in_keepaway: Final = partial(_after, KEEPAWAY)
_in_larger: Final = partial(_after, _LARGER)
_leaves: Final = partial(_after, column="leaves")
_few, _few_sarsa = (partial(_in_keepaway, name) for name in ("smrf-rpi-50", "cmac-sarsa-shared-50"))

STATEMENTS: Final[Mapping[str, tuple[Statement, ...]]] = {
    TOWERS: (
        Statement("7.4.1", "SMRF-RPI improves on random play", "p < 1e-43", _improves(TOWERS, _PUBLISHED)),
        *(
            Statement(
                "7.4.1",
                f"{policy} is above SMRF-RPI",
                source,
                above(_after(TOWERS, policy), _after(TOWERS, _PUBLISHED)),
            )
            for policy, source in (("large-first", "p < 1e-40"), ("small-first", "p < 1e-16"))
        ),
        Statement(
            "7.4.1",
            "the best run of SMRF-RPI reaches the mean of small-first",
            "about",
            reached(_after(TOWERS, _PUBLISHED), _after(TOWERS, "small-first"), np.mean),
        ),
        Statement(
            "7.4.1",
            "training and test rewards of SMRF-RPI are correlated",
            "R = .81, p < 1e-77",
            _correlated(TOWERS, _PUBLISHED),
        ),
    ),
    COLORS: (
        *(
            statement
            for played, condition, name, p in (
                (COLORS, _PUBLISHED, "CIEDE2000", "p < 1e-33"),
                (RGB, "smrf-rpi-500-rgb", "RGB", "p < 1e-35"),
            )
            for statement in (
                Statement(
                    "7.4.2",
                    f"{name}: SMRF-RPI improves on random play",
                    "p < 1e-19",
                    _improves(played, condition),
                ),
                Statement(
                    "7.4.2",
                    f"{name}: the hand-made policy is above SMRF-RPI",
                    p,
                    above(_after(played, HAND[COLORS]), _after(played, condition)),
                ),
            )
        ),
        Statement(
            "7.4.2",
            "more leaves with CIEDE2000 than with RGB",
            "p < .05",
            above(_leaves(COLORS, _PUBLISHED), _leaves(RGB, "smrf-rpi-500-rgb")),
        ),
    ),
    ARCH: (
        Statement("7.4.3", "SMRF-RPI improves on random play", "p < 1e-14", _improves(ARCH, _PUBLISHED)),
        Statement(
            "7.4.3",
            "the trainer is above SMRF-RPI in the end",
            "p < .05",
            above(_after(ARCH, HAND[ARCH]), _after(ARCH, _PUBLISHED)),
        ),
        Statement(
            "7.4.3",
            "SMRF-RPI is better after four batches than after three",
            "p < .01",
            above(_after(ARCH, _PUBLISHED, 2000), _after(ARCH, _PUBLISHED, 1500)),
        ),
        Statement(
            "7.4.3",
            "share of test episodes that end with an arch, best run in the end",
            "53 %",
            reached(_after(ARCH, _PUBLISHED, column="paid"), lambda _table: np.array([STANDING]), np.max),
        ),
    ),
    KEEPAWAY: (
        *(
            Statement(
                "7.5.2",
                f"50 episodes a batch: SMRF-RPI is above CMAC Sarsa after {count}",
                "p < 1e-7",
                above(_few(50 * count), _few_sarsa(50 * count)),
            )
            for count in range(1, 6)
        ),
        Statement(
            "7.5.2",
            "50 episodes a batch: no longer after 10",
            "p < .1",
            not_above(_few(500), _few_sarsa(500)),
        ),
        Statement(
            "7.5.2",
            "500 episodes a batch: CMAC Sarsa is above SMRF-RPI in the end",
            "p < 1e-14",
            above(_in_keepaway(_SHARED), _in_keepaway(_LONG)),
        ),
        Statement(
            "7.5.2",
            "the best run of SMRF-RPI then reaches the least of CMAC Sarsa",
            "about",
            reached(_in_keepaway(_LONG), _in_keepaway(_SHARED), np.min),
        ),
        Statement(
            "7.5.2",
            "training and test rewards of SMRF-RPI are correlated",
            "R = .85, p < 1e-91",
            _correlated(KEEPAWAY, _LONG),
        ),
        Statement(
            "7.5.2",
            "training and test rewards of CMAC Sarsa are correlated",
            "R = .20, p < 1e-3",
            _correlated(KEEPAWAY, _SHARED),
        ),
        Statement(
            "7.5.2",
            "Sarsa on trees of SMRF-RPI is above CMAC Sarsa at first",
            "p < 1e-8",
            above(_in_keepaway("sarsa-on-smrf", 1000), _in_keepaway(SARSA, 1000)),
        ),
        Statement(
            "7.5.2",
            "CMAC Sarsa is above Sarsa on trees of SMRF-RPI in the end",
            "p < 1e-8",
            above(_in_keepaway(SARSA, 6000), _in_keepaway("sarsa-on-smrf", 6000)),
        ),
        Statement(
            "7.5.2",
            "SMRF-RPI is above Sarsa on its trees in the end",
            "",
            above(_in_keepaway(_LONG), _in_keepaway("sarsa-on-smrf")),
        ),
        Statement(
            "7.5.2",
            "4 against 3, one batch: SMRF-RPI of 3 against 2 is above CMAC Sarsa",
            "p < 1e-18",
            above(_in_larger(_ONCE, 500), _in_larger("cmac-sarsa-shared-4v3", 500)),
        ),
        Statement(
            "7.5.2",
            "4 against 3, in the end: CMAC Sarsa is above SMRF-RPI of 3 against 2",
            "p < 1e-15",
            above(_in_larger("cmac-sarsa-shared-4v3"), _in_larger(_LONG)),
        ),
        *(
            Statement(
                "7.5.2",
                f"first batch: several rounds on 500 episodes are above {words}",
                "p < 1e-8",
                above(_in_keepaway(_ONCE, 500), _in_keepaway(name, first)),
            )
            for name, (words, first) in _VARIANTS.items()
        ),
        *(
            Statement(
                "7.5.2",
                f"in the end: several rounds on 500 episodes are no longer above {words}",
                "p < .05",
                # The source corrects for the number of comparisons.
                not_above(_in_keepaway(_LONG), _in_keepaway(name), LEVEL / len(_VARIANTS)),
            )
            for name, (words, _) in _VARIANTS.items()
        ),
        *(
            Statement(
                "7.5.2",
                f"more leaves after several rounds than after one, {size} episodes, {when}",
                "p < 1e-10",
                above(_leaves(KEEPAWAY, many, end), _leaves(KEEPAWAY, f"smrf-rpi-{size}-single", end)),
            )
            for size, when, many, end in (
                (50, "first batch", "smrf-rpi-50", 50),
                (500, "first batch", _ONCE, 500),
                (50, "ten batches", "smrf-rpi-50", 500),
                (500, "ten batches", _LONG, 5000),
            )
        ),
    ),
}
"""Task -> what the source says about it."""
