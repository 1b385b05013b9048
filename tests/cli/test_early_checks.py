from __future__ import annotations

from pathlib import Path

import pytest

from cli.command_lines import CommandLine
from relforest.cli.early_checks import UsageError, naming_options, unknown
from relforest.support.errors import InputError

FIT = ("--label", "y", "--out", "tree.json")


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        (("learn", "corridor", "--seed", "-1"), "--seed must be an integer of at least 0, got -1"),
        (("learn", "corridor", "--runs", "0"), "--runs must be an integer of at least 1, got 0"),
        (("learn", "corridor", "--test-episodes", "0"), "--test-episodes must be an integer of at least 1"),
        (
            ("learn", "corridor", "--jobs", "-2"),
            "--jobs must be a positive integer, or -1 for all cores, got -2",
        ),
        (("learn", "corridor", "--out", ""), "--out is empty: give a path"),
        (("learn", "corridor", "--out="), "--out is empty: give a path"),
        (("learn", "corridor", "--out", "a\0b"), r"--out 'a\x00b': a path cannot contain a null character"),
        (("experiment", "corridor", "--seed", "-1"), "--seed must be an integer of at least 0"),
        (("play", "arch", "--episodes", "0"), "--episodes must be an integer of at least 1"),
        (("fit", "t.csv", *FIT, "--alpha", "1"), "--alpha must be a number above 0 and below 1"),
        (("fit", "t.csv", *FIT, "--max-points", "0"), "--max-points must be an integer of at least 1"),
        (("fit", "t\0.csv", *FIT), r"'t\x00.csv': a path cannot contain a null character"),
        (("fit", "", *FIT), "an argument is empty: give a path"),
        (("show", ""), "an argument is empty: give a path"),
    ],
)
def test_wrong_options_of_any_command_are_one_line_with_code_2(
    run: CommandLine, arguments: tuple[str, ...], complaint: str
) -> None:
    outcome = run(*arguments)

    assert (outcome.code, outcome.out) == (2, "")
    assert complaint in outcome.err
    assert len(outcome.err.splitlines()) == 1


def test_an_option_may_be_empty_where_that_means_something(run: CommandLine, tmp_path: Path) -> None:
    (tmp_path / "t.csv").write_text("s,x,y\n")
    outcome = run(
        "fit", tmp_path / "t.csv", "--arguments", "", "--label", "y", "--out", tmp_path / "tree.json"
    )

    assert "is empty: give a path" not in outcome.err


def test_missing_files_are_one_line_with_code_1(run: CommandLine) -> None:
    outcome = run("show", "none.json")

    assert (outcome.code, outcome.out) == (1, "")
    assert outcome.err == "relforest: none.json cannot be read: No such file or directory; check the path\n"


def test_errors_about_parameters_name_the_option() -> None:
    with pytest.raises(UsageError, match="--max-cycles must be less"), naming_options(["max_cycles"]):
        raise InputError("max_cycles must be less")
    with pytest.raises(UsageError, match="--blocks must be less"), naming_options([], n_blocks="blocks"):
        raise InputError("n_blocks must be less")
    with pytest.raises(InputError, match="runs/x holds no run"), naming_options(["max_cycles"]):
        raise InputError("runs/x holds no run")


def test_unknown_names_are_answered_with_similar_ones() -> None:
    assert str(unknown("study", "covag", ["covagg", "mil"])) == "unknown study 'covag': did you mean covagg?"
    assert str(unknown("study", "x", ["covagg", "mil"])) == "unknown study 'x': choose one of covagg, mil"
