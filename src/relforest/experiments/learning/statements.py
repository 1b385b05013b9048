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
    DONE,
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

_LARGER: Final = LARGER[0]
_RPI: Final = "smrf-rpi-500"
_RGB: Final = "smrf-rpi-500-rgb"
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


def _standing(_table: Table) -> Values:
    return np.array([STANDING])


def _of(section: str, *said: tuple[str, str, Judge]) -> tuple[Statement, ...]:
    return tuple(Statement(section, *each) for each in said)


_leaves: Final = partial(_after, column="leaves")
_small: Final = _after(TOWERS, "small-first")
_towers, _arch = _after(TOWERS, _RPI), _after(DONE, _RPI)
_few, _few_sarsa = (partial(_after, KEEPAWAY, name) for name in ("smrf-rpi-50", "cmac-sarsa-shared-50"))
_once: Final = _after(KEEPAWAY, "smrf-rpi-500-once", 500)
_long: Final = _after(KEEPAWAY, "smrf-rpi-500-long")
_shared: Final = _after(KEEPAWAY, "cmac-sarsa-shared-500")
_alone, _on_trees = (partial(_after, KEEPAWAY, name) for name in (SARSA, "sarsa-on-smrf"))
_there: Final = partial(_after, _LARGER)
_there_sarsa: Final = partial(_there, "cmac-sarsa-shared-4v3")

STATEMENTS: Final[Mapping[str, tuple[Statement, ...]]] = {
    TOWERS: _of(
        "7.4.1",
        ("SMRF-RPI improves on random play", "p < 1e-43", _improves(TOWERS, _RPI)),
        ("large-first is above SMRF-RPI", "p < 1e-40", above(_after(TOWERS, "large-first"), _towers)),
        ("small-first is above SMRF-RPI", "p < 1e-16", above(_small, _towers)),
        (
            "the best run of SMRF-RPI reaches the mean of small-first",
            "about",
            reached(_towers, _small, np.mean),
        ),
        ("SMRF-RPI: training and test are correlated", "R = .81, p < 1e-77", _correlated(TOWERS, _RPI)),
    ),
    COLORS: _of(
        "7.4.2",
        ("CIEDE2000: SMRF-RPI improves on random play", "p < 1e-19", _improves(COLORS, _RPI)),
        ("RGB: SMRF-RPI improves on random play", "p < 1e-19", _improves(RGB, _RGB)),
        *(
            (
                f"{name}: the hand-made policy is above SMRF-RPI",
                p,
                above(_after(world, "manual"), _after(world, own)),
            )
            for world, own, name, p in (
                (COLORS, _RPI, "CIEDE2000", "p < 1e-33"),
                (RGB, _RGB, "RGB", "p < 1e-35"),
            )
        ),
        (
            "more leaves with CIEDE2000 than with RGB",
            "p < .05",
            above(_leaves(COLORS, _RPI), _leaves(RGB, _RGB)),
        ),
    ),
    ARCH: _of(
        "7.4.3",
        ("SMRF-RPI improves on random play", "p < 1e-14", _improves(DONE, _RPI)),
        ("the trainer is above SMRF-RPI in the end", "p < .05", above(_after(ARCH, HAND[ARCH]), _arch)),
        (
            "SMRF-RPI is better after four batches than after three",
            "p < .01",
            above(_after(DONE, _RPI, 2000), _after(DONE, _RPI, 1500)),
        ),
        (
            "share of test episodes that end with an arch, best run in the end",
            "53 %",
            reached(_after(DONE, _RPI, column="paid"), _standing, np.max),
        ),
    ),
    KEEPAWAY: _of(
        "7.5.2",
        *(
            (
                f"50 episodes a batch: SMRF-RPI is above CMAC Sarsa after {count}",
                "p < 1e-7",
                above(_few(50 * count), _few_sarsa(50 * count)),
            )
            for count in range(1, 6)
        ),
        ("50 episodes a batch: no longer after 10", "p < .1", not_above(_few(500), _few_sarsa(500))),
        ("500 episodes a batch: CMAC Sarsa is above SMRF-RPI in the end", "p < 1e-14", above(_shared, _long)),
        (
            "the best run of SMRF-RPI then reaches the least of CMAC Sarsa",
            "about",
            reached(_long, _shared, np.min),
        ),
        (
            "SMRF-RPI: training and test are correlated",
            "R = .85, p < 1e-91",
            _correlated(KEEPAWAY, "smrf-rpi-500-long"),
        ),
        (
            "CMAC Sarsa: training and test are correlated",
            "R = .20, p < 1e-3",
            _correlated(KEEPAWAY, "cmac-sarsa-shared-500"),
        ),
        (
            "Sarsa on trees of SMRF-RPI is above CMAC Sarsa at first",
            "p < 1e-8",
            above(_on_trees(1000), _alone(1000)),
        ),
        (
            "CMAC Sarsa is above Sarsa on trees of SMRF-RPI in the end",
            "p < 1e-8",
            above(_alone(6000), _on_trees(6000)),
        ),
        ("SMRF-RPI is above Sarsa on its trees in the end", "Fig. 7.23", above(_long, _on_trees())),
        (
            "4 against 3, one batch: SMRF-RPI of 3 against 2 is above CMAC Sarsa",
            "p < 1e-18",
            above(_there("smrf-rpi-500-once", 500), _there_sarsa(500)),
        ),
        (
            "4 against 3, in the end: CMAC Sarsa is above SMRF-RPI of 3 against 2",
            "p < 1e-15",
            above(_there_sarsa(), _there("smrf-rpi-500-long")),
        ),
        *(
            (
                f"first batch: several rounds on 500 episodes are above {words}",
                "p < 1e-8",
                above(_once, _after(KEEPAWAY, name, first)),
            )
            for name, (words, first) in _VARIANTS.items()
        ),
        *(
            (
                f"in the end: several rounds on 500 episodes are no longer above {words}",
                "p < .05",
                # The source corrects for the number of comparisons.
                not_above(_long, _after(KEEPAWAY, name), LEVEL / len(_VARIANTS)),
            )
            for name, (words, _) in _VARIANTS.items()
        ),
        *(
            (
                f"more leaves after several rounds than after one, {size} episodes, {when}",
                "p < 1e-10",
                above(_leaves(KEEPAWAY, many, end), _leaves(KEEPAWAY, f"smrf-rpi-{size}-single", end)),
            )
            for size, when, many, end in (
                (50, "first batch", "smrf-rpi-50", 50),
                (500, "first batch", "smrf-rpi-500-once", 500),
                (50, "ten batches", "smrf-rpi-50", 500),
                (500, "ten batches", "smrf-rpi-500-long", 5000),
            )
        ),
    ),
}
"""Task -> what the source says about it."""
