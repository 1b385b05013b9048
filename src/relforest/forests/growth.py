"""Growing a tree of conditions by Newton steps, the most useful question first."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, final

import numpy as np

from relforest.forests.forms import N_NUMBERS
from relforest.forests.kernels import Plan, Targets, best_condition, work_space
from relforest.forests.scene_tree import Node, SceneTree, Split, Value
from relforest.forests.tables import ConditionTable, Found

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from relforest.forests.settings import GrowthSettings


@final
@dataclass(frozen=True, slots=True, eq=False)
class _Open:
    """A leaf that may still be divided."""

    node: int
    scenes: NDArray[np.int64]
    question: Found | None


@final
@dataclass(frozen=True, slots=True, eq=False)
class GrownTree:
    """A tree, and how its questions answer in the tables it was grown from."""

    tree: SceneTree
    questions: tuple[Found, ...]  # one per split, in the order of the nodes

    def leaves(self, scenes: NDArray[np.int64]) -> NDArray[np.int64]:
        """Return the number of the leaf of each training scene (n,)."""
        ordinal = {node: number for number, node in enumerate(self.tree.leaves)}
        out = np.empty(len(scenes), dtype=np.int64)
        asked = iter(self.questions)
        arrived = {0: np.arange(len(scenes))}
        for index, node in enumerate(self.tree.nodes):
            here = arrived.pop(index)
            if isinstance(node, Value):
                out[here] = ordinal[index]
                continue
            is_true = next(asked).holds(scenes[here])
            arrived[node.yes], arrived[node.no] = here[is_true], here[~is_true]
        return out


def grow_tree(
    tables: tuple[ConditionTable, ...],
    scenes: NDArray[np.int64],
    targets: Targets,
    settings: GrowthSettings,
    rng: np.random.Generator,
) -> GrownTree:
    """Grow a tree whose leaves say which Newton step lowers the loss most.

    It is learned from some scenes (n,); the targets are derivatives of the loss for all scenes of the tables.

    Notes
    -----
    The gain of a question is ``(G_y^2 / (H_y + l) + G_n^2 / (H_n + l) - G^2 / (H + l)) / 2``, with the sums
    of first and second derivatives on both sides, and a leaf says ``-G / (H + l)`` (Chen and Guestrin, 2016,
    XGBoost, eq. 5 and 7).
    """
    plan = Plan(*(getattr(settings, name) for name in Plan._fields))

    def opened(node: int, here: NDArray[np.int64]) -> _Open:
        enough = len(here) >= 2 * settings.min_scenes
        return _Open(node, here, _best_question(tables, here, targets, plan, rng) if enough else None)

    nodes: list[Node | None] = [None]
    asked: dict[int, Found] = {}
    frontier = [opened(0, scenes)]
    n_leaves = 1
    while n_leaves < settings.max_leaves:
        chosen = max(frontier, key=lambda leaf: leaf.question.gain if leaf.question else 0.0)
        question = chosen.question
        if question is None:
            break
        is_true = question.holds(chosen.scenes)
        nodes[chosen.node] = Split(question.condition, len(nodes), len(nodes) + 1, 0.5 * question.gain)
        asked[chosen.node] = question
        frontier.remove(chosen)
        n_leaves += 1
        for side in (chosen.scenes[is_true], chosen.scenes[~is_true]):
            last = n_leaves == settings.max_leaves
            frontier.append(_Open(len(nodes), side, None) if last else opened(len(nodes), side))
            nodes.append(None)
    for leaf in frontier:
        gradient = targets.gradients[leaf.scenes].sum(axis=0)
        curvature = targets.curvatures[leaf.scenes].sum(axis=0)
        step = -gradient / (curvature + settings.penalty)
        nodes[leaf.node] = Value(tuple(step.tolist()), len(leaf.scenes))
    tree = SceneTree(tuple(node for node in nodes if node is not None))
    return GrownTree(tree, tuple(asked[index] for index in sorted(asked)))


def _best_question(
    tables: tuple[ConditionTable, ...],
    scenes: NDArray[np.int64],
    targets: Targets,
    plan: Plan,
    rng: np.random.Generator,
) -> Found | None:
    best, most = None, 0.0
    for each in tables:
        table = each.table
        work = work_space(table, scenes, targets.gradients.shape[1])
        # Pairs have many more questions, the best of which gains more by chance.
        factor = plan.pair_gain if each.n_free > 1 else 1.0
        # Of a sample of the pairs, the objects without a partner are not known.
        tried = plan._replace(every=plan.every and each.n_free == 2 and each.n_sampled == 0)
        categories = [-1]
        if each.n_free and table.firsts[1]:
            categories.append(int(rng.integers(table.firsts[1])))
        if each.related:
            categories.append(each.related[int(rng.integers(len(each.related)))])
        for category in categories:
            statements = np.zeros((plan.max_statements, N_NUMBERS))
            gain, n, at_least = best_condition(table, scenes, targets, tried, rng, statements, work, category)
            if factor * gain > most:
                best, most = Found(each, statements[:n].copy(), at_least, gain), factor * gain
    return best
