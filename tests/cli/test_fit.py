from __future__ import annotations

import json
from pathlib import Path

import pytest
from pyarrow import parquet

from cli.command_lines import COLUMNS, N_SCENES, CommandLine, passes, write
from relforest.models import read_model
from relforest.scenes import Scenes


def test_a_tree_is_learned_told_and_written(run: CommandLine, table: Path, tmp_path: Path) -> None:
    out = tmp_path / "new" / "tree.json"
    outcome = run("fit", table, *COLUMNS, "--label", "completed", "--out", out)
    model = read_model(out)

    assert outcome.code == 0
    assert outcome.out.startswith(f"{model.tree}\n")
    assert "there is an A with extent at least 0.4" in outcome.out
    assert (
        f"probabilities are of completed = True, which {N_SCENES // 2} of {N_SCENES} scenes have"
        in outcome.out
    )
    assert "Peirce skill score on the training scenes: 1.000" in outcome.out
    assert outcome.err.splitlines()[-1] == f"wrote {out}"
    assert model.classes == (False, True)
    assert all(len(points) for points in model.points.values())


def test_the_same_seed_gives_the_same_file_from_either_format(
    run: CommandLine, model: Path, tmp_path: Path
) -> None:
    table = write(passes(), tmp_path / "passes.csv")
    run("fit", table, *COLUMNS, "--label", "completed", "--out", tmp_path / "tree.json", "--seed", "0")

    assert (tmp_path / "tree.json").read_bytes() == model.read_bytes()


def test_arguments_are_bound_first(run: CommandLine, table: Path, tmp_path: Path) -> None:
    out = tmp_path / "tree.json"
    outcome = run(
        "fit", table, *COLUMNS, "--arguments", "passer", "--label", "completed", "--out", out, "--jobs", "2"
    )

    assert outcome.code == 0
    assert "A is the passer" in outcome.out
    assert read_model(out).tree.schema.parameters == ("passer",)


def test_files_of_scenes_need_only_a_label(run: CommandLine, tmp_path: Path) -> None:
    frame = passes()
    scenes = Scenes.from_frame(frame, scene="pass", object="player", attributes={"extent": "x"})
    scenes.to_parquet(tmp_path / "scenes.parquet")
    labelled = parquet.read_table(tmp_path / "scenes.parquet").append_column("completed", frame["completed"])
    path = write(labelled, tmp_path / "labelled.parquet")
    outcome = run("fit", path, "--label", "completed", "--out", tmp_path / "tree.json")

    assert outcome.code == 0
    assert "Peirce skill score on the training scenes: 1.000" in outcome.out
    assert run("predict", tmp_path / "tree.json", tmp_path / "scenes.parquet").code == 0


def test_noise_gives_a_stub_and_says_so(run: CommandLine, tmp_path: Path) -> None:
    table = write(passes(x=[0.5] * (3 * N_SCENES)), tmp_path / "noise.parquet")
    outcome = run("fit", table, *COLUMNS, "--label", "completed", "--out", tmp_path / "tree.json")

    assert outcome.code == 0
    assert "SMRF tree with 0 questions and 1 leaf" in outcome.out
    assert "no question was significant at alpha = 0.05 on 40 scenes" in outcome.err
    assert read_model(tmp_path / "tree.json").points == {}


@pytest.mark.parametrize(
    ("options", "remark"),
    [
        (("--search", "exhaustive"), "possible questions were skipped because each has more than 100 inst"),
        ((), "possible questions were searched by a sample, because each has more than 100 instantiation"),
        ((), None),
    ],
)
def test_questions_with_too_many_sequences_are_told(
    run: CommandLine, table: Path, tmp_path: Path, options: tuple[str, ...], remark: str | None
) -> None:
    most = () if remark is None else ("--max-points", 100)
    outcome = run(
        "fit", table, *COLUMNS, "--label", "completed", "--out", tmp_path / "tree.json", *options, *most
    )

    assert outcome.code == 0
    assert remark is None or remark in outcome.err
    assert ("possible questions" in outcome.err) == (remark is not None)


def test_an_existing_model_is_replaced_only_on_demand(run: CommandLine, table: Path, tmp_path: Path) -> None:
    out = tmp_path / "tree.json"
    out.write_text("precious")
    command = ("fit", table, *COLUMNS, "--label", "completed", "--out", out)

    assert "exists already" in run(*command).err
    assert out.read_text() == "precious"
    assert run(*command, "--force").code == 0
    assert json.loads(out.read_text("utf-8"))["label"] == "completed"


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        (
            ("--label", "completed"),
            "passes.parquet was not written by Scenes.to_parquet: name its columns",
        ),
        (("--scene", "pass", "--label", "completed"), "--attribute NAME=COLUMN,... is missing"),
        (("--attribute", "extent=x", "--label", "completed"), "--scene COLUMN is missing"),
        (("--object", "player", "--label", "completed"), "--scene COLUMN is missing"),
        ((*COLUMNS, "--label", "done"), "parquet, which has 'pass', 'player', 'x', 'passer', 'comp"),
        ((*COLUMNS, "--label", "player"), "column 'player' has the values 'p0' and 'p1' in scene 100"),
        ((*COLUMNS, "--label", "passer"), "has the label 'p0' in all 40 scenes"),
        (("--scene", "pas", *COLUMNS[2:], "--label", "completed"), "column 'pas' is missing from "),
        ((*COLUMNS, "--attribute", "weight=w", "--label", "completed"), "column 'w' is missing from "),
        ((*COLUMNS, "--attribute", "name=player", "--label", "completed"), "which is not a number"),
        ((*COLUMNS, "--attribute", "extent=x", "--label", "completed"), "attribute 'extent' is given twice"),
        ((*COLUMNS, "--attribute", "location", "--label", "completed"), "'location' is not understood"),
        ((*COLUMNS, "--arguments", "receiver", "--label", "completed"), "column 'receiver' is missing from"),
        ((*COLUMNS, "--arguments", "completed", "--label", "completed"), "column 'completed' contains bool"),
        (
            (*COLUMNS, "--label", "completed", "--test", "permutation", "--alpha", "0.001"),
            "permutations=99 can never reach alpha=0.001: use at least 999",
        ),
    ],
)
def test_bad_options_and_data_are_one_clear_line(
    run: CommandLine, table: Path, tmp_path: Path, arguments: tuple[str, ...], complaint: str
) -> None:
    outcome = run("fit", table, *arguments, "--out", tmp_path / "tree.json")

    assert outcome.code == 1
    assert outcome.out == ""
    (line,) = outcome.err.splitlines()
    assert line.startswith("relforest: ")
    assert complaint in line
    assert not (tmp_path / "tree.json").exists()


@pytest.mark.parametrize(
    ("name", "content", "complaint"),
    [
        ("none.parquet", None, "none.parquet cannot be read"),
        ("passes.txt", b"x", "has the suffix '.txt'"),
        ("broken.parquet", b"PAR1 and then nothing", "is not a readable Parquet file"),
        ("broken.csv", b"pass,player,x,completed\n1,2,3\n", "broken.csv, line 2: the row has 3 of 4 fields"),
        ("empty.csv", b"pass,player,x,completed\n", "the table has no rows"),
    ],
)
def test_unreadable_tables_are_one_clear_line(
    run: CommandLine, tmp_path: Path, name: str, content: bytes | None, complaint: str
) -> None:
    if content is not None:
        (tmp_path / name).write_bytes(content)
    outcome = run("fit", tmp_path / name, *COLUMNS, "--label", "completed", "--out", tmp_path / "tree.json")

    assert outcome.code == 1
    assert complaint in outcome.err
    assert len(outcome.err.splitlines()) == 1


def test_duplicate_objects_are_named(run: CommandLine, tmp_path: Path) -> None:
    table = write(passes(player=["p0"] * (3 * N_SCENES)), tmp_path / "t.parquet")
    outcome = run("fit", table, *COLUMNS, "--label", "completed", "--out", tmp_path / "tree.json")

    assert outcome.code == 1
    assert "object 'p0' occurs twice in scene 100" in outcome.err


def test_the_positive_class_can_be_named(run: CommandLine, table: Path, tmp_path: Path) -> None:
    out = tmp_path / "tree.json"
    outcome = run("fit", table, *COLUMNS, "--label", "completed", "--positive", "False", "--out", out)

    assert outcome.code == 0
    assert "probabilities are of completed = False" in outcome.out
    assert read_model(out).classes == (True, False)


def test_an_unknown_positive_class_is_an_error(run: CommandLine, table: Path, tmp_path: Path) -> None:
    out = tmp_path / "tree.json"
    outcome = run("fit", table, *COLUMNS, "--label", "completed", "--positive", "maybe", "--out", out)

    assert outcome.code == 1
    assert (
        "positive must be one of the labels in column 'completed', False and True, got 'maybe'" in outcome.err
    )
    assert not out.exists()


HEAD = "pass;player;x;y;completed;note;note\n"
WRITTEN = HEAD + "".join(f"0{number}0;é;0,{number};1;{number % 2};\xff;\n" for number in range(10, 20))
PLACED = ("--scene", "pass", "--object", "player", "--attribute", "location=x,y", "--label", "completed")


def test_tables_of_any_dialect_are_read(run: CommandLine, tmp_path: Path) -> None:
    table, out = tmp_path / "passes.csv", tmp_path / "tree.json"
    table.write_bytes(WRITTEN.encode("latin-1"))

    assert "is not UTF-8 text (byte 0xe9 in line 2): pass" in run("fit", table, *PLACED, "--out", out).err
    named = ("--encoding", "latin-1", "--separator", ";", "--decimal", ",")
    assert run("fit", table, *PLACED, "--out", out, *named).code == 0
    predicted = run("predict", out, table, "--encoding", "latin-1")
    assert predicted.out.splitlines()[1].startswith("0100,")
    assert run("show", out, "--scene", "0100", "of", table, "--encoding", "latin-1").code == 0
    assert "'100'" in run("show", out, "--scene", "100", "of", table, *named).err
    assert "separator must be one character" in run("predict", out, table, "--separator", ";;").err
    assert (
        "decimal must be one of" in run("fit", table, *PLACED, "--out", out, "--force", "--decimal", "x").err
    )


def test_a_table_may_be_a_folder(run: CommandLine, table: Path, model: Path, tmp_path: Path) -> None:
    whole = parquet.read_table(table)
    (tmp_path / "parts").mkdir()
    for part, start in (("a", 0), ("b", 60)):
        write(whole.slice(start, 60), tmp_path / "parts" / f"{part}.parquet")
    out = tmp_path / "tree.json"

    assert run("fit", tmp_path / "parts", *COLUMNS, "--label", "completed", "--out", out).code == 0
    assert out.read_bytes() == model.read_bytes()


@pytest.mark.parametrize(
    ("labels", "positive", "classes"),
    [
        (("true", "false"), "true", (False, True)),
        (("true", "false"), "false", (True, False)),
        (("1", "0"), "1", (0, 1)),
        (("1.0", "0.0"), "0.0", (1, 0)),
        (("01", "1"), "1", ("01", "1")),
        (("01", "1"), "01", ("1", "01")),
    ],
)
def test_the_positive_class_is_named_as_it_is_written(
    run: CommandLine, tmp_path: Path, labels: tuple[str, str], positive: str, classes: tuple[object, object]
) -> None:
    column = [labels[scene % 2] for scene in range(N_SCENES) for _ in range(3)]
    table = write(passes(completed=column), tmp_path / "passes.csv")
    out = tmp_path / "tree.json"
    run("fit", table, *COLUMNS, "--label", "completed", "--positive", positive, "--out", out)

    assert read_model(out).classes == classes
    complaint = "positive must be one of the labels in column 'completed'"
    again = run("fit", table, *COLUMNS, "--label", "completed", "--positive", "001", "--out", out, "--force")
    assert complaint in again.err


def test_a_tree_that_never_says_no_is_announced(run: CommandLine, tmp_path: Path) -> None:
    # Three of four passes are completed, whatever the players do.
    column = [scene % 4 > 0 for scene in range(N_SCENES) for _ in range(3)]
    table = write(passes(completed=column, x=[0.5] * (3 * N_SCENES)), tmp_path / "passes.parquet")
    out = tmp_path / "tree.json"
    hint = "every leaf predicts positive: relforest fit --positive False looks for what exists in scenes of"

    assert hint in run("fit", table, *COLUMNS, "--label", "completed", "--out", out).out
    assert hint in run("show", out).out
    other = run(
        "fit", table, *COLUMNS, "--label", "completed", "--positive", "False", "--out", out, "--force"
    )
    assert "every leaf predicts negative: relforest fit --positive True looks for" in other.out


def test_a_tree_of_one_file_applies_to_ids_of_another_type(
    run: CommandLine, model: Path, table: Path, tmp_path: Path
) -> None:
    words = parquet.read_table(table).set_column(0, "pass", [[f"0{n // 3}" for n in range(3 * N_SCENES)]])
    outcome = run("predict", model, write(words, tmp_path / "words.parquet"))

    assert outcome.code == 0
    assert [line.split(",")[0] for line in outcome.out.splitlines()[1:4]] == ["00", "01", "02"]
