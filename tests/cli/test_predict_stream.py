from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pyarrow as pa
import pytest
from pyarrow import csv, parquet

from cli.command_lines import N_SCENES, CommandLine, passes, write
from relforest.cli import predict_stream
from relforest.models import Model
from relforest.scenes import read_table
from relforest.trees import query
from reports.drawn_trees import one_question, scenes_of


@pytest.fixture
def parts(tmp_path: Path) -> Path:
    """Passes in three files; all of the second belongs to a pass that begins in the first."""
    table = passes()
    folder = tmp_path / "parts"
    folder.mkdir()
    for number, (begin, end) in enumerate([(0, 40), (40, 42), (42, 3 * N_SCENES)]):
        write(table.slice(begin, end - begin), folder / f"part-{number}.parquet")
    return folder


def rows(path: Path) -> list[dict[str, Any]]:
    found: list[dict[str, Any]] = parquet.read_table(path).to_pylist()
    return found


def names_in(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def test_parquet_predictions_are_those_of_the_csv(
    run: CommandLine, model: Path, table: Path, parts: Path, tmp_path: Path
) -> None:
    run("predict", model, table, "--out", tmp_path / "whole.csv")
    outcome = run("predict", model, parts, "--out", tmp_path / "new" / "all.parquet", "--jobs", "2")
    found = parquet.read_table(tmp_path / "new" / "all.parquet")
    expected = csv.read_csv(tmp_path / "whole.csv")

    assert outcome.err == f"wrote {N_SCENES} predictions of completed = True to {tmp_path}/new/all.parquet\n"
    assert names_in(tmp_path / "new") == ["all.parquet"]
    assert found.column_names == expected.column_names
    assert found.schema.types == [pa.int64(), pa.float64(), pa.bool_(), pa.int64(), pa.string()]
    assert found.drop_columns("probability").to_pylist() == [
        {name: value if value != "" else None for name, value in row.items()}
        for row in expected.drop_columns("probability").to_pylist()
    ]
    assert found["probability"].to_pylist() == pytest.approx(expected["probability"].to_pylist(), rel=1e-5)


@pytest.mark.parametrize("as_pattern", [False, True])
def test_a_folder_gets_a_file_for_each_one(
    run: CommandLine,
    model: Path,
    parts: Path,
    tmp_path: Path,
    as_pattern: bool,  # noqa: FBT001
) -> None:
    source = f"{parts}/part-*.parquet" if as_pattern else parts
    assert run("predict", model, source, "--out", tmp_path / "out").code == 0
    found = [
        [row["scene"] for row in rows(tmp_path / "out" / f"part-{number}.parquet")] for number in range(3)
    ]

    assert names_in(tmp_path / "out") == ["part-0.parquet", "part-1.parquet", "part-2.parquet"]
    assert found == [list(range(100, 114)), [], list(range(114, 140))]


def test_a_single_file_may_go_to_a_folder(run: CommandLine, model: Path, parts: Path, tmp_path: Path) -> None:
    (tmp_path / "out").mkdir()
    assert run("predict", model, parts / "part-0.parquet", "--out", tmp_path / "out").code == 0

    assert names_in(tmp_path / "out") == ["part-0.parquet"]


def test_our_own_files_need_no_columns(run: CommandLine, tmp_path: Path) -> None:
    (tmp_path / "tree.json").write_text(json.dumps(one_question().to_dict()))
    scenes_of([[0, 0], [1, 0]], [[0, 0]]).to_parquet(tmp_path / "own" / "a.parquet")
    scenes_of([[0, 0], [1, 0]]).to_parquet(tmp_path / "own" / "b.parquet")
    run("predict", tmp_path / "tree.json", tmp_path / "own", "--out", tmp_path / "out.parquet")

    assert [(row["scene"], row["witness_A"], row["witness_B"]) for row in rows(tmp_path / "out.parquet")] == [
        ("scene 0", "a0", "b0"),
        ("scene 1", "a1", None),
        ("scene 0", "a0", "b0"),
    ]


def test_nothing_is_left_of_work_that_fails(
    run: CommandLine, model: Path, parts: Path, tmp_path: Path
) -> None:
    # The last file brings back a pass of the first.
    write(passes().slice(0, 3), parts / "part-3.parquet")
    for out in ("folder", "all.parquet"):
        outcome = run("predict", model, parts, "--out", tmp_path / "out" / out)

        assert outcome.code == 1
        assert "scene 100 comes back in" in outcome.err
        assert [path for path in (tmp_path / "out").rglob("*") if path.is_file()] == []


def test_an_interruption_leaves_the_old_files(
    run: CommandLine, model: Path, parts: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    calls = []

    def interrupted(*arguments: Any, **options: Any) -> Any:
        calls.append(arguments)
        if len(calls) == 3:
            raise KeyboardInterrupt
        return query(*arguments, **options)

    (tmp_path / "all.parquet").write_text("old")
    monkeypatch.setattr("relforest.models.model.query", interrupted)

    assert run("predict", model, parts, "--out", tmp_path / "all.parquet", "--force").code == 130
    assert (tmp_path / "all.parquet").read_text() == "old"
    assert names_in(tmp_path) == ["all.parquet", "parts"]


@pytest.mark.parametrize(
    ("source", "out", "complaint"),
    [
        (
            "passes.csv",
            "out.parquet",
            "passes.csv is not a Parquet file, so its predictions cannot be written",
        ),
        ("passes.csv", "there", "passes.csv is not a Parquet file, so its predictions cannot be written"),
        ("parts/*.parquet", "out.csv", "is a pattern: write its predictions to a .parquet file, or to a fo"),
        ("parts/*.parquet", None, "is a pattern: write its predictions to a .parquet file, or to a fo"),
        ("none/*.parquet", "out", "the pattern none/*.parquet contains no Parquet files"),
        ("*/part-0.parquet", "out", "has several files named part-0.parquet: write to one file"),
        ("parts", "parts", "part-0.parquet is part of the table and is not replaced"),
        ("parts/part-0.parquet", "parts/part-0.parquet", "part-0.parquet is part of the table and is not"),
        ("parts", "there", "part-1.parquet exists already: choose another name, or pass --force"),
        ("bad", "out", "column 'x' is missing from bad/a.parquet"),
    ],
)
def test_impossible_outputs_are_refused_at_once(
    run: CommandLine,
    model: Path,
    parts: Path,
    monkeypatch: pytest.MonkeyPatch,
    source: str,
    out: str | None,
    complaint: str,
) -> None:
    monkeypatch.chdir(parts.parent)
    write(passes(), Path("passes.csv"))
    for folder in ("there", "other", "bad"):
        Path(folder).mkdir()
    Path("there/part-1.parquet").touch()
    write(passes(), Path("other/part-0.parquet"))
    write(passes().drop_columns(["x"]), Path("bad/a.parquet"))
    before = sorted(Path().rglob("*"))
    force = ["--force"] if out == source else []
    outcome = run("predict", model, source, *([] if out is None else ["--out", out, *force]))

    assert (outcome.code, outcome.out) == (1, "")
    assert complaint in outcome.err
    assert sorted(Path().rglob("*")) == before


@pytest.mark.parametrize(
    ("classes", "expected"),
    [((False, True), [True, False]), (("no", "yes"), ["yes", "no"]), ((0, 2**70), [str(2**70), "0"])],
)
def test_classes_keep_their_type_where_a_column_can_hold_it(
    classes: tuple[Any, Any], expected: list[Any], tmp_path: Path
) -> None:
    scenes_of([[0, 0], [1, 0]], [[0, 0]]).to_parquet(tmp_path / "scenes.parquet")
    model = Model(one_question(), "tree", "label", classes, None)
    out = tmp_path / "out.parquet"
    count = predict_stream.predict_files(model, tmp_path / "scenes.parquet", out, n_jobs=1, force=False)

    assert count == 2
    assert read_table(out)["predicted"].to_pylist() == expected
