from __future__ import annotations

import csv
import io
import json
from pathlib import Path

import pytest

from cli.command_lines import N_SCENES, CommandLine, passes, write
from reports.drawn_trees import one_question, scenes_of


def rows_of(text: str) -> list[dict[str, str]]:
    return list(csv.DictReader(io.StringIO(text)))


def test_every_scene_gets_a_row(run: CommandLine, model: Path, table: Path) -> None:
    outcome = run("predict", model, table)
    rows = rows_of(outcome.out)

    assert outcome.code == 0
    assert outcome.err == ""
    assert list(rows[0]) == ["scene", "probability", "predicted", "leaf", "witness_A"]
    assert [row["scene"] for row in rows] == [str(100 + number) for number in range(N_SCENES)]
    assert [row["predicted"] for row in rows] == ["True", "False"] * (N_SCENES // 2)
    assert all((float(row["probability"]) >= 0.5) == (row["predicted"] == "True") for row in rows)
    # Where the pass is completed, the last player is the one in the interval.
    assert {row["witness_A"] for row in rows[::2]} == {"p2"}


def test_scenes_of_other_sizes_need_no_labels(run: CommandLine, model: Path, tmp_path: Path) -> None:
    table = passes(n_players=7, seed=1).drop_columns(["completed", "passer"])
    rows = rows_of(run("predict", model, write(table, tmp_path / "other.csv")).out)

    assert {row["witness_A"] for row in rows if row["predicted"] == "True"} == {"p6"}
    assert sum(row["predicted"] == "True" for row in rows) == N_SCENES // 2


def test_predictions_go_to_a_file_on_demand(
    run: CommandLine, model: Path, table: Path, tmp_path: Path
) -> None:
    out = tmp_path / "new" / "predictions.csv"
    printed = run("predict", model, table).out
    outcome = run("predict", model, table, "--out", out, "--jobs", "2")

    assert outcome.out == ""
    assert outcome.err == f"wrote {N_SCENES} predictions of completed = True to {out}\n"
    assert out.read_text("utf-8") == printed
    assert "exists already" in run("predict", model, table, "--out", out).err
    assert run("predict", model, table, "--out", out, "--force").code == 0


def test_trees_of_a_run_folder_apply_to_files_of_scenes(run: CommandLine, tmp_path: Path) -> None:
    (tmp_path / "tree.json").write_text(json.dumps(one_question().to_dict()))
    scenes_of([[0, 0], [1, 0]], [[0, 0]]).to_parquet(tmp_path / "scenes.parquet")
    rows = rows_of(run("predict", tmp_path / "tree.json", tmp_path / "scenes.parquet").out)

    # The first scene has an object in the ellipse; the second has no object beside the passer: leaf of Error.
    assert [(row["scene"], row["probability"], row["leaf"]) for row in rows] == [
        ("scene 0", "0.9", "0"),
        ("scene 1", "0.3", "2"),
    ]
    assert [(row["witness_A"], row["witness_B"]) for row in rows] == [("a0", "b0"), ("a1", "")]


def test_scenes_of_another_kind_are_refused(run: CommandLine, model: Path, tmp_path: Path) -> None:
    scenes_of([[0, 0]]).to_parquet(tmp_path / "scenes.parquet")
    outcome = run("predict", model, tmp_path / "scenes.parquet")

    assert outcome.code == 1
    assert "column 'pass' is missing from " in outcome.err or "but the model needs scenes with" in outcome.err


def test_a_bare_tree_needs_a_file_of_scenes(run: CommandLine, table: Path, tmp_path: Path) -> None:
    (tmp_path / "tree.json").write_text(json.dumps(one_question().to_dict()))
    outcome = run("predict", tmp_path / "tree.json", table)

    assert outcome.code == 1
    assert "passes.parquet was not written by Scenes.to_parquet: the model does not name" in outcome.err


@pytest.mark.parametrize(
    ("content", "complaint"),
    [
        (None, "cannot be read"),
        ("{", "is not valid JSON"),
        ("[[[[", "is not valid JSON"),
        ("{}", "the key 'format' is missing"),
    ],
)
def test_bad_models_are_one_clear_line(
    run: CommandLine, table: Path, tmp_path: Path, content: str | None, complaint: str
) -> None:
    if content is not None:
        (tmp_path / "tree.json").write_text(content)
    outcome = run("predict", tmp_path / "tree.json", table)

    assert (outcome.code, outcome.out) == (1, "")
    assert complaint in outcome.err
    assert len(outcome.err.splitlines()) == 1


def test_a_table_without_the_columns_is_refused(run: CommandLine, model: Path, tmp_path: Path) -> None:
    table = write(passes().drop_columns(["x"]), tmp_path / "other.parquet")

    assert "other.parquet, which has 'pass', 'player', 'passer'" in run("predict", model, table).err
