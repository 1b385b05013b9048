"""What was learned, and how to apply it to the scenes of a table."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from os import PathLike
from pathlib import Path
from typing import Any, Final, Literal, final

import numpy as np
from numpy.typing import NDArray

from relforest.forests import Ensemble
from relforest.forests.descriptions import ensemble_in_words, rule_set_in_words
from relforest.forests.shares import logistic_shares, mean_shares
from relforest.reports import QuestionPoints
from relforest.scenes import Scenes, Schema
from relforest.scenes.dialect import ANY_DIALECT, Dialect
from relforest.scenes.frames import FrameLayout
from relforest.scenes.mean_object import without_mean
from relforest.scenes.parquet_source import ParquetSource
from relforest.scenes.scene_stream import SceneStream
from relforest.scenes.scene_table import check_schema, open_scenes, read_scenes
from relforest.support.errors import InputError
from relforest.support.notebook import drawn
from relforest.support.options import in_range
from relforest.trees import ClassLeaf, MeanLeaf, Tree, query
from relforest.trees.nodes import variable_name
from relforest.trees.text import describe

Label = bool | int | str
Family = Literal["tree", "forest", "boosting", "rules", "outcome"]

_OF_SMRF_TREES: Final = ("forest", "outcome")
_REMEDY: Final = "the model does not name the columns of its scenes, so use a file that was"


@final
@dataclass(frozen=True, slots=True, eq=False)
class Predictions:
    """What a model says about scenes.

    Parameters
    ----------
    predicted : (n_scenes,) array
        The most probable class (of two the positive one from the threshold on), or float64 numbers.
    probability : (n_scenes, n_classes) float64 or None
        Of each class; None for numbers.
    leaf : (n_scenes,) int64 or None
        The leaf that decided, for a tree.
    witnesses : dict of str to (n_scenes,) int64
        Object rows by variable, -1 = no object; empty for an ensemble.
    """

    predicted: NDArray[Any]
    probability: NDArray[np.float64] | None
    leaf: NDArray[np.int64] | None
    witnesses: dict[str, NDArray[np.int64]]


@final
@dataclass(frozen=True, slots=True, eq=False)
class Model:
    """A tree or an ensemble and how to apply it.

    Parameters
    ----------
    learned : Tree or Ensemble
    family : {"tree", "forest", "boosting", "rules", "outcome"}
    label : str
        The column that it predicts; empty if unknown.
    classes : tuple of labels, or None
        At least two; of two, the second one is the positive class. None if it predicts numbers.
    columns : FrameLayout or None
        Where to find scenes in a table; None if unknown.
    points : mapping of int to QuestionPoints
        Training points of questions, by node index.
    threshold : float
        The probability of the second of two classes from which on it is predicted.

    Raises
    ------
    InputError
        If the parts do not go together.

    Examples
    --------
    >>> import relforest as rf
    >>> model = rf.load("tree.json")  # doctest: +SKIP
    >>> model.predictions(model.read_scenes("passes.csv")).predicted  # doctest: +SKIP
    """

    learned: Tree | Ensemble
    family: Family
    label: str
    classes: tuple[Label, ...] | None
    columns: FrameLayout | None
    points: Mapping[int, QuestionPoints] = field(default_factory=dict)
    threshold: float = 0.5

    def __str__(self) -> str:
        """Return `text`."""
        return self.text

    def __repr__(self) -> str:
        """Return what predicts what on one line."""
        return f"Model({self.learned!r} for {self.outcome})"

    def _repr_html_(self) -> str:
        """Return what was learned as notebooks show it."""
        return drawn(self.learned)

    def __post_init__(self) -> None:
        if (self.family == "tree") != isinstance(self.learned, Tree):
            raise InputError(f"a {type(self.learned).__name__} is no model of the family {self.family!r}")
        if isinstance(self.learned, Ensemble) and self.learned.is_smrf and self.family not in _OF_SMRF_TREES:
            raise InputError(f"a model of the family {self.family!r} consists of trees of conditions")
        wanted = None if self.classes is None else len(self.classes)
        if wanted is not None and wanted < 2:
            raise InputError(f"a model needs two classes, got {self.classes!r}")
        if self.family in {"rules", "outcome"} and wanted != 2:
            raise InputError(f"a model of the family {self.family!r} is for two classes")
        in_range("threshold", self.threshold, 0.0, 1.0)
        if isinstance(self.learned, Tree):
            fits = n_classes(self.learned) == wanted
        else:
            fits = self.learned.n_outputs == (wanted if wanted and wanted > 2 else 1)
        if not fits:
            what = "numbers" if wanted is None else f"{wanted} classes"
            raise InputError(f"what was learned does not predict {what}")

    @property
    def schema(self) -> Schema:
        """The schema of the scenes that it is for, which get a mean object when they are used."""
        return without_mean(self.learned.schema)

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
        raise InputError(
            f"the model is of the family {self.family!r}, but drawings and paths are those of a single tree"
        )

    @property
    def text(self) -> str:
        """The model in words."""
        several = self.classes is not None and len(self.classes) > 2
        if isinstance(self.learned, Ensemble):
            of = f"{self.label or 'class'} = {self.classes[-1]}" if self.classes and several else self.outcome
            what = rule_set_in_words if self.family == "rules" else ensemble_in_words
            return what(self.learned, of)
        other = str(self.classes[0]) if self.classes and self.label else "LABEL"
        text = describe(self.learned.schema, self.learned.nodes, other=other)
        return f"{text}\nshares are those of {self.outcome}" if several else text

    @property
    def outcome(self) -> str:
        """What the numbers are of, such as ``completed = True``, ``speed`` or ``winner = red, blue``."""
        if self.classes is None:
            return self.label or "the target"
        if len(self.classes) == 2:
            return f"{self.label} = {self.classes[1]}" if self.label else "the positive class"
        return f"{self.label or 'the classes'} = {', '.join(map(str, self.classes))}"

    def read_scenes(self, path: str | PathLike[str], *, dialect: Dialect = ANY_DIALECT) -> Scenes:
        """Read scenes to apply the model to from a table, by the columns that it was learned from.

        Raises
        ------
        InputError
            If the file cannot be read or lacks the columns, or its scenes are of another schema.
        ModelFormatError
            If `Scenes.to_parquet` wrote the file and it was changed since.
        """
        scenes = read_scenes(Path(path), self.columns, remedy=_REMEDY, dialect=dialect).scenes
        check_schema(Path(path), scenes, self.schema)
        return scenes

    def open_scenes(self, source: ParquetSource) -> SceneStream:
        """Open Parquet files of any size, to be read in batches; see `read_scenes`."""
        stream = open_scenes(source, self.columns, remedy=_REMEDY)
        check_schema(Path(source.origin), stream, self.schema)
        return stream

    def predictions(self, scenes: Scenes, *, n_jobs: int = 1) -> Predictions:
        """Apply the model to scenes of its schema, in `n_jobs` threads (-1 = one per core)."""
        leaf: NDArray[np.int64] | None = None
        witnesses: dict[str, NDArray[np.int64]] = {}
        if isinstance(self.learned, Tree):
            answers = query(self.learned, scenes, n_jobs=n_jobs)
            leaf = answers.leaf
            witnesses = {variable_name(number): rows for number, rows in enumerate(answers.witnesses.T)}
            values = self.learned.values[leaf]
        else:
            values = self.learned.scores(scenes, n_jobs=n_jobs)
        if self.classes is None:
            return Predictions(values[:, 0], None, leaf, witnesses)
        probability = self._shares(values)
        chosen = probability.argmax(axis=1)
        if len(self.classes) == 2:
            chosen = (probability[:, 1] >= self.threshold).astype(np.int64)
        return Predictions(np.array(self.classes, dtype=object)[chosen], probability, leaf, witnesses)

    def _shares(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the probabilities of classes (n, n_classes) for what the trees say (n, n_outputs)."""
        if self.family in {"boosting", "rules", "outcome"}:
            return logistic_shares(values)
        # The leaves of a single tree hold shares already.
        return values if self.family == "tree" and values.shape[1] > 1 else mean_shares(values)


def n_classes(tree: Tree) -> int | None:
    """Return for how many classes a tree is, None for numbers."""
    leaf = tree.nodes[tree.leaves[0]]
    if isinstance(leaf, MeanLeaf):
        return None
    return len(leaf.shares) if isinstance(leaf, ClassLeaf) else 2
