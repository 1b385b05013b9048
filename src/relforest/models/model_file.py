"""Model files: what was learned and everything needed to apply it to a table.

A model file is a JSON document of format ``relforest-model``: the label and its classes (null for numbers),
the columns that the scenes were read from, and either the tree as written by `Tree.to_dict` with a sample of
the training points of each question, for pictures, or an ensemble as written by `Ensemble.to_dict`, the
family of the model and, for outcomes, the threshold of its probabilities.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final, cast

import numpy as np
from numpy.typing import NDArray

from relforest.forests import Ensemble
from relforest.models.model import Family, Label, Model, n_classes
from relforest.reports import QuestionPoints
from relforest.scenes import Schema
from relforest.scenes.frames import FrameLayout, frame_layout
from relforest.scenes.mean_object import without_mean
from relforest.support.documents import check_values, well_formed
from relforest.support.errors import InputError, ModelFormatError
from relforest.support.files import read_json, write_json
from relforest.support.options import in_range, one_of
from relforest.trees import Question, Tree
from relforest.trees.tree import FORMAT as TREE_FORMAT
from relforest.trees.tree import VERSION as TREE_VERSION
from relforest.volumes.ellipsoid import LARGEST_VALUE

FORMAT: Final = "relforest-model"
VERSION: Final = 2
"""The newest version; models of two classes are still written as version 1, which older releases read."""
MOST_POINTS: Final = 150
"""Largest number of points per class stored for a question."""

_ENSEMBLES: Final = ("forest", "boosting", "rules", "outcome")


def check_names(label: str, classes: Sequence[Label] | None, columns: FrameLayout, origin: str) -> None:
    """Check that names in a table can be written to a model file.

    Raises
    ------
    InputError
        If a label or the name of a column contains control characters or lone surrogates, or is too long.
    """
    try:
        check_values(_header(label, classes, columns), origin)
    except ModelFormatError as error:
        raise InputError(f"{error}: a model could not be written, so change it in the table") from error


def write_model(path: Path, model: Model) -> None:
    """Write a model file atomically."""
    document = _header(model.label, model.classes, model.columns)
    if isinstance(model.learned, Ensemble):
        document |= {"kind": model.family, "ensemble": model.learned.to_dict()}
        write_json(path, document | ({"threshold": model.threshold} if model.family == "outcome" else {}))
        return
    points = [
        _points_to_dict(index, node, model.points[index])
        for index, node in enumerate(model.learned.nodes)
        if isinstance(node, Question) and index in model.points
    ]
    write_json(path, document | {"tree": model.learned.to_dict(), "points": points})


def read_model(path: Path) -> Model:
    """Read a model file, or the file of a single tree from a run folder.

    Raises
    ------
    ModelFormatError
        If the file is neither, or is damaged. Nothing in it is executed.
    """
    return model_of(read_json(path, format=FORMAT, version=VERSION, others={TREE_FORMAT: TREE_VERSION}), path)


def model_of(document: dict[str, Any], path: Path) -> Model:
    """Return the model of a document that was read from a file; see `read_model`."""
    if document["format"] == TREE_FORMAT:
        tree = _tree(path, document)
        n = n_classes(tree)
        classes: tuple[Label, ...] | None = (
            (False, True) if n == 2 else None if n is None else tuple(range(n))
        )
        return Model(tree, "tree", "", classes, None)
    sound = well_formed(f"{path} is damaged", "restore it, or learn the model again with relforest fit")
    if "ensemble" in document:
        with sound:
            ensemble = Ensemble.from_dict(document["ensemble"])
            family = cast("Family", one_of("kind", document["kind"], _ENSEMBLES))
            threshold = in_range("threshold", document.get("threshold", 0.5), 0.0, 1.0)
            return Model(
                ensemble, family, *_how_to_apply(document, without_mean(ensemble.schema)), threshold=threshold
            )
    tree = _tree(path, document.get("tree"))
    with sound:
        points = dict(_points(entry, tree) for entry in document["points"])
        return Model(tree, "tree", *_how_to_apply(document, tree.schema), points)


def _header(label: str, classes: Sequence[Label] | None, columns: FrameLayout | None) -> dict[str, Any]:
    """Return how to apply a model, as the first part of its document."""
    return {
        "format": FORMAT,
        "version": 1 if classes is not None and len(classes) == 2 else VERSION,
        "label": label,
        "classes": None if classes is None else list(classes),
        "columns": None
        if columns is None
        else {
            "scene": columns.scene,
            "object": columns.object,
            "attributes": {attribute.name: list(names) for attribute, names in columns.attributes},
            "arguments": list(columns.arguments),
        }
        | ({"relations": {each.name: name for each, name in columns.relations}} if columns.relations else {}),
    }


def _how_to_apply(
    document: dict[str, Any], schema: Schema
) -> tuple[str, tuple[Label, ...] | None, FrameLayout | None]:
    """Return the label, its classes and the columns of a document."""
    columns = _columns(document["columns"], schema)
    return _text(document["label"]), _classes(document["classes"]), columns


def _tree(path: Path, document: object) -> Tree:
    with well_formed(f"{path} does not contain a valid tree"):
        return Tree.from_dict(document)


def _text(value: object) -> str:
    if not isinstance(value, str):
        raise ModelFormatError(f"expected a string, got {value!r:.50}")
    return value


def _texts(values: object) -> tuple[str, ...]:
    if not isinstance(values, list):
        raise ModelFormatError(f"expected a list of strings, got {values!r:.50}")
    return tuple(map(_text, values))


def _classes(value: object) -> tuple[Label, ...] | None:
    if value is None:
        return None
    if not isinstance(value, list) or not all(isinstance(entry, (bool, int, str)) for entry in value):
        raise ModelFormatError(f"expected a list of labels, got {value!r:.50}")
    # Compared as printed by the command line.
    if len(set(map(str, value))) < len(value):
        raise ModelFormatError(f"the classes must differ, got {value!r:.50}")
    return tuple(value)


def _columns(document: Any, schema: Schema) -> FrameLayout | None:  # noqa: ANN401 - not checked yet
    if document is None:
        return None
    attributes = {name: _texts(names) for name, names in document["attributes"].items()}
    components = [attribute.dim for attribute in schema.attributes]
    if list(attributes) != list(schema.names) or list(map(len, attributes.values())) != components:
        raise ModelFormatError("the columns do not match the attributes of the model")
    if len(document["arguments"]) != schema.n_parameters:
        raise ModelFormatError("the columns of arguments do not match the model")
    relations = document.get("relations", {})
    if list(relations) != [relation.name for relation in schema.relations]:
        raise ModelFormatError("the columns of relations do not match the model")
    return frame_layout(
        _text(document["scene"]),
        None if document["object"] is None else _text(document["object"]),
        {schema[name]: names for name, names in attributes.items()},
        _texts(document["arguments"]),
        tuple((each, _text(relations[each.name])) for each in schema.relations),
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
        raise ModelFormatError(f"node {index!r:.50} is not a question")
    positive, negative = (_sample(document[key], node.mapping.dim) for key in ("positive", "negative"))
    labels = np.repeat([True, False], [len(positive), len(negative)])
    return index, QuestionPoints(np.concatenate([positive, negative]), labels)


def _sample(rows: object, dim: int) -> NDArray[np.float64]:
    if not isinstance(rows, list) or len(rows) > MOST_POINTS:
        raise ModelFormatError(
            f"a question has at most {MOST_POINTS} points of either class, got {rows!r:.50}"
        )
    numbers = np.array(rows)
    if numbers.dtype.kind not in "iuf":
        raise ModelFormatError(f"points must be lists of numbers, got {rows!r:.50}")
    points = numbers.astype(np.float64).reshape(-1, dim)
    # The negated test also catches NaN.
    if not (np.abs(points) <= LARGEST_VALUE).all():
        raise ModelFormatError(f"a point must be finite and at most {LARGEST_VALUE:g}")
    return points
