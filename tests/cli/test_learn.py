from __future__ import annotations

import json
from pathlib import Path

import pytest

from cli.command_lines import CommandLine
from relforest.experiments.tasks import TASKS

SMALL = ("--episodes", "4", "--test-episodes", "2", "--iterations", "1")


def test_a_run_is_learned_told_and_drawn(run: CommandLine, tmp_path: Path) -> None:
    out = tmp_path / "run"
    outcome = run("learn", "corridor", *SMALL, "--out", out)
    rows = [json.loads(line) for line in (out / "metrics.jsonl").read_text("utf-8").splitlines()]

    assert outcome.code == 0
    begin, *lines = outcome.err.splitlines()
    assert begin == f"learning corridor in {out}: 1 iteration"
    _, learned = lines
    assert learned.startswith(
        f"iteration 1: test reward {rows[1]['test_reward']:.3f}, {rows[1]['trees']} trees"
    )
    assert learned.endswith(" s")
    assert outcome.out.startswith("iteration  test reward")
    assert "left: " in outcome.out
    assert outcome.out.endswith(
        f"run folder: {out}\npicture: {out / 'q-function.png'}\npicture: {out / 'reward.png'}\n"
    )


def test_a_finished_run_is_told_again_unchanged(run: CommandLine, tmp_path: Path) -> None:
    command = ("learn", "corridor", *SMALL, "--out", tmp_path / "run")
    first = run(*command)
    before = (tmp_path / "run" / "checkpoint.json").read_bytes()
    second = run(*command)

    assert (second.code, second.out) == (0, first.out)
    assert len(second.err.splitlines()) == 1
    assert (tmp_path / "run" / "checkpoint.json").read_bytes() == before


def test_several_runs_are_summarised(run: CommandLine, tmp_path: Path) -> None:
    out = tmp_path / "runs"
    outcome = run("learn", "corridor", *SMALL, "--runs", "2", "--features", "bits", "--out", out)

    assert outcome.code == 0
    assert outcome.out.startswith("mean (standard deviation) of 2 runs\niteration")
    assert "\nfirst run\n" in outcome.out
    assert "run 1, iteration 1: test reward" in outcome.err
    assert (out / "run-01" / "metrics.jsonl").exists()
    assert (out / "reward.png").exists()


def test_runs_go_to_a_folder_of_their_task(
    run: CommandLine, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)

    assert run("learn", "corridor", *SMALL).code == 0
    assert (tmp_path / "runs" / "corridor" / "metrics.jsonl").exists()


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        (("corridor", "--episodes", "0"), "--episodes must be an integer of at least 1, got 0"),
        (("corridor", "--iterations", "-1"), "--iterations must be an integer of at least 1, got -1"),
        (("corridor", "--runs", "0"), "--runs must be an integer of at least 1, got 0"),
        (("corridor", "--test-episodes", "0"), "--test-episodes must be an integer of at least 1, got 0"),
        (("corridor", "--seed", "-3"), "--seed must be an integer of at least 0, got -3"),
        (("corridor", "--jobs", "0"), "--jobs must be a positive integer, or -1 for all cores, got 0"),
        (("corridor", "--jobs", "-2"), "--jobs must be a positive integer, or -1 for all cores, got -2"),
        (("corridor", "--epsilon", "3"), "--epsilon must be a number of at least 0 and of at most 1, got 3"),
        (("corridor", "--lspi-iterations", "0"), "--lspi-iterations must be an integer of at least 1"),
        (("corridor", "--sarsa-alpha", "1"), "--sarsa-alpha is an option of Sarsa: leave it out with"),
        (("keepaway", "--method", "cmac-sarsa", "--rounds", "3"), "--rounds is an option of SMRF-RPI"),
        (("corridor", "--method", "cmac-sarsa"), "--method cmac-sarsa is not for corridor: use smrf-rpi"),
        (("high-towers", "--method", "lspi"), "--method lspi is not for high-towers: use smrf-rpi or smrf-q"),
        (
            ("keepaway", "--method", "lspi", "--q-ridge", "3"),
            "--q-ridge is an option of smrf-q: leave it out",
        ),
        (("corridor", "--from", "run"), "--from is for smrf-q and sarsa-on-smrf: leave it out with --method"),
        (
            ("corridor", "--method", "smrf-q", "--from", "run", "--questions-from", "run"),
            "--from and --questions-from exclude each other",
        ),
        (("keepaway", "--method", "sarsa-on-smrf"), "needs the trees of a run of smrf-rpi: give --from"),
    ],
)
def test_bad_options_are_one_clear_line(
    run: CommandLine, tmp_path: Path, arguments: tuple[str, ...], complaint: str
) -> None:
    outcome = run("learn", *arguments, "--out", tmp_path / "run")

    assert (outcome.code, outcome.out) == (2, "")
    assert complaint in outcome.err
    assert len(outcome.err.splitlines()) == 1
    assert not (tmp_path / "run").exists()


def test_folders_of_other_work_are_left_alone(run: CommandLine, tmp_path: Path) -> None:
    (tmp_path / "thesis.txt").write_text("precious")
    outcome = run("learn", "corridor", *SMALL, "--out", tmp_path)

    assert outcome.code == 1
    assert "contains 'thesis.txt' but not run.json" in outcome.err
    assert [path.name for path in tmp_path.iterdir()] == ["thesis.txt"]


def test_runs_of_another_configuration_are_left_alone(run: CommandLine, tmp_path: Path) -> None:
    out = tmp_path / "run"
    run("learn", "corridor", *SMALL, "--out", out)
    outcome = run("learn", "corridor", *SMALL, "--seed", "1", "--out", out)

    assert outcome.code == 1
    assert "seed (0 there, 1 here)" in outcome.err


def test_an_unknown_task_is_refused_with_those_that_exist(run: CommandLine) -> None:
    outcome = run("learn", "maze")

    assert (outcome.code, outcome.out) == (2, "")
    assert "invalid choice 'maze'" in outcome.err
    assert all(f"'{task}'" in outcome.err for task in TASKS)


def test_options_of_the_method_are_part_of_the_run(run: CommandLine, tmp_path: Path) -> None:
    out = tmp_path / "run"
    changed = ("--rounds", "1", "--epsilon", "0.5", "--discount", "0.8", "--no-bootstrapping")
    assert run("learn", "corridor", *SMALL, *changed, "--out", out).code == 0
    outcome = run("learn", "corridor", *SMALL, "--out", out)
    stored = json.loads((out / "run.json").read_text("utf-8"))

    assert stored["settings"]["max_rounds"] == 1
    assert stored["settings"]["bootstrap_on_truncation"] is False
    assert stored["discount"] == 0.8
    assert (
        json.loads((out / "checkpoint.json").read_text("utf-8"))["configuration"]["world"]["discount"] == 0.8
    )
    assert outcome.code == 1
    assert "settings.epsilon (0.5 there, 0.1 here)" in outcome.err
