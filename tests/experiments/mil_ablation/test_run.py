from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from relforest.datasets import BagSet
from relforest.experiments.mil_ablation import run
from relforest.experiments.mil_ablation.made_up import three_parts
from relforest.experiments.mil_ablation.settings import (
    COMMITTEE,
    PUBLISHED,
    SETTINGS,
    TITLES,
    VARIANTS,
    AblationSetting,
)
from relforest.experiments.registry import STUDIES
from relforest.experiments.study import Context, chosen_settings
from relforest.support.rng import generator, seed_sequence


def test_rows_are_repeatable(tmp_path: Path) -> None:
    setting = AblationSetting("covariant1", draws=2, n_bags=10, is_whole=False)
    rows = run.compute(setting, Context(3, 0, tmp_path))

    assert [(row["draw"], row["variant"]) for row in rows] == [
        (draw, variant) for draw in (0, 1) for variant in (PUBLISHED, COMMITTEE)
    ]
    assert rows == run.compute(setting, Context(3, 0, tmp_path))


@pytest.mark.parametrize(("data_set", "n_bags"), [("rare", 150), ("elements", 150), ("wide", 100)])
def test_draws_are_as_large_as_the_generator_says(tmp_path: Path, data_set: str, n_bags: int) -> None:
    (split,) = run.splits(AblationSetting(data_set, draws=1), Context(0, 0, tmp_path))

    assert (len(split.train), len(split.test)) == (n_bags, n_bags)


def test_images_of_training_are_not_tested(tmp_path: Path) -> None:
    (split,) = run.splits(AblationSetting("digits", draws=1, n_bags=60), Context(0, 0, tmp_path))
    train, test = (
        {image.tobytes() for bag in part.bags for image in bag} for part in (split.train, split.test)
    )

    assert not train & test


def test_musk_is_read_once_and_split_into_ten_folds_per_repetition(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    data = three_parts(generator(seed_sequence(0)), 40)
    reads: list[BagSet] = []

    def fetched() -> BagSet:
        reads.append(data)
        return data

    monkeypatch.setattr(run, "fetch_musk1", fetched)
    found = list(run.splits(AblationSetting("musk1", draws=11), Context(0, 0, tmp_path)))
    tested = [{bag.tobytes() for bag in split.test.bags} for split in found]

    assert len(reads) == 1
    assert [(len(split.train), len(split.test)) for split in found] == [(36, 4)] * 11
    assert len(set.union(*tested[:10])) == 40
    assert tested[10] != tested[0]


def test_every_data_set_can_be_chosen_and_learned_by_every_variant(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(run, "fetch_musk1", lambda: three_parts(generator(seed_sequence(0)), 40))
    for name in TITLES:
        (index,) = chosen_settings(STUDIES["mil_ablation"], SETTINGS, {"datasets": [name]})
        (split,) = run.splits(replace(SETTINGS[index], draws=1, n_bags=12), Context(0, index, tmp_path))
        assert len(split.train.bags) == (36 if name == "musk1" else 12)
    for variant, options in VARIANTS.items():
        parameters = run.learner(variant, seed_sequence(0)).get_params()
        assert {name: parameters[name] for name in options or ()} == (options or {})
        assert ("panels" in parameters) == (variant != PUBLISHED)
