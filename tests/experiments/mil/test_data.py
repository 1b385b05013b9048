from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from experiments.mil.fakes import DRAWN, FIXED
from relforest.datasets import BagSet
from relforest.experiments.mil import data
from relforest.experiments.mil.data import (
    ASSUMPTIONS,
    COMPARED,
    DATA_SETS,
    DESIGNED_WITH,
    HELD_OUT,
    N_FOLDS,
    PRINTED,
    Standard,
    Synthetic,
    splitter,
    stratified_parts,
    tuning_splits,
    unavailable,
)
from relforest.experiments.mil.settings import MilSetting
from relforest.support.errors import DataError, MissingDataError


def values(bag_set: BagSet) -> list[float]:
    return np.concatenate(bag_set.bags).ravel().tolist()


@given(
    labels=st.lists(st.booleans(), min_size=1, max_size=60),
    n_parts=st.integers(1, 12),
    seed=st.integers(0, 1000),
)
def test_parts_are_equal_in_size_and_in_positives(labels: list[bool], n_parts: int, seed: int) -> None:
    positive = np.array(labels)
    parts = stratified_parts(positive, n_parts, np.random.default_rng(seed))

    for of_class in (parts, parts[positive], parts[~positive]):
        counts = np.bincount(of_class, minlength=n_parts)
        assert len(counts) == n_parts
        assert counts.max() - counts.min() <= 1


def test_every_bag_of_a_standard_set_is_tested_once() -> None:
    split_of = splitter(FIXED, seed=3, n_bags=0)
    splits = [split_of(fold) for fold in range(N_FOLDS)]
    whole = FIXED.fetch()

    tested = [first for split in splits for first in (bag[0, 0] for bag in split.test.bags)]
    assert sorted(tested) == sorted(float(bag[0, 0]) for bag in whole.bags)
    for split in splits:
        assert len(split.train.bags) + len(split.test.bags) == 23
        # A fold of 2 or 3 of these 12 positive and 11 negative bags.
        assert 0 < split.test.labels.sum() < len(split.test.labels)
        assert not set(values(split.train)) & set(values(split.test))


@pytest.mark.parametrize("data_set", [DRAWN, FIXED])
def test_folds_depend_on_the_seed_and_their_number_alone(data_set: Synthetic | Standard) -> None:
    split_of, again = (splitter(data_set, seed=1, n_bags=6) for _ in range(2))

    assert values(again(2).test) == values(split_of(2).test)
    assert values(split_of(1).test) != values(split_of(2).test)
    assert values(splitter(data_set, seed=2, n_bags=6)(2).test) != values(split_of(2).test)


def test_tuning_uses_draws_of_its_own() -> None:
    split_of = splitter(DRAWN, seed=1, n_bags=6)
    tuning = tuning_splits(DRAWN, seed=1, n_bags=6, count=2)

    used = [part for split in tuning for part in (split.train, split.test)]
    scored = [part for fold in range(2) for part in (split_of(fold).train, split_of(fold).test)]
    assert len({tuple(values(part)) for part in used + scored}) == 8


def test_synthetic_sets_are_those_of_the_source() -> None:
    found = {}
    for name, data_set in DATA_SETS.items():
        if isinstance(data_set, Synthetic) and name not in ASSUMPTIONS:
            train = splitter(data_set, seed=0, n_bags=10)(0).train
            assert train.labels.sum() == 5
            found[name] = (len(train.bags[0]), train.bags[0].shape[1])

    # Table 3.1: bag size and dimensions
    assert found.pop(PRINTED) == found["covariant1"]
    assert found == {"color": (5, 3), "covariant1": (3, 2), "covariant2": (3, 2), "disjunctive": (10, 2)}


def test_only_the_changed_tests_of_assumptions_differ_from_training() -> None:
    # Signs lie at -10, where no other point is.
    for name, data_set in ASSUMPTIONS.items():
        split = splitter(data_set, seed=0, n_bags=40)(0)
        signed = [
            [bool((bag.mean(axis=1) < -8).any()) for bag in part.bags] for part in (split.train, split.test)
        ]
        sizes = [max(len(bag) for bag in part.bags) for part in (split.train, split.test)]
        has_signs = "frequency" not in name

        assert signed[0] == (~split.train.labels & has_signs).tolist()
        is_positive = split.test.labels if name.endswith("poisoned") else ~split.test.labels
        assert signed[1] == (is_positive & has_signs).tolist()
        assert (sizes[1] > 30) == (name == "frequency-false")


def test_streams_of_data_sets_are_their_own() -> None:
    assert len({data_set.key for data_set in DATA_SETS.values()}) == len(DATA_SETS) == 20


def test_the_committee_was_designed_without_eight_standard_sets() -> None:
    assert set(HELD_OUT) | set(DESIGNED_WITH) == set(COMPARED)
    assert len(HELD_OUT) == 8
    assert all(isinstance(DATA_SETS[name], Standard) for name in HELD_OUT)
    assert "musk1" not in HELD_OUT


def failing(error: DataError) -> Standard:
    def fetch() -> BagSet:
        raise error

    return Standard("Lost", 99, fetch)


def settings(*names: str) -> list[MilSetting]:
    return [MilSetting(name, "dd", 0) for name in names]


def test_a_missing_file_is_named_beside_a_reason_that_all_share(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    # A word of the reason is that of a data set, and must stay.
    monkeypatch.setenv("RELFOREST_DATA", str(tmp_path / "fox"))
    lost = failing(MissingDataError("no file"))
    sets = {"mutagenesis-atoms": lost, "fox": lost, "musk1": FIXED, "color": DRAWN}
    monkeypatch.setattr(data, "DATA_SETS", sets)
    asked = settings(*sets, "fox", "made-up")
    found = unavailable(asked)

    assert {setting: absence.missing for setting, absence in found.items()} == {
        asked[0]: "Lost (mutagenesis_atoms.csv.gz)",
        asked[1]: "Lost (fox.csv.gz)",
    }
    (reason,) = {absence.reason for absence in found.values()}
    assert f"RELFOREST_DATA (now {tmp_path / 'fox'})" in reason
    monkeypatch.delenv("RELFOREST_DATA")
    (again,) = unavailable(settings("fox")).values()
    assert "RELFOREST_DATA (not set now)" in again.reason


def test_a_damaged_file_is_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(data, "DATA_SETS", {"fox": failing(DataError("fox.csv.gz has a wrong hash"))})

    with pytest.raises(DataError, match="wrong hash"):
        unavailable(settings("fox"))


def test_files_tell_absence_from_damage(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("RELFOREST_DATA", str(tmp_path))
    monkeypatch.delenv("RELFOREST_DATA_URL", raising=False)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    (tmp_path / "fox.csv.gz").write_bytes(b"not the published one")

    assert len(unavailable(settings("tiger"))) == 1
    with pytest.raises(DataError, match="is not the published file"):
        unavailable(settings("fox"))
