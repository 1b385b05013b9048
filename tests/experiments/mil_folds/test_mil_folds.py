from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from relforest.datasets import covariant1
from relforest.experiments.mil.data import DATA_SETS, Standard
from relforest.experiments.mil_folds import run
from relforest.experiments.mil_folds.analysis import mean_of, summarize
from relforest.experiments.mil_folds.run import compute, scored
from relforest.experiments.mil_folds.settings import FoldsSetting
from relforest.experiments.study import Context
from relforest.experiments.table import Row, Table
from relforest.support.errors import InputError

NAMED: Row = {"data_set": "fox", "method": "miles"}
ROWS: list[Row] = [
    {**NAMED, "repetition": 0, "fold": 0, "balanced": 0.4, "accuracy": 0.5, "auc": 0.6, "picked": 0.7},
    {**NAMED, "repetition": 0, "fold": 1, "balanced": 0.6, "accuracy": 0.7, "auc": 0.8, "picked": 0.9},
    {**NAMED, "repetition": 1, "fold": 0, "balanced": 0.7, "accuracy": 0.8, "auc": 0.9, "picked": 0.8},
    {**NAMED, "repetition": 1, "fold": 1, "balanced": 0.9, "accuracy": 0.8, "auc": 0.7, "picked": 0.8},
]


def test_measures_worked_by_hand() -> None:
    labels = np.array([True, True, True, False, False])
    # Two of three positive and one of two negative bags are right; 4.5 of 6 pairs are in order.
    found = scored(labels, np.array([3.0, 0.0, -1.0, -1.0, 0.5]))
    assert found == pytest.approx({"accuracy": 0.6, "balanced": 7 / 12, "auc": 3.5 / 6, "picked": 0.6})
    # All are positive from -2 on, so another threshold is right about each.
    picked = scored(labels, np.array([4.0, 3.0, 2.0, 1.0, 0.5]))
    assert picked == pytest.approx({"accuracy": 0.6, "balanced": 0.5, "auc": 1.0, "picked": 1.0})
    # Nothing is positive beyond the largest score.
    assert scored(labels[1:], np.array([-1.0, -2.0, 2.0, 3.0]))["picked"] == 0.5


def test_spread_is_that_of_repetitions() -> None:
    table = Table.of(ROWS)
    found = mean_of(table, "balanced")
    assert (found.value, found.spread) == pytest.approx((0.65, 0.3 / 2**0.5))
    assert mean_of(table.where(repetition=0), "balanced").spread is None

    findings = summarize(table)
    assert findings.claims[0].measured == pytest.approx(0.1)
    assert "Fox MILES 0.650 +- 0.212 0.700" in " ".join(str(findings).split())


def test_all_methods_get_the_same_folds(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    data = covariant1(np.random.default_rng(0), n_bags=30)
    monkeypatch.setattr(run, "DATA_SETS", {**DATA_SETS, "fox": Standard("Fox", 11, lambda: data)})
    tested: list[tuple[bool, ...]] = []

    def seen(labels: NDArray[np.bool_], _: object) -> dict[str, float]:
        tested.append(tuple(labels.tolist()))
        return {}

    monkeypatch.setattr(run, "scored", seen)
    for method in ("optimal-ball", "covagg"):
        for repetition in (0, 1):
            rows = compute(FoldsSetting("fox", method, repetition, 3), Context(0, 0, tmp_path))
            assert [row["fold"] for row in rows] == [0, 1, 2]
    assert tested[:6] == tested[6:]
    assert tested[:3] != tested[3:6]


def test_draws_have_no_folds(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="Color is drawn, and not divided into folds"):
        compute(FoldsSetting("color", "covagg", 0), Context(0, 0, tmp_path))
