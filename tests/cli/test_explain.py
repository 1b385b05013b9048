from __future__ import annotations

from pathlib import Path

import pytest

from cli.command_lines import CommandLine
from relforest.models import Model, write_model
from small_trees import near_tree, plane, scenes_in


@pytest.fixture
def near(tmp_path: Path) -> Path:
    """A model of scenes in the plane."""
    model = Model(near_tree(plane("A")), "tree", "meets", (False, True), None)
    write_model(tmp_path / "near.json", model)
    return tmp_path / "near.json"


@pytest.fixture
def scenes(tmp_path: Path) -> Path:
    """A table with a scene 0 for it."""
    scenes_in(plane("A"), [[(0.0, 0.0), (5.0, 0.0)]], [[0]]).to_parquet(tmp_path / "scenes.parquet")
    return tmp_path / "scenes.parquet"


def test_a_prediction_is_explained(run: CommandLine, near: Path, scenes: Path) -> None:
    page = near.with_name("why.html")
    outcome = run("explain", near, "--scene", "0", "of", scenes, "--object", "A", "--out", page)

    assert outcome.code == 0
    assert outcome.out.startswith("scene 0: meets = False\n")
    assert "meets = True would be predicted" in outcome.out
    assert outcome.err == f"wrote {page}\n"
    assert "Scene 0 of scenes.parquet" in page.read_text()


def test_scenes_without_places_have_reasons_and_no_page(
    run: CommandLine, model: Path, table: Path, tmp_path: Path
) -> None:
    outcome = run("explain", model, "--scene", "100", "of", table)
    page = run("explain", model, "--scene", "100", "of", table, "--out", tmp_path / "why.html")

    assert outcome.code == 0
    assert "What decided" in outcome.out
    assert page.code == 1
    assert "no attribute of extent is a location" in page.err
    assert not (tmp_path / "why.html").exists()


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ((), "a prediction is about a scene: add --scene K of FILE"),
        (("--scene", "0", "of", "TABLE", "--object", "p99"), "the scene has no object 'p99'"),
        (("--scene", "0", "of", "TABLE", "--within", "1", "2", "3"), "2 lower and then 2 upper bounds"),
        (("--scene", "0", "of", "TABLE", "--within", "90", "90", "99", "99"), "lies outside the scene"),
        (("--scene", "0", "of", "TABLE", "--out", "why.png"), "explanations are written as pages"),
    ],
)
def test_bad_input_is_refused(
    run: CommandLine, near: Path, scenes: Path, arguments: tuple[str, ...], said: str
) -> None:
    outcome = run("explain", near, *(scenes if each == "TABLE" else each for each in arguments))

    assert outcome.code == 1
    assert said in outcome.err
