"""``relforest fit --model``: boosting, forests and rules go through the same files as trees."""

from __future__ import annotations

import csv
import io
from pathlib import Path

import numpy as np
import pytest
from pyarrow import parquet

from cli.command_lines import COLUMNS, N_SCENES, CommandLine, passes, write
from relforest.models import read_model

SMALL = {
    "boosting": ("--trees", "30"),
    "forest": ("--trees", "5"),
    "rules": ("--trees", "5"),
    "outcome": ("--trees", "10"),
}


@pytest.mark.parametrize("family", SMALL)
def test_an_ensemble_is_learned_told_and_applied(
    run: CommandLine, table: Path, tmp_path: Path, family: str
) -> None:
    out = tmp_path / "model.json"
    told = run(
        "fit", table, *COLUMNS, "--label", "completed", "--model", family, *SMALL[family], "--out", out
    )
    model = read_model(out)
    predicted = run("predict", out, table)
    rows = list(csv.DictReader(io.StringIO(predicted.out)))

    assert (told.code, predicted.code) == (0, 0)
    assert model.family == family
    assert told.out.startswith(f"{model.text}\n")
    assert "some object has extent at least 0.4" in told.out
    assert run("show", out).out == f"{model.text}\n"
    assert list(rows[0]) == ["scene", "probability", "predicted"]
    right = sum(row["predicted"] == str(number % 2 == 0) for number, row in enumerate(rows))
    assert right >= 0.9 * N_SCENES


def test_a_forest_of_smrf_trees_is_learned_told_and_applied(
    run: CommandLine, table: Path, tmp_path: Path
) -> None:
    out, options = tmp_path / "model.json", ("--model", "smrf-forest", "--trees", "4", "--attempts", "1")
    told = run("fit", table, *COLUMNS, "--label", "completed", *options, "--out", out)
    model = read_model(out)
    rows = list(csv.DictReader(io.StringIO(run("predict", out, table).out)))

    assert told.code == 0
    assert (model.family, model.learned.weights.tolist()) == ("forest", [0.25, -0.25] * 2)  # type: ignore[union-attr]
    assert told.out.startswith(f"{model.text}\n")
    assert "extent" in told.out
    assert run("show", out).out == f"{model.text}\n"
    assert sum(row["predicted"] == str(i % 2 == 0) for i, row in enumerate(rows)) >= 0.9 * N_SCENES


def test_questions_that_were_not_all_searched_are_told(run: CommandLine, table: Path, tmp_path: Path) -> None:
    options = ("--model", "smrf-forest", "--trees", "2", "--max-points", "20", "--search", "exhaustive")
    told = run("fit", table, *COLUMNS, "--label", "completed", *options, "--out", tmp_path / "model.json")

    assert "possible questions of a tree were skipped because each has more than 20" in told.err


def test_predictions_are_written_to_parquet(run: CommandLine, table: Path, tmp_path: Path) -> None:
    out = tmp_path / "model.json"
    run("fit", table, *COLUMNS, "--label", "completed", "--model", "forest", *SMALL["forest"], "--out", out)
    assert run("predict", out, table, "--out", tmp_path / "all.parquet").code == 0
    found = parquet.read_table(tmp_path / "all.parquet")
    rows = list(csv.DictReader(io.StringIO(run("predict", out, table).out)))

    assert found.column_names == ["scene", "probability", "predicted"]
    assert np.allclose(found["probability"], [float(row["probability"]) for row in rows], atol=1e-5)


def test_categories_are_learned_from_and_matched_by_name(run: CommandLine, tmp_path: Path) -> None:
    frame = passes()
    teams = ["red" if x > 0.4 else "blue" for x in frame["x"].to_pylist()]
    columns = ("--scene", "pass", "--object", "player", "--attribute", "team=team:category")
    table = write(frame.append_column("team", [teams]), tmp_path / "teams.csv")
    for family in ("tree", "boosting"):
        out = tmp_path / f"{family}.json"
        outcome = run("fit", table, *columns, "--label", "completed", "--model", family, "--out", out)

        assert outcome.code == 0
        assert "team red" in outcome.out
        assert "Peirce skill score on the training scenes: 1.000" in outcome.out
    only_red = write(passes().append_column("team", [["red"] * len(teams)]), tmp_path / "red.csv")
    assert ",False" not in run("predict", tmp_path / "boosting.json", only_red).out
    other = write(passes().append_column("team", [["green"] * len(teams)]), tmp_path / "green.csv")
    refused = run("predict", tmp_path / "boosting.json", other)
    assert refused.code == 1
    assert "'team' is 'green'" in refused.err


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (
            ("--model", "boosting", "--alpha", "0.01"),
            "--alpha is an option of --model tree, smrf-forest, not of",
        ),
        (
            ("--trees", "5"),
            "--trees is an option of --model boosting, forest, smrf-forest, rules, outcome, not of tree",
        ),
        (
            ("--model", "smrf-forest", "--objects", "1"),
            "--objects is an option of --model boosting, forest, rules, outcome, not of smrf-forest",
        ),
        (("--model", "rules", "--objects", "3"), "max_free must be an integer from 0 to 2"),
        (("--model", "forest", "--trees", "0"), "trees must be an integer of at least 1"),
    ],
)
def test_options_of_other_models_are_refused(
    run: CommandLine, table: Path, tmp_path: Path, options: tuple[str, ...], message: str
) -> None:
    out = tmp_path / "model.json"
    outcome = run("fit", table, *COLUMNS, "--label", "completed", *options, "--out", out)

    assert outcome.code in {1, 2}
    assert message in outcome.err
    assert not out.exists()


def test_an_ensemble_has_no_drawing(run: CommandLine, table: Path, tmp_path: Path) -> None:
    out = tmp_path / "model.json"
    run("fit", table, *COLUMNS, "--label", "completed", "--model", "forest", *SMALL["forest"], "--out", out)
    outcome = run("show", out, "--out", tmp_path / "tree.svg")

    assert outcome.code == 1
    assert "drawings and paths are those of a single tree" in outcome.err


def test_a_relation_is_a_column_that_prediction_needs_too(run: CommandLine, tmp_path: Path) -> None:
    rng = np.random.default_rng(0)
    partner = rng.integers(1, 3, N_SCENES)
    x = rng.uniform(0.0, 1.0, (N_SCENES, 3))
    x[:, 0] = 0.5
    near = [["", "", ""] for _ in partner]
    for own, other in zip(near, partner.tolist(), strict=True):
        own[0], own[other] = f"p{other}", "p0"
    table = passes(
        x=x.ravel().tolist(),
        near=[each for own in near for each in own],
        completed=np.repeat(x[np.arange(N_SCENES), partner] > 0.5, 3).tolist(),
    )
    path, out = write(table, tmp_path / "passes.csv"), tmp_path / "model.json"
    fit = ("fit", path, *COLUMNS, "--arguments", "passer", "--label", "completed", "--out", out)
    told = run(*fit, "--relation", "touches=near", "--model", "boosting", "--trees", "3")

    assert told.code == 0
    assert "some object that touches the passer has extent at least 0.5" in told.out
    assert "Peirce skill score on the training scenes: 1.000" in told.out
    assert run("predict", out, path).out.count("\n") == N_SCENES + 1
    assert "touches the passer" in run("explain", out, "--scene", "100", "of", path).out
    missing = write(table.drop_columns(["near"]), tmp_path / "other.csv")
    assert "column 'near' is missing from" in run("predict", out, missing).err
    refused = run(*fit, "--relation", "touches=near", "--force")
    assert (refused.code, "SMRF trees do not ask about relations" in refused.err) == (1, True)
