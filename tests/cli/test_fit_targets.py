"""``relforest fit`` for several classes and for numbers: through the same files as two classes."""

from __future__ import annotations

import csv
import io
from pathlib import Path

import numpy as np
import pyarrow as pa
import pytest
from pyarrow import parquet

from cli.command_lines import COLUMNS, N_SCENES, CommandLine, passes, write
from relforest.models import read_model

SMALL = {
    "tree": (),
    "boosting": ("--trees", "30"),
    "forest": ("--trees", "10"),
    "smrf-forest": ("--trees", "3", "--attempts", "1"),
}
CLASSES = ("far", "middle", "near")


@pytest.fixture(scope="module")
def targets(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Passes with where the last player stands, and the largest x in other units."""
    rng = np.random.default_rng(1)
    which = np.arange(N_SCENES) % 3
    x = rng.uniform(0.0, 0.2, (N_SCENES, 3))
    x[:, -1] = np.array([0.9, 0.5, 0.1])[which] + rng.uniform(-0.05, 0.05, N_SCENES)
    frame = passes(x=x.ravel().tolist())
    frame = frame.append_column("where", [np.repeat(np.array(CLASSES)[which], 3)])
    frame = frame.append_column("reach", pa.array(np.repeat(10 * x.max(axis=1), 3)))
    return write(frame, tmp_path_factory.mktemp("targets") / "passes.parquet")


def rows_of(text: str) -> list[dict[str, str]]:
    return list(csv.DictReader(io.StringIO(text)))


@pytest.mark.parametrize("family", SMALL)
def test_several_classes_are_learned_told_and_predicted(
    run: CommandLine, targets: Path, tmp_path: Path, family: str
) -> None:
    out, many = tmp_path / "model.json", tmp_path / "all.parquet"
    told = run("fit", targets, *COLUMNS, "--label", "where", "--model", family, *SMALL[family], "--out", out)
    rows = rows_of(run("predict", out, targets).out)
    wrote = run("predict", out, targets, "--out", many)
    found = parquet.read_table(many)

    assert (told.code, read_model(out).classes) == (0, CLASSES)
    assert "are of where = far, middle, near, which 14, 13, 13 of 40 scenes have" in told.out
    assert "accuracy on the training scenes: " in told.out
    assert ("accuracy on them by the trees that did not see them" in told.out) == family.endswith("forest")
    assert run("show", out).out == f"{read_model(out).text}\n"
    assert "where = far, middle, near" in told.out.split("probabilities")[0] or "where = near" in told.out
    assert list(rows[0])[:5] == ["scene", "predicted", *(f"probability_{each}" for each in CLASSES)]
    assert list(rows[0])[5:] == (["leaf", "witness_A"] if family == "tree" else [])
    assert sum(row["predicted"] == CLASSES[number % 3] for number, row in enumerate(rows)) >= 0.6 * N_SCENES
    assert [sum(float(row[f"probability_{each}"]) for each in CLASSES) for row in rows] == pytest.approx(
        [1.0] * N_SCENES, abs=1e-4
    )
    assert wrote.err.startswith(f"wrote {N_SCENES} predictions of where = far, middle, near to")
    assert found.column_names == list(rows[0])
    assert found["predicted"].to_pylist() == [row["predicted"] for row in rows]


@pytest.mark.parametrize("family", SMALL)
def test_numbers_are_learned_told_and_predicted(
    run: CommandLine, targets: Path, tmp_path: Path, family: str
) -> None:
    out, many = tmp_path / "model.json", tmp_path / "all.parquet"
    told = run("fit", targets, *COLUMNS, "--label", "reach", "--model", family, *SMALL[family], "--out", out)
    rows = rows_of(run("predict", out, targets).out)
    wrote = run("predict", out, targets, "--out", many)
    found = parquet.read_table(many)
    reach = np.array(parquet.read_table(targets)["reach"])[::3]
    predicted = np.array([float(row["prediction"]) for row in rows])

    assert (told.code, read_model(out).classes) == (0, None)
    assert "predictions are of reach, 0.5" in told.out
    assert "R2 on the training scenes: 0." in told.out
    assert ("R2 on them by the trees that did not see them: 0." in told.out) == family.endswith("forest")
    assert run("show", out).out == f"{read_model(out).text}\n"
    assert list(rows[0]) == ["scene", "prediction", *(("leaf", "witness_A") if family == "tree" else ())]
    # Of two or three levels, trees of tested questions tell two apart.
    assert ((predicted - reach) ** 2).mean() < 0.4 * reach.var()
    assert wrote.err.startswith(f"wrote {N_SCENES} predictions of reach to")
    assert found["prediction"].to_pylist() == pytest.approx(predicted.tolist(), rel=1e-5)


def test_trees_of_any_target_are_drawn_and_followed(run: CommandLine, targets: Path, tmp_path: Path) -> None:
    for label, says in (("where", "scene 100: 0.52, 0.00, 0.48"), ("reach", "scene 100: mean ")):
        out, picture = tmp_path / f"{label}.json", tmp_path / f"{label}.svg"
        run("fit", targets, *COLUMNS, "--label", label, "--out", out)
        shown = run("show", out, "--scene", "100", "of", targets, "--out", picture)

        assert shown.code == 0
        assert says in shown.out
        assert picture.exists()


@pytest.mark.parametrize(
    ("options", "complaint"),
    [
        (("--label", "where", "--model", "rules"), "is for two classes, but column 'where' holds 3 classes"),
        (("--label", "reach", "--model", "rules"), "but column 'reach' holds numbers: use --model boosting"),
        (
            ("--label", "where", "--positive", "far"),
            "positive is for two classes, but column 'where' holds 3",
        ),
        (("--label", "where", "--target", "numbers"), "column 'where' contains 'far' in scene 100, which is"),
        (("--label", "reach", "--target", "classes"), 'choose the target "numbers"'),
    ],
)
def test_models_and_options_of_other_targets_are_refused(
    run: CommandLine, targets: Path, tmp_path: Path, options: tuple[str, ...], complaint: str
) -> None:
    outcome = run("fit", targets, *COLUMNS, *options, "--out", tmp_path / "model.json")

    assert (outcome.code, outcome.out) == (1, "")
    assert complaint in outcome.err
    assert list(tmp_path.iterdir()) == []


def test_names_that_no_file_can_hold_are_refused_before_learning(run: CommandLine, tmp_path: Path) -> None:
    column = ["a\x07" if scene % 2 else "b" for scene in range(N_SCENES) for _ in range(3)]
    table = write(passes(completed=column), tmp_path / "passes.parquet")
    outcome = run("fit", table, *COLUMNS, "--label", "completed", "--out", tmp_path / "tree.json")

    assert (outcome.code, outcome.out) == (1, "")
    assert "contains the character U+0007" in outcome.err
    assert "change it in the table" in outcome.err
