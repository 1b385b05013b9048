from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pytest

from cli.command_lines import N_SCENES, passes, write
from relforest.models import TrainingData, read_training_data
from relforest.models.training_data import Target
from relforest.scenes import Attribute, Scenes
from relforest.scenes.frames import FrameLayout
from relforest.scenes.parquet import to_table
from relforest.support.errors import InputError

ATTRIBUTES: Mapping[str | Attribute, str] = {"extent": "x"}


def read(path: Path, label: str = "y", **options: Any) -> TrainingData:
    return read_training_data(path, label, scene="pass", object="player", attributes=ATTRIBUTES, **options)


def labelled(path: Path, values: list[Any], name: str = "y") -> Path:
    """Passes with these values in turn, as a Parquet or CSV file."""
    column = [values[scene % len(values)] for scene in range(N_SCENES) for _ in range(3)]
    return write(passes().append_column(name, [column]), path)


@pytest.mark.parametrize(
    ("values", "classes"),
    [
        ([True, False], (False, True)),
        ([1, 0], (0, 1)),
        ([1, -1], (-1, 1)),
        ([1.0, 0.0], (0, 1)),
        ([3, 1, 2], (1, 2, 3)),
        (["yes", "no"], ("no", "yes")),
        (["b", "c", "a"], ("a", "b", "c")),
        (["01", "1"], ("01", "1")),
        ([f"class {number}" for number in range(20)], tuple(sorted(f"class {n}" for n in range(20)))),
    ],
)
@pytest.mark.parametrize("suffix", ["parquet", "csv"])
def test_words_booleans_and_few_whole_numbers_are_classes(
    tmp_path: Path, values: list[Any], classes: tuple[Any, ...], suffix: str
) -> None:
    data = read(labelled(tmp_path / f"t.{suffix}", values))

    assert data.classes == classes
    assert [type(label) for label in data.classes or ()] == [type(label) for label in classes]
    assert [classes[place] for place in data.y[: len(values)]] == values


@pytest.mark.parametrize(
    "values", [[0.5, 1.5], [*range(11)], ["1.50", "2.0"], ["1e3", "0.25"], ["1,5", "22,75"]]
)
@pytest.mark.parametrize("suffix", ["parquet", "csv"])
def test_fractions_and_many_numbers_are_numbers(tmp_path: Path, values: list[Any], suffix: str) -> None:
    data = read(labelled(tmp_path / f"t.{suffix}", values))

    assert data.classes is None
    assert data.y[: len(values)].tolist() == [float(str(value).replace(",", ".")) for value in values]


@pytest.mark.parametrize(
    ("values", "target", "classes"),
    [([1, 2, 3], "numbers", None), ([True, False], "numbers", None), ([*range(11)], "classes", 11)],
)
def test_what_is_meant_can_be_said(
    tmp_path: Path, values: list[Any], target: Target, classes: int | None
) -> None:
    data = read(labelled(tmp_path / "t.parquet", values), target=target)

    assert (data.classes and len(data.classes)) == classes
    assert np.unique(data.y).tolist() == sorted(map(float, values))


@pytest.mark.parametrize(("positive", "expected"), [(True, True), (False, False), ("False", False)])
def test_the_positive_class_is_the_second_one(tmp_path: Path, positive: Any, expected: bool) -> None:  # noqa: FBT001
    data = read(labelled(tmp_path / "t.parquet", [True, False]), positive=positive)

    assert data.classes == (not expected, expected)
    assert data.y[:2].tolist() == [int(expected), int(not expected)]


@pytest.mark.parametrize(
    ("values", "options", "complaint"),
    [
        ([1], {}, "has the label 1 in all 40 scenes: learning needs scenes of both"),
        (["yes"], {}, "has the label 'yes' in all 40 scenes"),
        ([2.5], {}, r"has the label 2.5 in all 40 scenes: learning needs numbers that differ"),
        ([None, 1], {}, "lacks a value in scene 100"),
        ([1.0, float("nan")], {}, "lacks a value in scene 101"),
        (["1.5", "NA"], {}, "lacks a number in scene 101: fill it in or drop the scene"),
        ([1.5, float("inf")], {}, "column 'y' is infinite in scene 101"),
        (["a", "b"], {"target": "numbers"}, "column 'y' contains 'a' in scene 100, which is not a number"),
        ([0.5, 1.5], {"target": "classes"}, "holds 0.5: classes are words, booleans or whole numbers"),
        ([*range(40)], {"target": "classes"}, "40 scenes have 40 classes: give at least two"),
        ([1, 2], {"target": "both"}, "target must be one of"),
        (["a", "b", "c"], {"positive": "a"}, "positive is for two classes, but column 'y' holds 3"),
        ([0.5, 1.5], {"positive": "1.5"}, "positive is for two classes, but column 'y' holds numbers"),
        (["a", "b"], {"positive": "c"}, "positive must be one of the labels in column 'y', a and b, got 'c'"),
        (["a\x07", "b"], {}, r"character U\+0007 in 'a\\x07': .* a model could not be written"),
    ],
)
def test_other_labels_are_refused_before_anything_is_learned(
    tmp_path: Path, values: list[Any], options: dict[str, Any], complaint: str
) -> None:
    path = labelled(tmp_path / "t.parquet", values)
    with pytest.raises(InputError, match=complaint):
        read(path, **options)


def test_names_of_columns_must_be_writable(tmp_path: Path) -> None:
    path = labelled(tmp_path / "t.parquet", ["a", "b"], name="y\x1b")
    with pytest.raises(InputError, match=r"character U\+001B in 'y\\x1b'"):
        read(path, "y\x1b")


def test_labels_are_constant_within_a_scene(tmp_path: Path) -> None:
    path = write(passes(y=[True] * (N_SCENES * 3 - 1) + [False]), tmp_path / "t.parquet")
    with pytest.raises(InputError, match="column 'y' has the values True and False in scene 139"):
        read(path)


def test_decimals_are_numbers(tmp_path: Path) -> None:
    column = pa.array(range(N_SCENES * 3)).cast(pa.decimal128(20, 1))
    whole = passes().set_column(0, "pass", [range(N_SCENES * 3)]).append_column("y", column)
    data = read(write(whole, tmp_path / "t.parquet"))
    few = passes().set_column(0, "pass", [range(N_SCENES * 3)])
    few = few.append_column("y", pa.array([n % 2 for n in range(N_SCENES * 3)]).cast(pa.decimal128(20, 1)))

    assert data.y.tolist() == list(range(N_SCENES * 3))
    assert read(write(few, tmp_path / "few.parquet")).classes == (0, 1)


def test_files_of_scenes_need_no_columns(tmp_path: Path) -> None:
    frame = passes()
    scenes = Scenes.from_frame(frame, scene="pass", object="player", attributes=ATTRIBUTES)
    table = to_table(scenes.parts).append_column("completed", frame["completed"])
    data = read_training_data(write(table, tmp_path / "own.parquet"), "completed")

    assert data.y.tolist() == [1, 0] * (N_SCENES // 2)
    assert data.columns == FrameLayout("scene", "object", ((Attribute("extent"), ("extent",)),))


def test_other_tables_need_columns(tmp_path: Path) -> None:
    path = write(passes(), tmp_path / "t.csv")
    with pytest.raises(InputError, match="name its columns with scene= and attributes="):
        read_training_data(path, "completed")
