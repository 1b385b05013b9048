from __future__ import annotations

from pathlib import Path

from cli.command_lines import CommandLine
from experiments.run_folders import write_run_of_questions, write_run_of_sarsa
from relforest.experiments.keepaway_team import benchmark_team
from relforest.models import Model, write_model
from relforest.worlds.keepaway.server.options import KeepawayOptions
from small_trees import near_tree, plane

MOVES = """
[[situation]]
name = "{}"
objects = [{{location = {}}}]
actions = [["left"], ["right"]]
expect = {{chosen = ["{}"]}}
"""


def test_policies_are_checked(run: CommandLine, tmp_path: Path) -> None:
    write_run_of_questions(tmp_path / "run")
    unit = tmp_path / "unit.toml"
    unit.write_text(MOVES.format("near the right end", 0.9, "right"))
    outcome = run("check", tmp_path / "run", "--unit", unit)
    assert (outcome.code, outcome.out) == (0, "ok      near the right end\n1 situation, none failed\n")

    unit.write_text(unit.read_text() + MOVES.format("away from the end", 0.9, "left"))
    outcome = run("check", tmp_path / "run", "--unit", unit)
    lines = outcome.out.splitlines()
    assert outcome.code == 1
    assert [lines[0], lines[1], lines[-1]] == [
        "ok      near the right end",
        "FAILED  away from the end",
        "2 situations, 1 failed",
    ]
    assert lines[2].startswith("        expected: chosen left; but right is worth ")
    assert "; for it: some object has location at least 0.5" in lines[2]


def test_models_are_checked(run: CommandLine, tmp_path: Path) -> None:
    write_model(tmp_path / "near.json", Model(near_tree(plane("A")), "tree", "meets", (False, True), None))
    unit = tmp_path / "unit.toml"
    unit.write_text(
        '[[situation]]\nname = "meets"\narguments = {A = "a"}\nexpect = {predicted = true}\n'
        'objects = [{id = "a", location = [0, 0]}, {id = "b", location = [0, 2]}]\n'
    )
    outcome = run("check", tmp_path / "near.json", "--unit", unit)
    assert (outcome.code, outcome.out) == (0, "ok      meets\n1 situation, none failed\n")


def test_what_cannot_be_checked_is_named(run: CommandLine, tmp_path: Path) -> None:
    write_run_of_sarsa(tmp_path / "sarsa", benchmark_team(KeepawayOptions()), KeepawayOptions())
    unit = tmp_path / "unit.toml"
    unit.write_text(MOVES.format("somewhere", 0.5, "left"))
    outcome = run("check", tmp_path / "sarsa", "--unit", unit)
    assert outcome.code == 1
    assert "was learned by" in outcome.err
    assert "No such file" in run("check", tmp_path / "sarsa", "--unit", tmp_path / "none.toml").err
