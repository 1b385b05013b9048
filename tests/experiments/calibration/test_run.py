from __future__ import annotations

from pathlib import Path

import numpy as np

from relforest.experiments.calibration.run import compute, noise
from relforest.experiments.calibration.settings import PERMUTATION, CalibrationSetting
from relforest.experiments.study import Context


def test_noise_has_the_size_asked_for_and_balanced_labels() -> None:
    setting = CalibrationSetting(PERMUTATION, 3, 5, 0, n_scenes=60)
    scenes, labels = noise(np.random.default_rng(0), setting)

    assert len(scenes) == 60
    assert set(scenes.counts.tolist()) == {3, 4, 5}
    assert labels.sum() == 30
    # Shuffled: not the first half.
    assert 5 < labels[:30].sum() < 25


def test_every_set_is_drawn_anew_and_repeatably(tmp_path: Path) -> None:
    setting = CalibrationSetting(PERMUTATION, 1, 1, 0, n_sets=3, n_scenes=12, permutations=19)
    rows = compute(setting, Context(0, 0, tmp_path))

    assert [row["set"] for row in rows] == [0, 1, 2]
    assert {type(row["accepted"]) for row in rows} == {bool}
    assert rows == compute(setting, Context(0, 0, tmp_path))
