"""Synthetic data whose truth is known: bags for multiple-instance learning and scenes for concept recovery.

Every generator takes a `numpy.random.Generator` and returns values drawn from the distribution that its
docstring states. Start with `covariant1` for bags of points and `between_scenes` for scenes with arguments.
"""

from __future__ import annotations

from relforest.datasets.bags import BagSet, covariant1, covariant2, disjunctive
from relforest.datasets.concepts import between_scenes, figure41_scenes, yellow_scenes

__all__ = [
    "BagSet",
    "between_scenes",
    "covariant1",
    "covariant2",
    "disjunctive",
    "figure41_scenes",
    "yellow_scenes",
]
