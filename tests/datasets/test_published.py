from __future__ import annotations

import os
from dataclasses import replace
from hashlib import sha256
from pathlib import Path

import numpy as np
import pytest

from datasets.few_molecules import DATA, assert_few_molecules
from relforest import datasets
from relforest.datasets import CATALOGUE, About, fetch, load_east_west
from relforest.datasets.catalogue import EAST_WEST, SHA256, file_name
from relforest.datasets.published import read_published
from relforest.support.errors import DataError, InputError

FEW = About(
    name="few_molecules",
    title="Few molecules",
    n_bags=4,
    n_positive=2,
    n_instances=7,
    n_features=2,
    source="made up",
    licence="that of this package",
    literature="none",
    notes="",
)
REGISTRY = {"few_molecules.csv.gz": sha256((DATA / "few_molecules.csv.gz").read_bytes()).hexdigest()}

# Counts of the literature: bags, positive bags, instances, features.
COUNTS = {
    "musk1": (92, 47, 476, 166),
    "musk2": (102, 39, 6598, 166),
    "elephant": (200, 100, 1391, 230),
    "fox": (200, 100, 1320, 230),
    "tiger": (200, 100, 1220, 230),
    "mutagenesis_atoms": (188, 125, 1618, 10),
    "mutagenesis_bonds": (188, 125, 3995, 16),
    "mutagenesis_chains": (188, 125, 5349, 24),
    "thioredoxin": (193, 25, 26611, 8),
}


@pytest.fixture
def local_data(monkeypatch: pytest.MonkeyPatch) -> None:
    """The folder with the files, seen from wherever the tests were started."""
    folder = os.environ.get("RELFOREST_DATA")
    if not folder:
        pytest.skip("the data sets are not part of the package: set RELFOREST_DATA to read them")
    monkeypatch.setenv("RELFOREST_DATA", str(Path(folder).absolute()))
    monkeypatch.delenv("RELFOREST_DATA_URL", raising=False)


def test_every_set_has_a_hash_a_function_and_its_counts() -> None:
    assert set(CATALOGUE) == set(COUNTS)
    assert set(SHA256) == {file_name(name) for name in COUNTS}
    for name, about in CATALOGUE.items():
        assert about.name == name
        assert (about.n_bags, about.n_positive, about.n_instances, about.n_features) == COUNTS[name]
        assert about.source
        assert about.licence
        assert callable(getattr(datasets, f"fetch_{name}"))


@pytest.mark.usefixtures("local_data")
@pytest.mark.parametrize("name", COUNTS)
def test_the_published_sets_are_as_the_literature_counts_them(name: str) -> None:
    data = getattr(datasets, f"fetch_{name}")()
    assert (len(data), data.n_positive, data.n_instances, data.n_features) == COUNTS[name]
    assert data.about == CATALOGUE[name]
    assert all(isinstance(bag_id, str) for bag_id in data.bag_ids)


@pytest.mark.usefixtures("local_data")
def test_single_values_of_musk_are_those_of_the_repository() -> None:
    # The first line of clean1.data: MUSK-188, conformation 188_1+1.
    musk = datasets.fetch_musk1()
    assert musk.bags[0][0, :5].tolist() == [42, -198, -109, -75, -117]
    assert bool(musk.labels[0])
    assert {len(bag) for bag in datasets.fetch_musk2().bags} >= {1, 1044}


@pytest.mark.usefixtures("local_data")
@pytest.mark.parametrize(("name", "n_constant"), [("elephant", 120), ("fox", 108), ("tiger", 106)])
def test_constant_features_of_images_are_as_many_as_is_said(name: str, n_constant: int) -> None:
    data = fetch(name)
    points = np.concatenate(data.bags)
    assert np.count_nonzero((points == points[0]).all(axis=0)) == n_constant
    assert np.count_nonzero((points == 0).all(axis=0)) == 87
    assert data.about is not None
    assert f"{n_constant} of the 230 features are constant, 87 of them zero" in data.about.notes


@pytest.mark.usefixtures("local_data")
def test_elements_of_atoms_are_in_the_order_that_is_said() -> None:
    atoms = np.concatenate(datasets.fetch_mutagenesis_atoms().bags)
    types, elements = atoms[:, 1], atoms[:, 2:]
    np.testing.assert_array_equal(np.sort(elements), np.eye(8)[[-1]].repeat(len(atoms), axis=0))
    # The halogens' types are consecutive numbers: 92 fluorine, 93 chlorine, 94 bromine, 95 iodine.
    br, c, cl, f, h, i, n, o = (set(types[element == 1]) for element in elements.T)
    assert (f, cl, br, i) == ({92}, {93}, {94}, {95})
    # Aromatic carbon, hydrogen, the nitrogen and the oxygen of nitro groups.
    assert [22 in c, 3 in h, 38 in n, 40 in o] == [True] * 4
    assert "eight elements br, c, cl, f, h, i, n, o, in this order" in CATALOGUE["mutagenesis_atoms"].notes


def test_what_is_not_known_is_not_stated_as_a_fact() -> None:
    for name in ("musk1", "musk2"):
        assert (
            "UCI, where the set was first published, says that its data sets are licensed"
            in CATALOGUE[name].licence
        )
    assert "is an inference" in EAST_WEST.notes


def test_a_local_file_is_read_and_described(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("RELFOREST_DATA", str(DATA))
    found = read_published(FEW, REGISTRY, data_home=None, base_url=None)
    assert_few_molecules(found)
    assert found.about == FEW


def test_other_counts_than_known_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("RELFOREST_DATA", str(DATA))
    with pytest.raises(DataError, match="not Few molecules: it has 4 bags instead of 5, 7 instances instead"):
        read_published(replace(FEW, n_bags=5, n_instances=9), REGISTRY, data_home=None, base_url=None)


def test_musk_1_is_part_of_the_package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("RELFOREST_DATA", "RELFOREST_DATA_URL"):
        monkeypatch.delenv(name, raising=False)
    musk = datasets.fetch_musk1(data_home=tmp_path)
    assert (len(musk), musk.n_positive, musk.n_instances, musk.n_features) == COUNTS["musk1"]
    # The first line of clean1.data: MUSK-188, conformation 188_1+1.
    assert musk.bags[0][0, :5].tolist() == [42, -198, -109, -75, -117]


@pytest.mark.parametrize("name", [name for name in COUNTS if name != "musk1"])
def test_missing_data_are_named_with_their_source(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("RELFOREST_DATA", str(tmp_path))
    monkeypatch.delenv("RELFOREST_DATA_URL", raising=False)
    with pytest.raises(DataError) as error:
        getattr(datasets, f"fetch_{name}")(data_home=tmp_path / "cache")
    assert str(error.value).startswith(
        f"{name}.csv.gz was not found (looked in {tmp_path / 'mil'}, {tmp_path}, "
    )
    assert str(error.value).endswith(CATALOGUE[name].source)


def test_unknown_names_are_refused() -> None:
    with pytest.raises(InputError, match="name must be one of 'musk1', 'musk2'"):
        fetch("musk3")


def trains(n_bags: int, n_instances: int, *, labels: tuple[str, str] = ("west", "east")) -> str:
    """A file in the shape of Weka's East-West data, half of whose trains go east."""
    features = "".join(f"@attribute f{number} {{no,yes}}\n" for number in range(24))
    head = f"@relation t\n@attribute id string\n@attribute bag relational\n{features}@end bag\n"
    cars = ",".join(["yes"] + ["no"] * 23)
    sizes = [n_instances // n_bags + (number < n_instances % n_bags) for number in range(n_bags)]
    bags = ["\\n".join([cars] * size) for size in sizes]
    rows = "".join(f't{number},"{bag}",{labels[number % 2]}\n' for number, bag in enumerate(bags))
    return f"{head}@attribute class {{{','.join(labels)}}}\n@data\n{rows}"


def test_east_west_is_read_from_the_users_file(tmp_path: Path) -> None:
    path = tmp_path / "eastWest.arff"
    path.write_text(trains(20, 213), encoding="utf-8")
    data = load_east_west(path)
    assert data.labels.tolist() == [False, True] * 10
    assert (len(data), data.n_positive, data.n_instances) == (20, 10, 213)
    # 24 attributes of two values each.
    assert data.n_features == 48
    assert data.about is not None
    assert data.about.title == "East-West"


@pytest.mark.parametrize(
    ("labels", "positive"), [(("0", "1"), None), (("w", "e"), "e"), (("east", "west"), "west")]
)
def test_eastbound_trains_may_have_another_label(
    tmp_path: Path, labels: tuple[str, str], positive: str | None
) -> None:
    path = tmp_path / "eastWest.arff"
    path.write_text(trains(20, 213, labels=labels), encoding="utf-8")
    assert load_east_west(path, positive=positive).labels.tolist() == [False, True] * 10


def test_another_file_is_not_east_west(tmp_path: Path) -> None:
    path = tmp_path / "eastWest.arff"
    path.write_text(trains(20, 63), encoding="utf-8")
    with pytest.raises(DataError, match="is not East-West: it has 63 instances instead of 213"):
        load_east_west(path)
    with pytest.raises(DataError, match=r"4 bags instead of 20.*2 attributes instead of 24"):
        load_east_west(DATA / "few_molecules.arff")
