"""Policy iteration by regression: returns and a model of them are computed in turn."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final, TypeVar

import numpy as np

from relforest.rl.fitted.evidence import Evidence, check_values
from relforest.rl.vectors.approximator import Model, Rows
from relforest.scenes.arrays import FloatArray
from relforest.support.progress import report

Known = TypeVar("Known", bound=Model)

TRACE: Final = 0.9
"""Lambda of the returns, as in `relforest.rl.fitted.CurveSettings`."""
_SETTLED: Final = 0.02


def swept(
    before: Known | None, evidence: Evidence, rows: Rows, fit: Callable[[FloatArray], Known], sweeps: int
) -> Known:
    """Return a model of the returns of its own greedy policy.

    If nothing was known before, the first returns are those of the policy of the experience. The rows are the
    candidates of the evidence; `fit` turns what the actions taken are worth, (n,), into a model, at most
    `sweeps` times.

    Raises
    ------
    InputError
        If values exceed what the rewards allow.

    References
    ----------
    Ernst, Geurts and Wehenkel, Tree-based batch mode reinforcement learning (2005).
    """
    targets = evidence.earned() if before is None else evidence.targets(before.values(rows), TRACE)
    sweep = 0
    while True:
        report("policy iteration", sweep, sweeps)
        found, sweep = fit(targets), sweep + 1
        values = found.values(rows)
        check_values(values, evidence)
        following = evidence.targets(values, TRACE)
        if sweep == sweeps or np.abs(following - targets).mean() < _SETTLED * evidence.scale:
            return found
        targets = following
