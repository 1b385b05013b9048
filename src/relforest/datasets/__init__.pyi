from . import readers
from .assumption_bags import false_frequency, poisoned_presence, poisoned_threshold
from .bag_set import About, BagSet
from .catalogue import CATALOGUE
from .concepts import between_scenes, figure41_scenes, yellow_scenes
from .printed_colors import color
from .published import (
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
from .readers import read_arff, read_c45, read_csv
from .synthetic_bags import covariant1, covariant2, disjunctive

__all__ = [
    "CATALOGUE",
    "About",
    "BagSet",
    "between_scenes",
    "color",
    "covariant1",
    "covariant2",
    "disjunctive",
    "false_frequency",
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
    "poisoned_presence",
    "poisoned_threshold",
    "read_arff",
    "read_c45",
    "read_csv",
    "readers",
    "yellow_scenes",
]
