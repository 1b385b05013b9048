"""Facts about the published sets of bags of the comparison in Palmer (2015), section 3.3.2."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Final

from relforest.datasets.bag_set import About

__all__ = ["CATALOGUE", "EAST_WEST", "SHA256", "file_name"]

_MIL_PACKAGE: Final = "the Python package mil, version 1.0.5"
_MIDATASETS: Final = "komartom/MIDatasets.jl on GitHub, which took it from miproblems.org"
_MOLECULES: Final = (
    "rebuilt from the 188 molecules of the relational data in xflows/rdm on GitHub, by the rules that Weka's "
    "multi-instance files follow"
)
_LICENCE: Final = "MIT for the {} that the copy comes from, which states no terms for the data themselves"
_MUSK_LICENCE: Final = (
    f"{_LICENCE.format('package')}; UCI, where the set was first published, lists terms of its own"
)
_MUSK: Final = (
    "Dietterich, Lathrop and Lozano-Perez (1997), Solving the multiple instance problem with axis-parallel "
    "rectangles, Artificial Intelligence 89:31-71"
)
_MUTAGENESIS: Final = (
    "Srinivasan, Muggleton, King and Sternberg (1994), Mutagenesis: ILP experiments in a non-determinate "
    "biological domain; as bags: Reutemann, Pfahringer and Frank (2004), A toolbox for learning from "
    "relational data with propositional and multi-instance learners"
)
_THIOREDOXIN: Final = (
    "Wang, Scott, Zhang, Tao, Fomenko and Gladyshev (2004), A study in modeling low-conservation protein "
    "superfamilies, University of Nebraska-Lincoln"
)
_IMAGES: Final = (
    "Andrews, Tsochantaridis and Hofmann (2003), Support vector machines for multiple-instance learning, "
    "Advances in Neural Information Processing Systems 15"
)
_CONSTANT: Final = "{} of the 230 features are constant, 87 of them zero."
_MOLECULE_NOTES: Final = (
    "Counts equal those of Weka's file; bags come in another order. Positive: the molecule is mutagenic. "
)

_SETS: Final = (
    About(
        "musk1",
        "Musk 1",
        92,
        47,
        476,
        166,
        f"{_MIL_PACKAGE}; its bags equal those of garydoranjr/misvm and komartom/MIDatasets.jl on GitHub",
        _MUSK_LICENCE,
        _MUSK,
        "A bag is a molecule, an instance one of its shapes. Integers of up to some hundreds, not scaled.",
    ),
    About(
        "musk2",
        "Musk 2",
        102,
        39,
        6598,
        166,
        _MIL_PACKAGE,
        _MUSK_LICENCE,
        _MUSK,
        "As Musk 1, with bags of 1 to 1044 instances.",
    ),
    About(
        "elephant",
        "Elephant",
        200,
        100,
        1391,
        230,
        f"{_MIL_PACKAGE}; its bags equal those of komartom/MIDatasets.jl on GitHub",
        _LICENCE.format("package"),
        _IMAGES,
        f"A bag is an image, an instance one of its segments. {_CONSTANT.format(120)}",
    ),
    About(
        "fox",
        "Fox",
        200,
        100,
        1320,
        230,
        _MIDATASETS,
        _LICENCE.format("repository"),
        _IMAGES,
        f"As Elephant; stored in single precision. Some papers count 1302 instances. {_CONSTANT.format(108)}",
    ),
    About(
        "tiger",
        "Tiger",
        200,
        100,
        1220,
        230,
        _MIDATASETS,
        _LICENCE.format("repository"),
        _IMAGES,
        f"As Elephant; stored in single precision. {_CONSTANT.format(106)}",
    ),
    About(
        "mutagenesis_atoms",
        "Mutagenesis atoms",
        188,
        125,
        1618,
        10,
        _MOLECULES,
        _LICENCE.format("repository"),
        _MUTAGENESIS,
        f"{_MOLECULE_NOTES}An instance is a distinct atom: charge, type, and whether it is each of the eight "
        "elements br, c, cl, f, h, i, n, o, in this order.",
    ),
    About(
        "mutagenesis_bonds",
        "Mutagenesis bonds",
        188,
        125,
        3995,
        16,
        _MOLECULES,
        _LICENCE.format("repository"),
        _MUTAGENESIS,
        f"{_MOLECULE_NOTES}An instance is a bond between two different atoms. The order of its two ends, "
        "and so of some columns, was not checked against a copy of Weka's file.",
    ),
    About(
        "mutagenesis_chains",
        "Mutagenesis chains",
        188,
        125,
        5349,
        24,
        _MOLECULES,
        _LICENCE.format("repository"),
        _MUTAGENESIS,
        f"{_MOLECULE_NOTES}An instance is a chain of two bonds.",
    ),
    About(
        "thioredoxin",
        "Thioredoxin",
        193,
        25,
        26611,
        8,
        f"{_MIL_PACKAGE}, with its scaling undone; rows of four bags equal those of Weka's file",
        _LICENCE.format("package"),
        _THIOREDOXIN,
        "A bag is a protein, an instance a position of its sequence. Integers, the features on very "
        "different scales.",
    ),
)
CATALOGUE: Final[Mapping[str, About]] = MappingProxyType({about.name: about for about in _SETS})

EAST_WEST: Final = About(
    "east_west",
    "East-West",
    20,
    10,
    213,
    24,
    "Weka's multi-instance data; we do not know a copy that may be redistributed",
    "unknown",
    "Michie, Muggleton, Page and Srinivasan (1994), To the international computing community: a new "
    "East-West challenge, Oxford University Computing Laboratory",
    "A bag is a train. That an instance is an ordered pair of its cars is an inference, as we have not seen "
    "the file: the 20 trains of the challenge have 213 such pairs.",
)

SHA256: Final[Mapping[str, str]] = MappingProxyType(
    {
        "musk1.csv.gz": "c2f528d76d806c0a4b4bcbf6f31902ed929e5a1d28f6123a82c5794ad03a50a6",
        "musk2.csv.gz": "1bded005e2f69128470f24a0ccc97773492c2dbe8abbdb8a6fd2653f6bab629b",
        "elephant.csv.gz": "03d4c852d00e3fbc9ef36448f7c39f41d2ed2a33905856d414c716c202a1bac2",
        "fox.csv.gz": "30cc887adcf0778c819f018ee2586bba1a99cb218f3e1c0bae316e49618ebaee",
        "tiger.csv.gz": "07df6e861497fa18fe3f1d9a02dac86419bd8e2bc350981cd430607d5664e425",
        "mutagenesis_atoms.csv.gz": "cacd4bd254b52c03a6aa63a5453d81d4db98a29328435364cf36b2e0451e5556",
        "mutagenesis_bonds.csv.gz": "7341af9ea8cdab590898118366ccfe0b54ae168665dfd04ddc82911f33505c82",
        "mutagenesis_chains.csv.gz": "70b013d684ccc82f3b76cf4d90d19f4b11ad96d4dbf450d750065c2a94689557",
        "thioredoxin.csv.gz": "9aa99506ee3cfa10c923d07c1a96e2ddb9f4d8691b75cfefb36ddc47f2ef7557",
    }
)


def file_name(name: str) -> str:
    """Return the name of the file of a data set."""
    return f"{name}.csv.gz"
