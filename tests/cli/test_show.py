from __future__ import annotations

import json
from pathlib import Path

import pytest

from cli.command_lines import CommandLine
from experiments.run_folders import write_run_of_questions, write_run_of_sarsa
from relforest.experiments.keepaway_team import benchmark_team
from relforest.models import read_model
from relforest.reports.run_report import run_report
from relforest.worlds.keepaway.server.options import KeepawayOptions
from reports.drawn_trees import one_question, scenes_of


def test_a_tree_is_told_in_words(run: CommandLine, model: Path) -> None:
    outcome = run("show", model)

    assert (outcome.code, outcome.err) == (0, "")
    assert outcome.out == f"{read_model(model).tree}\n"


@pytest.mark.parametrize("arguments", [("--scene", "100", "of"), ("--scene", "100", "--of")])
def test_the_way_of_a_scene_is_told(
    run: CommandLine, model: Path, table: Path, arguments: tuple[str, ...]
) -> None:
    outcome = run("show", model, *arguments, table)
    told = outcome.out.removeprefix(f"{read_model(model).tree}\n\n")

    assert outcome.code == 0
    assert told.startswith("scene 100: probability 1.00, leaf 0\n    A = p2\n")
    assert " -> yes\n" in told


@pytest.mark.parametrize(
    ("suffix", "start"), [(".png", b"\x89PNG\r\n\x1a\n"), (".svg", b'<?xml version="1.0"')]
)
def test_a_tree_is_drawn_on_demand(
    run: CommandLine, model: Path, table: Path, tmp_path: Path, suffix: str, start: bytes
) -> None:
    plain, marked = tmp_path / f"tree{suffix}", tmp_path / f"scene{suffix}"
    outcome = run("show", model, "--out", plain)
    run("show", model, "--out", marked, "--scene", "101", "of", table)

    assert outcome.err == f"wrote {plain}\n"
    assert plain.read_bytes().startswith(start)
    assert plain.read_bytes() != marked.read_bytes()


def test_trees_of_a_run_folder_can_be_shown(run: CommandLine, tmp_path: Path) -> None:
    (tmp_path / "tree.json").write_text(json.dumps(one_question().to_dict()))
    scenes_of([[0, 0], [1, 0]]).to_parquet(tmp_path / "scenes.parquet")
    outcome = run(
        "show", tmp_path / "tree.json", "--scene", "scene 0", "of", tmp_path / "scenes.parquet",
        "--out", tmp_path / "tree.svg",
    )  # fmt: skip

    assert outcome.code == 0
    assert "A (passer) = a0" in outcome.out
    assert (tmp_path / "tree.svg").exists()


def test_what_a_run_has_learned_is_told_and_drawn(run: CommandLine, tmp_path: Path) -> None:
    write_run_of_questions(tmp_path / "run")
    outcome = run("show", tmp_path / "run", "--out", tmp_path / "run.svg")

    assert (outcome.code, outcome.err) == (0, f"wrote {tmp_path / 'run.svg'}\n")
    assert outcome.out == f"{run_report(tmp_path / 'run')}\n"
    assert "how far it is from true that some object has location at least 0.5" in outcome.out
    assert (tmp_path / "run.svg").read_bytes().startswith(b"<?xml")


def test_runs_that_cannot_be_shown_are_named(run: CommandLine, tmp_path: Path) -> None:
    write_run_of_sarsa(tmp_path / "sarsa", benchmark_team(KeepawayOptions()), KeepawayOptions())
    write_run_of_questions(tmp_path / "new", iterations=0)
    write_run_of_questions(tmp_path / "several" / "run-00")
    for arguments, complaint in (
        (("sarsa",), "was learned by Sarsa, which asks no questions"),
        (("new",), "has not learned anything yet"),
        (("several",), "contains several runs: give the folder of one"),
        ((".",), "is not a run: give a folder of 'relforest learn'"),
        (("new", "--scene", "1", "of", "a.csv"), "--scene belongs to models and trees"),
    ):
        folder, *rest = arguments
        outcome = run("show", tmp_path / folder, *rest)
        assert outcome.code == 1
        assert complaint in outcome.err


def test_pictures_are_replaced_only_on_demand(run: CommandLine, model: Path, tmp_path: Path) -> None:
    picture = tmp_path / "tree.svg"
    picture.write_text("precious")

    assert "exists already" in run("show", model, "--out", picture).err
    assert picture.read_text() == "precious"
    assert run("show", model, "--out", picture, "--force").code == 0


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        (("--out", "tree.pdf"), "tree.pdf has the suffix '.pdf': pictures are written as .png or .svg"),
        (("--scene", "100"), "the file of scene '100' is missing: write --scene 100 of FILE"),
        (("--of", "passes.csv"), "--of needs a scene: add --scene K"),
        (("--scene", "100", "in", "passes.csv"), "--scene 100 in passes.csv is not understood"),
        (("--scene", "100", "of", "a.csv", "--of", "b.csv"), "is not understood: write --scene K of FILE"),
        (("--scene", "100", "of"), "is not understood: write --scene K of FILE"),
        (("--scene", "100", "of", "none.csv"), "file none.csv does not exist"),
    ],
)
def test_bad_options_are_one_clear_line(
    run: CommandLine, model: Path, arguments: tuple[str, ...], complaint: str
) -> None:
    outcome = run("show", model, *arguments)

    assert (outcome.code, outcome.out) == (1, "")
    assert complaint in outcome.err
    assert len(outcome.err.splitlines()) == 1


def test_unknown_scenes_are_refused_with_those_there_are(run: CommandLine, model: Path, table: Path) -> None:
    outcome = run("show", model, "--scene", "99", "of", table)

    assert "passes.parquet does not contain a scene '99'; its scenes are 100, 101" in outcome.err
    assert "and 32 more" in outcome.err


def test_scenes_of_another_kind_are_refused(run: CommandLine, tmp_path: Path, model: Path) -> None:
    (tmp_path / "tree.json").write_text(json.dumps(read_model(model).tree.to_dict()))
    scenes_of([[0, 0]]).to_parquet(tmp_path / "scenes.parquet")
    outcome = run("show", tmp_path / "tree.json", "--scene", "scene 0", "of", tmp_path / "scenes.parquet")

    assert "but the model needs scenes with the attributes extent (1-D)" in outcome.err


@pytest.mark.parametrize("given", [("--scene", "-7", "of"), ("--scene=-7", "--of"), ("--scene", "007", "of")])
def test_a_scene_is_named_as_it_is_written(
    run: CommandLine, model: Path, tmp_path: Path, given: tuple[str, ...]
) -> None:
    path = tmp_path / "passes.csv"
    path.write_text("pass,player,x\n-7,a,0.5\n007,b,0.5\n7,c,0.5\n")

    name = given[0].partition("=")[2] or given[1]
    assert f"scene {name}: probability" in run("show", model, *given, path).out


def test_models_are_written_as_pages_and_code(
    run: CommandLine, model: Path, table: Path, tmp_path: Path
) -> None:
    page, module, script = (tmp_path / name for name in ("play.html", "model.py", "model.sql"))
    outcome = run("show", model, "--scene", "100", "of", table, "--out", page)
    assert (outcome.code, outcome.err) == (0, f"wrote {page}\n")
    for out in (module, script):
        assert run("show", model, "--out", out).code == 0

    assert "<title>Scene 100</title>" in page.read_text()
    assert "def predict(rows):" in module.read_text()
    assert "EXISTS (SELECT 1 FROM object" in script.read_text()


def test_what_cannot_be_shared_says_why(run: CommandLine, model: Path, table: Path, tmp_path: Path) -> None:
    write_run_of_questions(tmp_path / "run")
    for arguments, complaint in (
        ((model, "--out", "play.html"), "a page shows a scene that can be changed: add --scene K of FILE"),
        ((model, "--scene", "100", "of", table, "--out", "m.sql"), "m.sql is for all scenes: omit --scene"),
        ((tmp_path / "run", "--out", "run.py"), "only models and trees can be written as .py"),
    ):
        outcome = run("show", *arguments)
        assert outcome.code == 1
        assert complaint in outcome.err
