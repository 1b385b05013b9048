"""Model files: a tree and everything needed to apply it to a table.

A model file is a JSON document of format ``relforest-model``: the label and its two classes, the columns that
the scenes were read from, the tree as written by `Tree.to_dict`, and a sample of the training points of each
question, for pictures.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final, final

import numpy as np
from numpy.typing import NDArray

from relforest.cli.columns import Columns
from relforest.reports import QuestionPoints
from relforest.support.documents import well_formed
from relforest.support.errors import ModelFormatError
from relforest.support.files import read_json, write_json
from relforest.trees import Question, Tree
from relforest.trees.text import describe
from relforest.trees.tree import FORMAT as TREE_FORMAT
from relforest.trees.tree import VERSION as TREE_VERSION
from relforest.volumes.ellipsoid import LARGEST_VALUE

FORMAT: Final = "relforest-model"
VERSION: Final = 1
MOST_POINTS: Final = 150
"""Largest number of points per class stored for a question."""

Label = bool | int | str


@final
@dataclass(frozen=True, slots=True, eq=False)
class Model:
    """A tree and how to apply it.

    Parameters
    ----------
    tree : Tree
    label : str
        The column of labels that the tree predicts; empty if unknown.
    classes : tuple of two labels
        The second one is the positive class.
    columns : Columns or None
        Where to find scenes in a table; None if unknown.
    points : mapping of int to QuestionPoints
        Training points of questions, by node index.
    """

    tree: Tree
    label: str
    classes: tuple[Label, Label]
    columns: Columns | None
    points: Mapping[int, QuestionPoints] = field(default_factory=dict)

    @property
    def text(self) -> str:
        """The tree in words."""
        other = str(self.classes[0]) if self.label else "LABEL"
        return describe(self.tree.schema, self.tree.nodes, other=other)

    @property
    def remedy(self) -> str:
        """What to do about a table of unknown columns, for error messages."""
        return "the model does not name the columns of its scenes, so use a file that was"

    @property
    def positive(self) -> str:
        """The positive class in words, such as ``completed = True``."""
        return f"{self.label} = {self.classes[1]}" if self.label else "the positive class"


def write_model(path: Path, model: Model) -> None:
    """Write a model file atomically."""
    columns = model.columns
    write_json(
        path,
        {
            "format": FORMAT,
            "version": VERSION,
            "label": model.label,
            "classes": list(model.classes),
            "columns": None
            if columns is None
            else {
                "scene": columns.scene,
                "object": columns.object,
                "attributes": {attribute.name: list(names) for attribute, names in columns.attributes},
                "arguments": list(columns.arguments),
            },
            "tree": model.tree.to_dict(),
            "points": [
                _points_to_dict(index, node, model.points[index])
                for index, node in enumerate(model.tree.nodes)
                if isinstance(node, Question) and index in model.points
            ],
        },
    )


def read_model(path: Path) -> Model:
    """Read a model file, or the file of a single tree from a run folder.

    Raises
    ------
    ModelFormatError
        If the file is neither, or is damaged. Nothing in it is executed.
    """
    try:
        document = read_json(path, format=FORMAT, version=VERSION)
    except ModelFormatError as error:
        try:
            bare = read_json(path, format=TREE_FORMAT, version=TREE_VERSION)
        except ModelFormatError:
            raise error from None
        return Model(_tree(path, bare), "", (False, True), None)
    tree = _tree(path, document.get("tree"))
    with well_formed(f"{path} is damaged", "restore it, or learn the tree again with relforest fit"):
        return Model(
            tree,
            _text(document["label"]),
            _classes(document["classes"]),
            _columns(document["columns"], tree),
            dict(_points(entry, tree) for entry in document["points"]),
        )


def _tree(path: Path, document: object) -> Tree:
    with well_formed(f"{path} does not contain a valid tree"):
        return Tree.from_dict(document)


def _text(value: object) -> str:
    if not isinstance(value, str):
        raise TypeError(f"expected a string, got {value!r:.50}")
    return value


def _texts(values: object) -> tuple[str, ...]:
    if not isinstance(values, list):
        raise TypeError(f"expected a list of strings, got {values!r:.50}")
    return tuple(map(_text, values))


def _classes(value: object) -> tuple[Label, Label]:
    if not isinstance(value, list) or not all(isinstance(entry, (bool, int, str)) for entry in value):
        raise TypeError(f"expected a list of two labels, got {value!r:.50}")
    first, second = value
    # Compared as printed by the command line.
    if str(first) == str(second):
        raise ValueError(f"the two classes must differ, got {value!r:.50}")
    return first, second


def _columns(document: Any, tree: Tree) -> Columns | None:  # noqa: ANN401 - not checked yet
    if document is None:
        return None
    attributes = {name: _texts(names) for name, names in document["attributes"].items()}
    components = [attribute.dim for attribute in tree.schema.attributes]
    if list(attributes) != list(tree.schema.names) or list(map(len, attributes.values())) != components:
        raise ValueError("the columns do not match the attributes of the tree")
    if len(document["arguments"]) != tree.schema.n_parameters:
        raise ValueError("the columns of arguments do not match the tree")
    return Columns(
        _text(document["scene"]),
        None if document["object"] is None else _text(document["object"]),
        tuple((tree.schema[name], names) for name, names in attributes.items()),
        _texts(document["arguments"]),
    )


def _points_to_dict(index: int, question: Question, points: QuestionPoints) -> dict[str, Any]:
    sample = points.thinned(MOST_POINTS, question.volume)
    # Five digits are more than a picture can show.
    rounded = [[float(f"{value:.5g}") for value in point] for point in sample.points.tolist()]
    return {
        "node": index,
        "positive": [p for p, is_positive in zip(rounded, sample.positive, strict=True) if is_positive],
        "negative": [p for p, is_positive in zip(rounded, sample.positive, strict=True) if not is_positive],
    }


def _points(document: Any, tree: Tree) -> tuple[int, QuestionPoints]:  # noqa: ANN401 - not checked yet
    index = document["node"]
    node = tree.nodes[index] if isinstance(index, int) and 0 <= index < len(tree.nodes) else None
    if not isinstance(node, Question):
        raise TypeError(f"node {index!r:.50} is not a question")
    positive, negative = (_sample(document[key], node.mapping.dim) for key in ("positive", "negative"))
    labels = np.repeat([True, False], [len(positive), len(negative)])
    return index, QuestionPoints(np.concatenate([positive, negative]), labels)


def _sample(rows: object, dim: int) -> NDArray[np.float64]:
    if not isinstance(rows, list) or len(rows) > MOST_POINTS:
        raise ValueError(f"a question has at most {MOST_POINTS} points of either class, got {rows!r:.50}")
    numbers = np.array(rows)
    if numbers.dtype.kind not in "iuf":
        raise TypeError(f"points must be lists of numbers, got {rows!r:.50}")
    points = numbers.astype(np.float64).reshape(-1, dim)
    # The negated test also catches NaN.
    if not (np.abs(points) <= LARGEST_VALUE).all():
        raise ValueError(f"a point must be finite and at most {LARGEST_VALUE:g}")
    return points
