"""The published sets of bags of Palmer (2015), section 3.3.2, by name.

Musk 1 is part of the package; `relforest.datasets.download` describes where the other files are looked for.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import replace
from typing import TypeAlias

from relforest.datasets.bag_set import About, BagSet
from relforest.datasets.catalogue import CATALOGUE, EAST_WEST, SHA256, file_name
from relforest.datasets.download import data_file
from relforest.datasets.readers.arff import read_relation
from relforest.datasets.readers.csv_table import Columns, parse_csv
from relforest.scenes.sources import unpacked
from relforest.support.errors import DataError
from relforest.support.options import one_of

Folder: TypeAlias = str | os.PathLike[str]


def fetch(name: str, *, data_home: Folder | None = None, base_url: str | None = None) -> BagSet:
    """Return one of the published sets of bags.

    Parameters
    ----------
    name : str
        A key of `CATALOGUE`, such as ``"musk1"``.
    data_home : path, optional
        The cache; by default a folder ``relforest`` among the user's caches.
    base_url : str, optional
        Address of the folder to download from; by default that of the environment variable
        ``RELFOREST_DATA_URL``. Without either nothing is downloaded.

    Returns
    -------
    BagSet
        With counts, source and licence in ``about``.

    Raises
    ------
    InputError
        If the set does not exist.
    DataError
        If its file is neither in the folder of the environment variable ``RELFOREST_DATA`` nor in the cache
        and cannot be downloaded, or is not the published one; the message says what to do.

    References
    ----------
    Palmer (2015), section 3.3.2.
    """
    return read_published(
        CATALOGUE[one_of("name", name, tuple(CATALOGUE))], SHA256, data_home=data_home, base_url=base_url
    )


def read_published(
    about: About, registry: Mapping[str, str], *, data_home: Folder | None, base_url: str | None
) -> BagSet:
    """Find, read and check the file of a data set; `registry` maps file names to SHA-256 hashes.

    Raises
    ------
    DataError
        As `fetch` says, or if the counts are not those of ``about``.
    """
    path, packed = data_file(
        file_name(about.name), registry, data_home=data_home, base_url=base_url, source=about.source
    )
    found = parse_csv(unpacked(packed, str(path)), Columns(), origin=str(path))
    return _described(found, about, found.n_features, str(path))


def fetch_musk1(*, data_home: Folder | None = None, base_url: str | None = None) -> BagSet:
    """Musk 1: which of 92 molecules smell of musk, by their shapes; options as in `fetch`."""
    return fetch("musk1", data_home=data_home, base_url=base_url)


def fetch_musk2(*, data_home: Folder | None = None, base_url: str | None = None) -> BagSet:
    """Musk 2: which of 102 molecules smell of musk, by up to 1044 shapes each; options as in `fetch`."""
    return fetch("musk2", data_home=data_home, base_url=base_url)


def fetch_elephant(*, data_home: Folder | None = None, base_url: str | None = None) -> BagSet:
    """Elephant: which of 200 images show one, by their segments; options as in `fetch`."""
    return fetch("elephant", data_home=data_home, base_url=base_url)


def fetch_fox(*, data_home: Folder | None = None, base_url: str | None = None) -> BagSet:
    """Fox: which of 200 images show one, by their segments; options as in `fetch`."""
    return fetch("fox", data_home=data_home, base_url=base_url)


def fetch_tiger(*, data_home: Folder | None = None, base_url: str | None = None) -> BagSet:
    """Tiger: which of 200 images show one, by their segments; options as in `fetch`."""
    return fetch("tiger", data_home=data_home, base_url=base_url)


def fetch_mutagenesis_atoms(*, data_home: Folder | None = None, base_url: str | None = None) -> BagSet:
    """Mutagenesis: which of 188 molecules are mutagenic, by their atoms; options as in `fetch`."""
    return fetch("mutagenesis_atoms", data_home=data_home, base_url=base_url)


def fetch_mutagenesis_bonds(*, data_home: Folder | None = None, base_url: str | None = None) -> BagSet:
    """Mutagenesis: which of 188 molecules are mutagenic, by their bonds; options as in `fetch`."""
    return fetch("mutagenesis_bonds", data_home=data_home, base_url=base_url)


def fetch_mutagenesis_chains(*, data_home: Folder | None = None, base_url: str | None = None) -> BagSet:
    """Mutagenesis: which of 188 molecules are mutagenic, by chains of two bonds; options as in `fetch`."""
    return fetch("mutagenesis_chains", data_home=data_home, base_url=base_url)


def fetch_thioredoxin(*, data_home: Folder | None = None, base_url: str | None = None) -> BagSet:
    """Thioredoxin: which of 193 proteins have its fold, by their sequences; options as in `fetch`."""
    return fetch("thioredoxin", data_home=data_home, base_url=base_url)


def load_east_west(path: Folder, *, positive: str | None = None) -> BagSet:
    """Read the East-West trains from the user's copy of Weka's ARFF file.

    Parameters
    ----------
    path : path
        The relational ARFF file; we do not know a copy that could be fetched.
    positive : str, optional
        The label of eastbound trains; by default ``"east"`` if the file has it, otherwise 1 of 1 and 0.

    Returns
    -------
    BagSet
        20 trains; nominal attributes become one component per value, so there may be more components than
        the 24 attributes.

    Raises
    ------
    InputError
        If the file cannot be read; see `read_arff`.
    DataError
        If it does not contain 20 bags, 10 of them positive, of 213 instances with 24 attributes in all.

    References
    ----------
    Palmer (2015), section 3.3.2.
    """
    relation, found = read_relation(path, positive=positive, usual="east")
    return _described(found, EAST_WEST, len(relation.features), str(path))


def _described(found: BagSet, about: About, n_features: int, origin: str) -> BagSet:
    """Attach the facts about a data set after checking its counts."""
    counts = {
        "bags": (len(found), about.n_bags),
        "positive bags": (found.n_positive, about.n_positive),
        "instances": (found.n_instances, about.n_instances),
        "attributes": (n_features, about.n_features),
    }
    wrong = [
        f"{count} {what} instead of {right}" for what, (count, right) in counts.items() if count != right
    ]
    if wrong:
        raise DataError(f"{origin} is not {about.title}: it has {', '.join(wrong)}; use another copy")
    return replace(found, about=about)
