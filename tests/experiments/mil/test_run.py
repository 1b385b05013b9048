from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import nullcontext
from dataclasses import replace
from itertools import count
from pathlib import Path
from typing import Any

import pytest

from experiments.mil import fakes
from relforest.experiments.mil import run
from relforest.experiments.mil.run import compute, grid_points, measured, tuned
from relforest.experiments.mil.settings import DONE, STOPPED, MilSetting
from relforest.experiments.study import Context

CONTEXT = Context(3, 7, Path())
DRAWN = MilSetting("color", "covagg", 0, n_bags=20)
TUNED = MilSetting("color", "miles-tuned", 0, n_bags=20, tuning_draws=1, grid_step=4)

Work = Callable[..., tuple[Any, int]]


@pytest.fixture
def calls(monkeypatch: pytest.MonkeyPatch) -> Iterator[list[str]]:
    """Learn in this process; returns the names of the calls."""
    names: list[str] = []

    def call(name: str, function: Callable[..., Any], *arguments: object) -> tuple[Any, int]:
        names.append(name)
        return function(*arguments), 1000

    monkeypatch.setattr(run._PROCESS, "call", call)
    monkeypatch.setattr(run, "_HOPELESS", set())
    monkeypatch.setattr(run, "DATA_SETS", {"musk1": fakes.FIXED, "color": fakes.DRAWN})
    monkeypatch.setattr(run, "METHODS", fakes.FAKES)
    tuned.cache_clear()
    yield names
    tuned.cache_clear()


@pytest.fixture
def too_long(calls: list[str], monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Let every call take too long."""

    def call(name: str, *_: object) -> tuple[None, int]:
        calls.append(name)
        return None, 2000

    monkeypatch.setattr(run._PROCESS, "call", call)
    return calls


def test_a_row_tells_all_of_a_fold(calls: list[str]) -> None:
    (row,) = compute(MilSetting("musk1", "covagg", 2), CONTEXT)

    assert 0 <= float(str(row.pop("cpu_seconds"))) < 1
    assert row == {
        "data_set": "musk1",
        "method": "covagg",
        "fold": 2,
        "state": DONE,
        "pss": 1.0,
        "peak_bytes": 1000,
        "C": None,
        "gamma_factor": None,
        "n_bags": 23,
        "n_positive": 12,
        "n_instances": 69,
        "n_features": 2,
    }
    assert calls == ["musk1, covagg"]


def test_after_a_fold_that_takes_too_long_the_others_are_not_tried(too_long: list[str]) -> None:
    (first,), (second,) = (compute(replace(DRAWN, fold=fold), CONTEXT) for fold in (0, 1))

    for row in (first, second):
        assert (row["state"], row["pss"], row["cpu_seconds"], row["n_bags"]) == (STOPPED, None, None, None)
    assert (first["peak_bytes"], second["peak_bytes"]) == (2000, None)
    assert too_long == ["color, covagg"]


@pytest.mark.usefixtures("calls")
def test_what_ends_a_moment_after_its_limit_took_too_long(monkeypatch: pytest.MonkeyPatch) -> None:
    clock = count(step=2.0)
    monkeypatch.setattr(run, "cpu_seconds", lambda: next(clock))
    monkeypatch.setattr(run, "cpu_limit", nullcontext)

    assert measured(replace(DRAWN, cpu_limit=2.0), 0, {}) is not None
    assert measured(replace(DRAWN, cpu_limit=1.9), 0, {}) is None


def test_parameters_are_tuned_once_and_then_used(calls: list[str]) -> None:
    rows = [row for fold in (0, 1) for row in compute(replace(TUNED, fold=fold), CONTEXT)]

    # The threshold C * gamma_factor must lie between 1 and 1.5 or so; of C = 10^-4, 1, 10^4, 10^8 and factors
    # 1/16, 1, 16 only 1 * 1 does. Higher ones call all bags negative, lower ones all positive.
    assert [(row["C"], row["gamma_factor"], row["pss"]) for row in rows] == [(1.0, 1.0, 1.0)] * 2
    assert calls == ["color, miles-tuned, tuning"] * 12 + ["color, miles-tuned"] * 2


def test_the_first_of_equal_points_is_chosen(calls: list[str], monkeypatch: pytest.MonkeyPatch) -> None:
    scores = iter([0.1, 0.4, None, 0.4, 0.2, None])
    monkeypatch.setattr(run._PROCESS, "call", lambda *_: (next(scores), 0))

    assert tuned(replace(TUNED, grid_step=7), 0) == grid_points(7)[1]
    assert calls == []


def test_parameters_that_all_take_too_long_leave_a_row(too_long: list[str]) -> None:
    (row,) = compute(TUNED, CONTEXT)

    assert (row["state"], row["C"]) == (STOPPED, None)
    assert set(too_long) == {"color, miles-tuned, tuning"}


def test_the_full_grid_is_the_sources() -> None:
    points = grid_points(1)

    # C from 10^-4 to 10^9, factors from 2^-7 to 2^7
    assert len(points) == 14 * 15
    assert {point["C"] for point in points} == {10.0**exponent for exponent in range(-4, 10)}
    assert {point["gamma_factor"] for point in points} == {2.0**exponent for exponent in range(-7, 8)}


def test_a_coarse_grid_goes_through_the_constant_parameters() -> None:
    points = grid_points(2)

    assert points[0] == {"C": 1e4, "gamma_factor": 1.0}
    assert sorted({point["C"] for point in points}) == [1e-4, 1e-2, 1e0, 1e2, 1e4, 1e6, 1e8]
    assert sorted({point["gamma_factor"] for point in points}) == [2.0**power for power in range(-6, 7, 2)]
