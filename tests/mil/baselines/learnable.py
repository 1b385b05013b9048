"""Bags with a concept that every peer can learn, and laws that any of them must keep."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
N_BAGS, SIZE = 30, 3
Y = np.arange(N_BAGS) % 2


def squeezed(seed: int = 0, d: int = 2) -> Floats:
    """Bags (30, 3, d) of points 2 to 8 away from (4, ..., 4); the odd ones hold a point near it somewhere."""
    rng = np.random.default_rng(seed)
    bags = rng.standard_normal((N_BAGS, SIZE, d))
    bags *= rng.uniform(2, 8, (N_BAGS, SIZE, 1)) / np.linalg.norm(bags, axis=2, keepdims=True)
    bags += 4
    for bag in range(1, N_BAGS, 2):
        bags[bag, rng.integers(SIZE)] = 4 + 0.3 * rng.standard_normal(d)
    return bags
