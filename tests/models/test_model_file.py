from __future__ import annotations

import copy
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from relforest.models import Model, read_model, write_model
from relforest.models.model_file import MOST_POINTS
from relforest.reports import QuestionPoints
from relforest.scenes.frames import FrameLayout
from relforest.support.errors import ModelFormatError
from reports.drawn_trees import SCHEMA, five_questions, one_question

NAMES = (("x", "y"), ("theta",), ("r", "g", "b"), ("cost",))
COLUMNS = FrameLayout("pass", "player", tuple(zip(SCHEMA.attributes, NAMES, strict=True)), ("passer",))


def a_model(n_points: int = 4) -> Model:
    points = QuestionPoints(np.arange(2.0 * n_points).reshape(-1, 2) / 3, np.arange(n_points) % 2 == 0)
    return Model(one_question(), "tree", "completed", (False, True), COLUMNS, {2: points})


def written(path: Path, model: Model) -> dict[str, Any]:
    write_model(path, model)
    document: dict[str, Any] = json.loads(path.read_text("utf-8"))
    return document


def test_a_model_comes_back_as_it_was(tmp_path: Path) -> None:
    model = a_model()
    write_model(tmp_path / "tree.json", model)
    found = read_model(tmp_path / "tree.json")

    assert found.tree.to_dict() == model.tree.to_dict()
    assert (found.label, found.classes, found.columns) == (model.label, model.classes, COLUMNS)
    assert found.outcome == "completed = True"
    # Positive points come first; 1/3, 2/3 and so on are kept to five digits.
    assert found.points[2].points.tolist() == [[0, 0.33333], [1.3333, 1.6667], [0.66667, 1], [2, 2.3333]]
    assert found.points[2].positive.tolist() == [True, True, False, False]


@pytest.mark.parametrize("classes", [(0, 1), (-1, 1), ("lost", "won")])
def test_labels_of_all_kinds_come_back(tmp_path: Path, classes: tuple[Any, Any]) -> None:
    write_model(tmp_path / "tree.json", Model(one_question(), "tree", "y", classes, None))
    found = read_model(tmp_path / "tree.json")

    assert found.classes == classes
    assert [type(label) for label in found.classes] == [type(label) for label in classes]
    assert found.columns is None


def test_only_a_sample_of_the_points_is_stored(tmp_path: Path) -> None:
    write_model(tmp_path / "tree.json", a_model(1000))

    assert len(read_model(tmp_path / "tree.json").points[2]) == 2 * MOST_POINTS


def test_writing_what_was_read_gives_the_same_file(tmp_path: Path) -> None:
    write_model(tmp_path / "a.json", a_model(500))
    write_model(tmp_path / "b.json", read_model(tmp_path / "a.json"))
    write_model(tmp_path / "c.json", read_model(tmp_path / "b.json"))

    assert (tmp_path / "b.json").read_bytes() == (tmp_path / "c.json").read_bytes()


def test_bare_trees_are_models_without_names(tmp_path: Path) -> None:
    path = tmp_path / "0001-left-1.json"
    path.write_text(json.dumps(five_questions().to_dict()))
    model = read_model(path)

    assert model.tree.to_dict() == five_questions().to_dict()
    assert model.outcome == "the positive class"
    assert model.columns is None
    assert model.points == {}


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("", "is not valid JSON"),
        ("[1]", "expected an object"),
        ("[" * 100_000, "nested more than"),
        ('{"format": "other", "version": 1}', "its format is 'other'"),
        ('{"format": "relforest-model", "version": 3}', "was written by a newer relforest"),
        ('{"format": "relforest-model", "version": NaN}', "an invalid version|not finite"),
        ('{"format": "relforest-model", "version": 1}', "does not contain a valid tree"),
        ('{"format": "relforest-tree", "version": 1, "nodes": []}', "does not contain a valid tree"),
        ("\x00\x01pickle", "is not valid JSON"),
    ],
)
def test_other_files_are_refused(tmp_path: Path, text: str, complaint: str) -> None:
    path = tmp_path / "hostile.json"
    path.write_text(text)

    with pytest.raises(ModelFormatError, match=complaint):
        read_model(path)


def test_missing_files_and_folders_are_refused(tmp_path: Path) -> None:
    with pytest.raises(ModelFormatError, match=r"none\.json cannot be read: No such file"):
        read_model(tmp_path / "none.json")
    with pytest.raises(ModelFormatError, match="not a regular file"):
        read_model(tmp_path)


def damage(*keys: str | int, value: object) -> Callable[[dict[str, Any]], None]:
    """Return a function that replaces one part of a document."""

    def change(document: Any) -> None:
        for key in keys[:-1]:
            document = document[key]
        document[keys[-1]] = value

    return change


@pytest.mark.parametrize(
    "change",
    [
        damage("label", value=3),
        damage("classes", value=[1]),
        damage("classes", value=[0, 1, 2]),
        damage("classes", value=[None, 1]),
        damage("classes", value="yes"),
        damage("columns", value=[]),
        damage("columns", "scene", value=None),
        damage("columns", "object", value=1),
        damage("columns", "attributes", value={"location": ["x", "y"]}),
        damage("columns", "attributes", "location", value="xy"),
        damage("columns", "arguments", value=[1]),
        damage("classes", value=["1", 1]),
        damage("columns", "attributes", value={name: ["x"] for name in SCHEMA.names}),
        damage("columns", "arguments", value=["p", "q"]),
        damage("points", 0, "positive", value=[[0.0, 1e41]]),
        damage("points", 0, "positive", value=[["1", "2"]]),
        damage("points", 0, "negative", value=[[0.0, 0.0]] * (MOST_POINTS + 1)),
        damage("points", value=3),
        damage("points", 0, "node", value=0),
        damage("points", 0, "node", value=-1),
        damage("points", 0, "node", value="2"),
        damage("points", 0, "positive", value=[[1, 2, 3]]),
        damage("points", 0, "positive", value=[["a", "b"]]),
        damage("points", 0, "negative", value={"a": 1}),
        damage("points", 0, value=[]),
        lambda document: document.pop("columns"),
        lambda document: document.pop("points"),
    ],
)
def test_damaged_models_are_refused(tmp_path: Path, change: Callable[[dict[str, Any]], None]) -> None:
    path = tmp_path / "tree.json"
    document = copy.deepcopy(written(path, a_model()))
    change(document)
    path.write_text(json.dumps(document))

    with pytest.raises(
        ModelFormatError, match=r"tree\.json is damaged: .*; restore it, or learn the model again"
    ):
        read_model(path)


@pytest.mark.parametrize(
    "change", [damage("classes", value=["a\x00", "b"]), damage("label", value="\ud800")], ids=["nul", "half"]
)
def test_text_that_cannot_be_shown_is_refused(tmp_path: Path, change: Callable[[Any], None]) -> None:
    path = tmp_path / "tree.json"
    document = written(path, a_model())
    change(document)
    path.write_text(json.dumps(document))

    with pytest.raises(ModelFormatError, match=r"tree\.json contains the character U\+(0000|D800) in "):
        read_model(path)


def test_damaged_trees_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "tree.json"
    document = written(path, a_model())
    document["tree"]["nodes"].pop()
    path.write_text(json.dumps(document))

    with pytest.raises(ModelFormatError, match="does not contain a valid tree"):
        read_model(path)
