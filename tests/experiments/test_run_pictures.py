from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path

import pytest

from experiments.run_folders import SMALL
from relforest.experiments.run_pictures import REWARD, draw_runs
from relforest.experiments.runs import learn_runs
from relforest.experiments.tasks import task_named

Q_FUNCTION = "q-function.png"
PNG = b"\x89PNG\r\n\x1a\n"


@pytest.fixture(scope="module")
def run_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("run")
    learn_runs(SMALL, out)
    return out


def test_both_pictures_are_drawn(run_folder: Path) -> None:
    for name in (Q_FUNCTION, REWARD):
        assert (run_folder / name).read_bytes().startswith(PNG)


def test_deleted_pictures_are_drawn_again_with_the_same_bytes(run_folder: Path) -> None:
    before = {name: (run_folder / name).read_bytes() for name in (Q_FUNCTION, REWARD)}
    for name in before:
        (run_folder / name).unlink()

    pictures = draw_runs(SMALL, run_folder)

    assert {picture.name: picture.read_bytes() for picture in pictures} == before


def test_pictures_older_than_the_run_are_drawn_again(run_folder: Path) -> None:
    reward = run_folder / REWARD
    (run_folder / REWARD).write_bytes(b"old")
    os.utime(reward, (0, 0))
    draw_runs(SMALL, run_folder)

    assert reward.read_bytes().startswith(PNG)


def test_newer_pictures_are_left_alone(run_folder: Path) -> None:
    before = {name: (run_folder / name).stat().st_mtime_ns for name in (Q_FUNCTION, REWARD)}
    draw_runs(SMALL, run_folder)

    assert {name: (run_folder / name).stat().st_mtime_ns for name in before} == before


def test_a_task_without_a_picture_of_its_values_has_rewards_only(
    run_folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    plain = replace(task_named("corridor"), pictures={"smrf-rpi": None}, optimum=None)
    monkeypatch.setattr("relforest.experiments.run_config.task_named", lambda _name: plain)

    assert draw_runs(SMALL, run_folder) == [run_folder / REWARD]
