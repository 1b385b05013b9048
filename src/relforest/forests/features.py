"""An ensemble as a map from scenes to numbers: what its trees say, or what their questions measure.

Letters: n scenes, k columns.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, Literal, cast

import numpy as np

from relforest.forests.evaluation import Facts
from relforest.forests.measures import measures, work_space
from relforest.forests.question_measures import question_measures
from relforest.forests.questions import leaf_in_words, question_in_words, questions
from relforest.forests.tree_features import tree_features
from relforest.support.errors import InputError
from relforest.support.options import one_of
from relforest.support.parallel import checked_jobs
from relforest.support.threads import in_threads
from relforest.trees import Tree, query

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from relforest.forests.ensemble import Ensemble
    from relforest.scenes import Scenes
    from relforest.scenes.arrays import FloatArray

Mode = Literal["probability", "bits", "densities+bits", "distances", "counts"]
MODES: Final = ("probability", "bits", "densities+bits", "distances", "counts")


def features(ensemble: Ensemble, scenes: Scenes, mode: Mode, *, n_jobs: int = 1) -> FloatArray:
    """Return the features of n scenes, (n, k), tree by tree; `feature_names` says what they are.

    Parameters
    ----------
    ensemble : Ensemble
    scenes : Scenes
        n scenes of its schema; categories are matched by name.
    mode : str
        - ``"probability"``: what each tree says, a column for each output: for SMRF trees the probability (or
          mean) of the leaf that decides, for trees of conditions what they add to the start.
        - ``"bits"``: for each leaf, 1 if the scene ends there, else 0.
        - ``"densities+bits"``: for each leaf of a SMRF tree its bit, then how typical the deciding objects
          are for each question above it, root first.
        - ``"distances"``: for each question, how far the scene is from Yes: at most 0 if the answer is Yes;
          NaN if no objects can be asked about.
        - ``"counts"``: for each question, how many choices of objects satisfy it.
    n_jobs : int
        Number of threads, -1 = one per core. It does not affect the result.

    Raises
    ------
    InputError
        If the mode is unknown or not one for these trees, or the scenes have another schema.

    Notes
    -----
    A choice of objects is as far from a condition as from its farthest statement, in the units of that
    statement's mapping; beyond an ellipse, in units of the root of the product of its half-axes. A choice
    with a wrong category is no choice; conditions on categories alone have distances -1 and 1. Where k
    objects are required, the k-th nearest counts. Both orders of a pair are counted. In SMRF trees, the
    distance is that from the mean of the volume (Mahalanobis, eq. 3.2; radians on the circle) less its
    radius, and the instantiation sequences are counted that reach the question and are answered Yes.
    """
    one_of("mode", mode, MODES)
    scenes, n_jobs = scenes.recoded(ensemble.schema), checked_jobs(n_jobs)
    if mode == "densities+bits":
        _refuse_conditions(ensemble)
    if mode in {"distances", "counts"}:
        return _measures(ensemble, scenes, n_jobs)[mode == "counts"]
    columns = [np.empty((len(scenes), 0))]
    if mode == "densities+bits":
        for tree in ensemble.trees:
            smrf = cast("Tree", tree)
            columns.append(tree_features(smrf, query(smrf, scenes, n_jobs=n_jobs), mode))
        return np.hstack(columns)
    for tree, leaf in zip(ensemble.trees, ensemble.leaves(scenes, n_jobs=n_jobs).T, strict=True):
        columns.append(tree.values[leaf] if mode == "probability" else np.eye(len(tree.leaves))[leaf])
    return np.hstack(columns)


def feature_names(ensemble: Ensemble, mode: Mode) -> list[str]:
    """Return what each column of `features` is, in words (k,).

    Raises
    ------
    InputError
        If the mode is unknown or not one for these trees.
    """
    one_of("mode", mode, MODES)
    if mode == "densities+bits":
        _refuse_conditions(ensemble)
    names: list[str] = []
    for number, tree in enumerate(ensemble.trees, start=1):
        if mode in {"distances", "counts"}:
            what = "distance" if mode == "distances" else "count"
            names += [
                f"tree {number}, question {place}, {what}: "
                + question_in_words(tree, asked.node, ensemble.schema)
                for place, asked in enumerate(questions(tree), start=1)
            ]
        elif mode == "probability":
            several = ensemble.n_outputs > 1
            names += [
                f"tree {number}, output {output}" if several else f"tree {number}"
                for output in range(1, ensemble.n_outputs + 1)
            ]
        else:
            names += _names_of_leaves(ensemble, number, mode)
    return names


def _names_of_leaves(ensemble: Ensemble, number: int, mode: Mode) -> Iterator[str]:
    tree = ensemble.trees[number - 1]
    for leaf in range(len(tree.leaves)):
        prefix = f"tree {number}, leaf {leaf + 1}"
        yield f"{prefix}: {leaf_in_words(tree, leaf, ensemble.schema)}"
        if mode == "densities+bits" and isinstance(tree, Tree):
            for node in tree.questions_above[leaf]:
                yield f"{prefix}, density: {question_in_words(tree, node, ensemble.schema)}"


def _measures(ensemble: Ensemble, scenes: Scenes, n_jobs: int) -> tuple[FloatArray, FloatArray]:
    if ensemble.is_smrf:
        empty = np.empty((len(scenes), 0))
        found = [question_measures(cast("Tree", tree), scenes, n_jobs=n_jobs) for tree in ensemble.trees]
        margins, counts = zip((empty, empty), *found, strict=True)
        return np.hstack(margins), np.hstack(counts)
    out = np.empty((2, len(scenes), len(ensemble.conditions)))
    columns = (scenes.rows, scenes.starts, scenes.counts, scenes.arguments)
    facts = Facts(scenes.matrix, scenes.pairs, scenes.rows)

    def evaluate(begin: int, end: int, stop: NDArray[np.bool_]) -> None:
        work = work_space(ensemble.packed, scenes.schema.n_parameters, scenes.schema.width)
        measures(ensemble.packed, facts, columns, begin, end, work, out, stop)

    in_threads(evaluate, len(scenes), n_jobs)
    return out[0], out[1]


def _refuse_conditions(ensemble: Ensemble) -> None:
    if not ensemble.is_smrf:
        raise InputError("mode 'densities+bits' is for SMRF trees; for trees of conditions use 'distances'")
