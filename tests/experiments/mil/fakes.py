"""Small data sets, and a method that is right or wrong by its parameters."""

from __future__ import annotations

from typing import Self, final

import numpy as np
from numpy.typing import NDArray

from relforest.datasets import BagSet
from relforest.experiments.mil.data import Standard, Synthetic
from relforest.experiments.mil.methods import Method


@final
class Threshold:
    """Calls a bag positive whose largest first component is above a threshold."""

    def __init__(self, *, C: float = 1.0, gamma_factor: float = 1.0) -> None:
        self.threshold = C * gamma_factor

    def get_params(self) -> dict[str, float]:
        return {}

    def fit(self, bags: list[NDArray[np.float64]], y: NDArray[np.bool_]) -> Self:
        assert len(bags) == len(y)
        return self

    def predict(self, bags: list[NDArray[np.float64]]) -> NDArray[np.bool_]:
        return np.array([bag[:, 0].max() > self.threshold for bag in bags])


def draw_steps(rng: np.random.Generator, n_bags: int) -> BagSet:
    """Bags of two points below 1; positive ones also have a point between 1.5 and 2.5."""
    labels = np.arange(n_bags) % 2 == 0
    points = rng.random((n_bags, 3, 2))
    points[labels, 0, 0] = rng.uniform(1.5, 2.5, labels.sum())
    return BagSet(list(points), labels)


def fetch_steps() -> BagSet:
    """Return 23 such bags that are there once."""
    return draw_steps(np.random.default_rng(0), 23)


DRAWN = Synthetic("Steps", 0, draw_steps)
FIXED = Standard("Fixed steps", 1, fetch_steps)
FAKES = {
    "covagg": Method("Threshold", 0, Threshold),
    "miles-tuned": Method("Threshold*", 2, Threshold, is_tuned=True),
}
