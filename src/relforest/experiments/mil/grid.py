"""The grid of parameters that support vector machines are tuned on, and the choice among its points."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import product

from relforest.experiments.mil.steps import DONE, Step
from relforest.mil.peers import svm_grid


def grid_points(step: int) -> tuple[dict[str, float], ...]:
    """Return points of the source's grid, those with values nearest to the constant parameters first.

    Parameters
    ----------
    step : int
        1 for the whole grid of `svm_grid`; k for every k-th power, counted from the constant parameters.
    """
    axes = svm_grid("full")
    costs = _every(axes["C"], 10, step)
    factors = _every(axes["gamma_factor"], 2, step)
    return tuple({"C": cost, "gamma_factor": factor} for cost, factor in product(costs, factors))


def best_point(steps: Sequence[Step], points: Sequence[dict[str, float]]) -> dict[str, float] | None:
    """Return the point with the best mean score, the first of equals; None if all were stopped."""
    scored = [
        (float(str(step.values["pss"])), -number) for number, step in enumerate(steps) if step.state == DONE
    ]
    return points[-max(scored)[1]] if scored else None


def _every(values: Sequence[float], base: float, step: int) -> list[float]:
    """Return the values with exponents that differ from that of the constant one by multiples of the step."""
    return [value for value in values if round(math.log(value / values[0], base)) % step == 0]
