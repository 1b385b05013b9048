from __future__ import annotations

from pathlib import Path

import pytest

from relforest.experiments.covagg.run import GENERATORS, compute
from relforest.experiments.covagg.settings import TITLES, CovAggSetting
from relforest.experiments.study import Place


def test_every_data_set_can_be_drawn() -> None:
    assert set(GENERATORS) == set(TITLES)


def test_each_pair_has_data_of_its_own(tmp_path: Path) -> None:
    setting = CovAggSetting("covariant1-printed", pairs=6, n_bags=30)
    rows = compute(setting, Place(3, 0, tmp_path))

    assert [row["pair"] for row in rows] == list(range(6))
    assert len({row["pss"] for row in rows}) > 1
    assert rows == compute(setting, Place(3, 0, tmp_path))
    assert rows != compute(setting, Place(4, 0, tmp_path))
    # More pairs leave the first ones as they are.
    assert rows[:2] == compute(CovAggSetting("covariant1-printed", pairs=2, n_bags=30), Place(3, 0, tmp_path))


def test_what_is_easy_is_learned(tmp_path: Path) -> None:
    rows = compute(CovAggSetting("covariant1-printed", pairs=3, n_bags=60), Place(0, 0, tmp_path))

    assert sum(float(str(row["pss"])) for row in rows) / 3 == pytest.approx(0.9, abs=0.15)
