"""Slow twins of the multiple-instance baselines, written plainly from the papers.

Letters: n points in d dimensions, b bags; a box has lower and upper bounds (2, d).
"""

from __future__ import annotations

import itertools
import math
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Booleans = NDArray[np.bool_]

CERTAINTY = 1.0 - 1e-6


def negative_log_density(bags: list[Floats], positive: Booleans, centre: Floats, scales: Floats) -> float:
    """Multiply the noisy-or probabilities of all labels (Maron and Lozano-Perez 1997), in exact fractions."""
    product = Fraction(1)
    for bag, label in zip(bags, positive, strict=True):
        p = CERTAINTY * np.exp(-((scales * (bag - centre)) ** 2).sum(axis=1))
        none = math.prod(1 - Fraction(value) for value in p.tolist())
        product *= 1 - none if label else none
    return math.log(product.denominator) - math.log(product.numerator)


def alternate(bags: list[Floats], positive: Booleans, start: Floats) -> tuple[float, Floats, Floats]:
    """EM-DD from one instance (Zhang and Goldman 2001): density of the witnesses, centre and scales."""
    d, best = len(start), math.inf
    centre, scales = start, np.ones(d)
    for _ in range(10):
        rows = [((scales * (bag - centre)) ** 2).sum(axis=1).argmin() for bag in bags]
        nearest = [bag[[row]] for bag, row in zip(bags, rows, strict=True)]

        def value_at(flat: Floats, chosen: list[Floats] = nearest) -> float:
            return negative_log_density(chosen, positive, flat[:d], flat[d:])

        found = minimize(value_at, np.concatenate([centre, scales]), method="BFGS")
        if not found.fun < best:
            break
        best, centre, scales = found.fun, found.x[:d], found.x[d:]
    return best, centre, scales


def best_ball(bags: list[Floats], positive: Booleans) -> tuple[int, float]:
    """Most training bags that a ball can label rightly, and the largest radius that does so."""
    best = (-1, -1.0)
    for bag in itertools.compress(bags, positive):
        for centre in bag:
            distances = np.array([np.sqrt(((other - centre) ** 2).sum(axis=1)).min() for other in bags])
            edges = np.unique(distances)
            radii = [*(edges[1:] + edges[:-1]) / 2, edges[-1] * (1 + 1e-9)]
            best = max([best, *((int(((distances <= r) == positive).sum()), float(r)) for r in radii)])
    return best


def size(points: Floats) -> float:
    """Sum of the widths of the box around points (n, d)."""
    return float((points.max(axis=0) - points.min(axis=0)).sum())


def grow(bags: list[Floats]) -> list[int]:
    """Which point of each bag greedy growing with backfitting chooses (Dietterich et al. 1997)."""
    maxima, minima = [bag.max(axis=0) for bag in bags], [bag.min(axis=0) for bag in bags]
    centre = (np.min(maxima, axis=0) + np.max(minima, axis=0)) / 2
    seeds = [((bag - centre) ** 2).sum(axis=1).min() for bag in bags]
    first = int(np.argmin(seeds))
    chosen = {first: int(((bags[first] - centre) ** 2).sum(axis=1).argmin())}
    while len(chosen) < len(bags):
        members = np.array([bags[bag][row] for bag, row in chosen.items()])
        options = [
            (size(np.vstack([members, point])), bag, row)
            for bag, points in enumerate(bags)
            if bag not in chosen
            for row, point in enumerate(points)
        ]
        _, bag, row = min(options)
        chosen[bag] = row
        backfit(bags, chosen)
    return [chosen[bag] for bag in range(len(bags))]


def backfit(bags: list[Floats], chosen: dict[int, int]) -> None:
    """Let each bag in turn choose again, until none wants to."""
    changed = True
    while changed:
        changed = False
        for bag in sorted(chosen):
            others = [bags[other][row] for other, row in chosen.items() if other != bag]
            sizes = [size(np.vstack([*others, point])) for point in bags[bag]]
            if min(sizes) < sizes[chosen[bag]] - 1e-9:
                chosen[bag], changed = int(np.argmin(sizes)), True
