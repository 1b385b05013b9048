"""A sum of trees: what forests, boosting and rule sets learn."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Final, cast, final

import numpy as np

from relforest.forests.evaluation import Facts, condition_holds, leaves
from relforest.forests.packing import CONDITION, NO, YES, Packed, pack
from relforest.forests.scene_tree import SceneTree
from relforest.scenes import Schema
from relforest.support.documents import well_formed
from relforest.support.errors import InputError, ModelFormatError
from relforest.support.files import check_document
from relforest.support.notebook import drawn
from relforest.support.options import between, in_range
from relforest.support.parallel import checked_jobs
from relforest.support.threads import in_threads
from relforest.trees import Tree, query
from relforest.trees.tree import FORMAT as TREE_FORMAT
from relforest.trees.tree import VERSION as TREE_VERSION

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from relforest.forests.conditions import Condition
    from relforest.scenes import Scenes

FORMAT: Final = "relforest-ensemble"
VERSION: Final = 2
"""The newest version; models without relations are still written as version 1, which older releases read."""
_MOST_OUTPUTS: Final = 1000


@final
@dataclass(frozen=True, slots=True, eq=False)
class Ensemble:
    """``start`` plus the weighted sum of the leaves that a scene reaches in every tree.

    Parameters
    ----------
    schema : Schema
    start : (n_outputs,) float64
    trees : tuple of SceneTree, or of Tree
        Trees of conditions, or SMRF trees.
    weights : (n_trees,) float64
        Of a SMRF tree for negated labels, the weight is negative, and `start` makes up for it.

    Raises
    ------
    ModelFormatError
        If the parts do not fit together.
    """

    schema: Schema
    start: NDArray[np.float64]
    trees: tuple[SceneTree | Tree, ...]
    weights: NDArray[np.float64]
    packed: Packed = field(init=False)
    """The trees of conditions as arrays, for kernels."""
    conditions: tuple[Condition, ...] = field(init=False)
    """The questions of all trees of conditions, one tree after the other."""

    _repr_html_ = drawn

    def __post_init__(self) -> None:
        if len(self.weights) != len(self.trees):
            raise ModelFormatError(f"{len(self.trees)} trees have {len(self.weights)} weights")
        scene_trees = tuple(tree for tree in self.trees if isinstance(tree, SceneTree))
        if len(scene_trees) not in {0, len(self.trees)}:
            raise ModelFormatError("the trees of an ensemble must be of one type")
        if any(isinstance(tree, Tree) and tree.schema != self.schema for tree in self.trees):
            raise ModelFormatError("the trees of an ensemble must have its schema")
        if any(tree.values.shape[1] != len(self.start) for tree in self.trees):
            raise ModelFormatError(
                f"every leaf needs {len(self.start)} numbers, as many as there are outputs"
            )
        asked = tuple(split.condition for tree in scene_trees for split in tree.splits)
        object.__setattr__(self, "packed", pack(self.schema, scene_trees))
        object.__setattr__(self, "conditions", asked)

    def __repr__(self) -> str:
        """Return counts, attributes and arguments on one line."""
        leaves = sum(len(tree.values) for tree in self.trees)
        return f"Ensemble({len(self.trees)} trees, {leaves} leaves; {self.schema.in_words})"

    @property
    def is_smrf(self) -> bool:
        """Whether its trees are SMRF trees."""
        return bool(self.trees) and isinstance(self.trees[0], Tree)

    @property
    def n_outputs(self) -> int:
        """How many numbers a scene gets."""
        return len(self.start)

    def leaves(self, scenes: Scenes, *, n_jobs: int = 1) -> NDArray[np.int32]:
        """Return the number of the leaf that each scene reaches in every tree, (n_scenes, n_trees).

        The call can be interrupted (Ctrl-C) at any time.

        Parameters
        ----------
        scenes : Scenes
            Of the schema of the ensemble; categories are matched by name.
        n_jobs : int
            Number of threads, -1 = one per core. It does not affect the result.

        Raises
        ------
        InputError
            If the scenes have another schema or a category never seen, or `n_jobs` is invalid.
        """
        scenes = scenes.recoded(self.schema)
        n_jobs = checked_jobs(n_jobs)
        out = np.empty((len(scenes), len(self.trees)), dtype=np.int32)
        if self.is_smrf:
            for number, tree in enumerate(self.trees):
                out[:, number] = query(cast("Tree", tree), scenes, n_jobs=n_jobs).leaf
            return out
        columns = (scenes.rows, scenes.starts, scenes.counts, scenes.arguments)
        facts = Facts(scenes.matrix, scenes.pairs, scenes.rows)

        def evaluate(begin: int, end: int, stop: NDArray[np.bool_]) -> None:
            leaves(self.packed, facts, columns, begin, end, out, stop)

        in_threads(evaluate, len(scenes), n_jobs)
        return out

    def scores(self, scenes: Scenes, *, n_jobs: int = 1) -> NDArray[np.float64]:
        """Return the sum for each scene, (n_scenes, n_outputs); see `leaves` for the parameters."""
        total = np.tile(self.start, (len(scenes), 1))
        for tree, weight, leaf in zip(
            self.trees, self.weights, self.leaves(scenes, n_jobs=n_jobs).T, strict=True
        ):
            total += weight * tree.values[leaf]
        return total

    def path(self, tree: int, scene: Scenes) -> list[tuple[Condition, bool, NDArray[np.int64]]]:
        """Return the questions that a single scene meets in one tree of conditions.

        Returns
        -------
        list of (Condition, bool, int64 ndarray)
            The condition, whether it holds, and the object rows of the choice that decided: the arguments,
            then the free variables; meaningful if it holds.
        """
        scene = scene.recoded(self.schema)
        packed, met = self.packed, []
        node = packed.roots[tree]
        point, stop = np.empty((1, max(self.schema.width, 2))), np.zeros(1, dtype=np.bool_)
        while packed.nodes[node, CONDITION] >= 0:
            number = packed.nodes[node, CONDITION]
            bound = np.empty(self.schema.n_parameters + 2, dtype=np.int64)
            place = (Facts(scene.matrix, scene.pairs, scene.objects(0)), scene.arguments[0], bound, point)
            is_true = condition_holds(packed, number, *place, stop)
            condition = self.conditions[number]
            met.append((condition, is_true, bound[: self.schema.n_parameters + condition.n_free]))
            node = packed.nodes[node, YES if is_true else NO]
        return met

    def to_dict(self) -> dict[str, Any]:
        """Return the JSON form, with format name and version."""
        return {
            "format": FORMAT,
            "version": VERSION if self.schema.relations else 1,
            "schema": self.schema.to_dict(),
            "start": self.start.tolist(),
            "weights": self.weights.tolist(),
            "trees": [
                tree.to_dict() if isinstance(tree, SceneTree) else {"nodes": tree.to_dict()["nodes"]}
                for tree in self.trees
            ],
        }

    @classmethod
    def from_dict(cls, document: object) -> Ensemble:
        """Read what `to_dict` returned.

        Raises
        ------
        ModelFormatError
            If the document is malformed, too large, or of a version that this library cannot read.
        """
        checked = check_document(document, format=FORMAT, version=VERSION, origin="ensemble")
        with well_formed("malformed ensemble"):
            schema = Schema.from_dict(checked["schema"])
            start, weights = (
                np.array([in_range(key, each, -1e100, 1e100) for each in checked[key]])
                for key in ("start", "weights")
            )
            between("the number of outputs", len(start), 1, _MOST_OUTPUTS)
            if not isinstance(checked["trees"], list):
                raise InputError("trees must be a list")
            given = checked["trees"]
            if given and isinstance(given[0], dict):
                frame = {"format": TREE_FORMAT, "version": TREE_VERSION, "schema": checked["schema"]}
                smrf = tuple(Tree.from_dict(frame | {"nodes": each["nodes"]}) for each in given)
                return cls(schema, start, smrf, weights)
            trees = tuple(SceneTree.from_dict(each, schema, len(start)) for each in given)
            return cls(schema, start, trees, weights)
