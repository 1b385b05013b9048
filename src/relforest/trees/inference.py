"""Evaluating a tree on scenes: deciding leaf, densities, witnesses."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from threading import Event
from typing import TYPE_CHECKING, final

import numpy as np

from relforest.support.parallel import checked_jobs
from relforest.trees.boxes import FEWEST, make_boxes
from relforest.trees.kernels import query_batch, query_work

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from relforest.scenes import Scenes
    from relforest.trees.tree import Tree


@final
@dataclass(frozen=True, slots=True, eq=False)
class Answers:
    """The answers of a tree for n scenes.

    Parameters
    ----------
    leaf : (n,) int64
        Ordinal of the deciding leaf: the most probable leaf that any instantiation sequence reaches.
    densities : (n, tree.depth) float64
        Density, relative to its peak, at each question above that leaf, root first, for the most
        representative sequence; 0 where the answer was Error and beyond the branch.
    witnesses : (n, tree.n_variables) int64
        Object rows of that sequence, -1 = no object.

    References
    ----------
    Palmer (2015), section 4.1 for the leaf, section 6.4 for the representative sequence.
    """

    leaf: NDArray[np.int64]
    densities: NDArray[np.float64]
    witnesses: NDArray[np.int64]


def query(tree: Tree, scenes: Scenes, *, n_jobs: int = 1) -> Answers:
    """Evaluate a tree on every scene of a batch.

    Time grows exponentially with the number of variables. The call can be interrupted (Ctrl-C) at any time.

    Parameters
    ----------
    tree : Tree
    scenes : Scenes
        n scenes of the tree's schema; categories are matched by name.
    n_jobs : int
        Number of threads, -1 = one per core; the kernel releases the GIL. It does not affect the answers.

    Raises
    ------
    InputError
        If the scenes have a different schema or a category never seen, or `n_jobs` is invalid.
    """
    scenes = scenes.recoded(tree.schema)
    n = len(scenes)
    packed = tree.packed
    out = (
        np.empty(n, dtype=np.int64),
        np.empty((n, packed.n_asked)),
        np.empty((n, packed.n_variables), dtype=np.int64),
    )

    # No scene has more objects than there are rows, and this is cheaper to see.
    largest = int(scenes.counts.max(initial=0)) if packed.boxed[0] > 0 and len(scenes.rows) > FEWEST else 0
    interrupted = Event()

    def answer(begin: int, end: int) -> None:
        part = slice(begin, end)
        boxes = make_boxes(packed, largest, FEWEST) if largest > FEWEST else None
        work = query_work(packed.n_variables, packed.n_asked, packed.n_dims)
        columns = (scenes.rows, scenes.starts[part], scenes.counts[part], scenes.arguments[part])
        results = (out[0][part], out[1][part], out[2][part])
        done = 0
        while done < end - begin and not interrupted.is_set():
            done = query_batch(
                packed.nodes, packed.numbers, scenes.matrix, columns, done, work, results, boxes
            )

    n_jobs = checked_jobs(n_jobs)
    bounds = np.linspace(0, n, n_jobs + 1).astype(int)
    if n_jobs == 1:
        answer(0, n)
    else:
        with ThreadPoolExecutor(n_jobs) as pool:
            try:
                list(pool.map(answer, bounds[:-1], bounds[1:]))
            finally:
                # Leaving the ``with`` block waits for all threads.
                interrupted.set()
    return Answers(*out)
