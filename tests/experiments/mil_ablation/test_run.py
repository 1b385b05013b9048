from __future__ import annotations

from pathlib import Path

import pytest

from relforest.datasets import BagSet
from relforest.experiments.mil_ablation import run
from relforest.experiments.mil_ablation.made_up import three_parts
from relforest.experiments.mil_ablation.settings import (
    COMMITTEE,
    PUBLISHED,
    TITLES,
    VARIANTS,
    AblationSetting,
)
from relforest.experiments.study import Place
from relforest.support.rng import generator, seed_sequence


def test_every_data_set_but_musk_is_drawn() -> None:
    assert set(run.GENERATORS) | {"musk1"} == set(TITLES)


def test_rows_are_repeatable(tmp_path: Path) -> None:
    setting = AblationSetting("covariant1", draws=2, n_bags=10, is_whole=False)
    rows = run.compute(setting, Place(3, 0, tmp_path))

    assert [(row["draw"], row["variant"]) for row in rows] == [
        (draw, variant) for draw in (0, 1) for variant in (PUBLISHED, COMMITTEE)
    ]
    assert rows == run.compute(setting, Place(3, 0, tmp_path))


def test_musk_is_split_into_ten_folds_per_repetition(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    data = three_parts(generator(seed_sequence(0)), 40)
    sizes: list[tuple[int, int]] = []

    def fetched() -> BagSet:
        return data

    monkeypatch.setattr(run, "fetch_musk1", fetched)
    tested = []
    for draw in range(11):
        train, test = run.pair(AblationSetting("musk1"), Place(0, 0, tmp_path), draw)
        sizes.append((len(train), len(test)))
        tested.append({bag.tobytes() for bag in test.bags})

    assert sizes == [(36, 4)] * 11
    assert len(set.union(*tested[:10])) == 40
    assert tested[10] != tested[0]


def test_every_variant_can_be_made() -> None:
    for variant in VARIANTS:
        assert hasattr(run.learner(variant, seed_sequence(0)), "fit")
