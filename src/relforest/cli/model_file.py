"""Model files: what was learned and everything needed to apply it to a table.

A model file is a JSON document of format ``relforest-model``: the label and its two classes, the columns that
the scenes were read from, and either the tree as written by `Tree.to_dict` with a sample of the training
points of each question, for pictures, or an ensemble as written by `Ensemble.to_dict` and its kind.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final, Literal, cast, final

import numpy as np
from numpy.typing import NDArray
from scipy.special import expit

from relforest.cli.columns import Columns
from relforest.forests import Ensemble
from relforest.forests.descriptions import ensemble_in_words, rule_set_in_words
from relforest.reports import QuestionPoints
from relforest.scenes import Scenes, Schema
from relforest.support.documents import well_formed
from relforest.support.errors import InputError, ModelFormatError
from relforest.support.files import read_json, write_json
from relforest.support.options import between, one_of
from relforest.trees import Question, Tree, query
from relforest.trees.nodes import variable_name
from relforest.trees.text import describe
from relforest.trees.tree import FORMAT as TREE_FORMAT
from relforest.trees.tree import VERSION as TREE_VERSION
from relforest.volumes.ellipsoid import LARGEST_VALUE

FORMAT: Final = "relforest-model"
VERSION: Final = 1
MOST_POINTS: Final = 150
"""Largest number of points per class stored for a question."""

Label = bool | int | str
Kind = Literal["tree", "forest", "boosting", "rules"]
_ENSEMBLES: Final = ("forest", "boosting", "rules")


@final
@dataclass(frozen=True, slots=True, eq=False)
class Predictions:
    """What a model says about scenes.

    Parameters
    ----------
    probability : ndarray (n_scenes,)
        Of the positive class.
    leaf : int64 ndarray (n_scenes,) or None
        The leaf that decided, for a tree.
    witnesses : dict of str to int64 ndarray (n_scenes,)
        Object rows by variable, -1 = no object; empty for an ensemble.
    """

    probability: NDArray[np.float64]
    leaf: NDArray[np.int64] | None
    witnesses: dict[str, NDArray[np.int64]]


@final
@dataclass(frozen=True, slots=True, eq=False)
class Model:
    """A tree or an ensemble and how to apply it.

    Parameters
    ----------
    learned : Tree or Ensemble
    kind : {"tree", "forest", "boosting", "rules"}
    label : str
        The column of labels that it predicts; empty if unknown.
    classes : tuple of two labels
        The second one is the positive class.
    columns : Columns or None
        Where to find scenes in a table; None if unknown.
    points : mapping of int to QuestionPoints
        Training points of questions, by node index.
    """

    learned: Tree | Ensemble
    kind: Kind
    label: str
    classes: tuple[Label, Label]
    columns: Columns | None
    points: Mapping[int, QuestionPoints] = field(default_factory=dict)

    @property
    def schema(self) -> Schema:
        """The schema of the scenes that it is for."""
        return self.learned.schema

    @property
    def tree(self) -> Tree:
        """The tree.

        Raises
        ------
        InputError
            If the model is an ensemble.
        """
        if isinstance(self.learned, Tree):
            return self.learned
        msg = f"the model is of kind {self.kind!r}, but drawings and paths are those of a single tree"
        raise InputError(msg)

    @property
    def text(self) -> str:
        """The model in words."""
        if isinstance(self.learned, Ensemble):
            what = rule_set_in_words if self.kind == "rules" else ensemble_in_words
            return what(self.learned, self.positive)
        other = str(self.classes[0]) if self.label else "LABEL"
        return describe(self.learned.schema, self.learned.nodes, other=other)

    def predictions(self, scenes: Scenes, *, n_jobs: int) -> Predictions:
        """Apply the model to scenes of its schema, in `n_jobs` threads."""
        if isinstance(self.learned, Ensemble):
            scores = self.learned.scores(scenes, n_jobs=n_jobs)[:, 0]
            probability = np.clip(scores, 0.0, 1.0) if self.kind == "forest" else expit(scores)
            return Predictions(probability, None, {})
        answers = query(self.learned, scenes, n_jobs=n_jobs)
        witnesses = {variable_name(variable): rows for variable, rows in enumerate(answers.witnesses.T)}
        return Predictions(self.learned.leaf_predictions[answers.leaf], answers.leaf, witnesses)

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
    document = {
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
    }
    if isinstance(model.learned, Ensemble):
        write_json(path, document | {"kind": model.kind, "ensemble": model.learned.to_dict()})
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
    try:
        document = read_json(path, format=FORMAT, version=VERSION)
    except ModelFormatError as error:
        try:
            bare = read_json(path, format=TREE_FORMAT, version=TREE_VERSION)
        except ModelFormatError:
            raise error from None
        return Model(_tree(path, bare), "tree", "", (False, True), None)
    remedy = "restore it, or learn the model again with relforest fit"
    if "ensemble" in document:
        with well_formed(f"{path} is damaged", remedy):
            ensemble = Ensemble.from_dict(document["ensemble"])
            between("the number of outputs", ensemble.n_outputs, 1, 1)
            kind = cast("Kind", one_of("kind", document["kind"], _ENSEMBLES))
            if ensemble.is_smrf and kind != "forest":
                raise InputError(f"a model of kind {kind!r} consists of trees of conditions")
            return Model(ensemble, kind, *_how_to_apply(document, ensemble.schema))
    tree = _tree(path, document.get("tree"))
    with well_formed(f"{path} is damaged", remedy):
        points = dict(_points(entry, tree) for entry in document["points"])
        return Model(tree, "tree", *_how_to_apply(document, tree.schema), points)


def _how_to_apply(
    document: dict[str, Any], schema: Schema
) -> tuple[str, tuple[Label, Label], Columns | None]:
    """Return the label, its classes and the columns of a document."""
    columns = _columns(document["columns"], schema)
    return _text(document["label"]), _classes(document["classes"]), columns


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


def _columns(document: Any, schema: Schema) -> Columns | None:  # noqa: ANN401 - not checked yet
    if document is None:
        return None
    attributes = {name: _texts(names) for name, names in document["attributes"].items()}
    components = [attribute.dim for attribute in schema.attributes]
    if list(attributes) != list(schema.names) or list(map(len, attributes.values())) != components:
        raise ValueError("the columns do not match the attributes of the model")
    if len(document["arguments"]) != schema.n_parameters:
        raise ValueError("the columns of arguments do not match the model")
    return Columns(
        _text(document["scene"]),
        None if document["object"] is None else _text(document["object"]),
        tuple((schema[name], names) for name, names in attributes.items()),
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
