"""Bags of points, synthetic and published, and synthetic scenes for concept recovery.

Generators (`color`, `covariant1`, `between_scenes`, ...) take a `numpy.random.Generator` and return values
drawn from the distribution that their docstring states. `fetch_musk1` and its like return the published sets
of bags that multiple-instance learners are compared on, and `read_csv`, `read_arff` and `read_c45` your own.
From wherever they are, bags come as a `BagSet`: start there.
"""

from __future__ import annotations

from relforest.datasets.bag_set import About, BagSet
from relforest.datasets.catalogue import CATALOGUE
from relforest.datasets.concepts import between_scenes, figure41_scenes, yellow_scenes
from relforest.datasets.printed_colors import color
from relforest.datasets.published import (
    fetch,
    fetch_elephant,
    fetch_fox,
    fetch_musk1,
    fetch_musk2,
    fetch_mutagenesis_atoms,
    fetch_mutagenesis_bonds,
    fetch_mutagenesis_chains,
    fetch_thioredoxin,
    fetch_tiger,
    load_east_west,
)
from relforest.datasets.readers import read_arff, read_c45, read_csv
from relforest.datasets.synthetic_bags import covariant1, covariant2, disjunctive

__all__ = [
    "CATALOGUE",
    "About",
    "BagSet",
    "between_scenes",
    "color",
    "covariant1",
    "covariant2",
    "disjunctive",
    "fetch",
    "fetch_elephant",
    "fetch_fox",
    "fetch_musk1",
    "fetch_musk2",
    "fetch_mutagenesis_atoms",
    "fetch_mutagenesis_bonds",
    "fetch_mutagenesis_chains",
    "fetch_thioredoxin",
    "fetch_tiger",
    "figure41_scenes",
    "load_east_west",
    "read_arff",
    "read_c45",
    "read_csv",
    "yellow_scenes",
]
