"""Growing a SMRF tree (Algorithm 4.1)."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final, final

import numpy as np

from relforest.mappings import catalogue
from relforest.support.errors import InputError
from relforest.support.progress import part
from relforest.trees.bounds import needed_bounds
from relforest.trees.candidates import Arrivals, Candidate, OpenLeaf
from relforest.trees.criterion import Target
from relforest.trees.nodes import Leaf, Question
from relforest.trees.permutation import permutation_p
from relforest.trees.probabilities import Assignment
from relforest.trees.search import SEARCHES, LeafSearch
from relforest.trees.sequences import Sequences, argument_places
from relforest.trees.settings import TreeSettings
from relforest.trees.significance import sidak
from relforest.trees.tree import Tree

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from relforest.scenes import Scenes


_DEFAULT: Final = TreeSettings()


@final
@dataclass(frozen=True, slots=True)
class Step:
    """One accepted expansion."""

    leaf: int  # ordinal of the leaf that was expanded
    question: str  # mapping function asked
    p_value: float  # of the test in use
    gain: float  # increase of the log likelihood
    n_tried: int  # volumes that competed


@final
@dataclass(frozen=True, slots=True, eq=False)
class Growth:
    """A grown tree and how it was grown.

    Parameters
    ----------
    tree : Tree
    steps : tuple of Step
        Accepted expansions, in order.
    n_left_out : int
        Expansions that were not tried because of `TreeSettings.max_points`.
    n_sampled : int
        Expansions that were searched by a sample of their instantiation sequences for the same reason. The
        scenes at a leaf always follow from all sequences.
    """

    tree: Tree
    steps: tuple[Step, ...]
    n_left_out: int
    n_sampled: int


def grow_best(
    scenes: Scenes, targets: Sequence[Target], *, rng: np.random.Generator, settings: TreeSettings = _DEFAULT
) -> Growth:
    """Learn a tree for each of several targets that state the same facts; return the one that explains most.

    Targets are, for example, a number of which the highest leaf decides, and the same number with the lowest
    one. Each tree has its share of the level `alpha`.

    Raises
    ------
    InputError
        See `grow`.
    """
    settings = replace(settings, alpha=sidak(settings.alpha, len(targets)))
    grown = [grow(scenes, target, rng=rng, settings=settings) for target in targets]
    return max(grown, key=lambda each: sum(step.gain for step in each.steps))


def grow(
    scenes: Scenes,
    target: Target | NDArray[np.bool_],
    *,
    rng: np.random.Generator,
    settings: TreeSettings = _DEFAULT,
) -> Growth:
    """Learn a tree that predicts what is known about scenes.

    Parameters
    ----------
    scenes : Scenes
    target : Target or (n_scenes,) bool
        What to predict; labels are True for scenes that contain an instance of the target concept.
    rng : Generator
        Source of all sampling.
    settings : TreeSettings

    Returns
    -------
    Growth
        Its tree is a stub if no question passes the test, in particular if all labels are equal.

    Raises
    ------
    InputError
        If the scenes are empty or have relations, or the number of labels differs.

    Notes
    -----
    The source stops as soon as the most promising leaf cannot be expanded. Here that leaf is closed and
    the next one is tried, so a barren leaf does not prevent the others from being refined.

    References
    ----------
    Palmer (2015), Algorithm 4.1, section 4.2; section 6.2 for action arguments.
    """
    shape = (len(target),) if isinstance(target, Target) else target.shape
    if len(scenes) == 0 or shape != (len(scenes),):
        raise InputError(f"pass at least one scene and one label for each: got {len(scenes)} and {shape}")
    if scenes.schema.relations:
        raise InputError(
            f"SMRF trees do not ask about relations, such as {scenes.schema.relations[0].name!r}: learn "
            "boosting, rule sets or forests of conditions, or read the scenes without relations"
        )
    if not isinstance(target, Target):
        target = Target.binary(target)
    state = _State(
        Tree.stub(scenes.schema, Leaf(0.0, 0, 0)),
        (Sequences.empty(len(scenes)),),
        np.ones((1, len(scenes)), dtype=np.bool_),
        (True,),
    )
    places, mappings = argument_places(scenes), catalogue(scenes.schema)
    steps: list[Step] = []
    n_left_out = n_sampled = 0
    while True:
        assignment = target.assign(state.presence)
        leaf = _most_promising(state, target, assignment)
        if leaf is None:
            break
        with part(f"question {len(steps) + 1}"):
            arrivals = Arrivals(scenes, places, mappings, state.sequences[leaf])
            search = SEARCHES[settings.search].at(arrivals, settings, rng)
            n_left_out += search.n_left_out
            n_sampled += search.n_sampled
            at = OpenLeaf(state.tree, leaf, state.presence, assignment)
            found = search.best(target, at, rng)
            p_value = None if found is None else _tested(found, search, target, at, settings, rng)
        if found is None or p_value is None:
            state = state.closed(leaf)
            continue
        asked = found.question.expansion.mapping.name
        steps.append(Step(leaf, asked, p_value, found.gain, found.n_tried))
        state = state.expanded(leaf, found)
    return Growth(state.tree.with_leaves(target.leaves(assignment)), tuple(steps), n_left_out, n_sampled)


@final
@dataclass(frozen=True, slots=True, eq=False)
class _State:
    """An unfinished tree: what arrived at each leaf, and which leaves may still be expanded."""

    tree: Tree
    sequences: tuple[Sequences, ...]
    presence: NDArray[np.bool_]  # (n_leaves, n_scenes)
    is_open: tuple[bool, ...]

    def closed(self, leaf: int) -> _State:
        """Return the same tree, without trying the leaf again."""
        return replace(self, is_open=(*self.is_open[:leaf], False, *self.is_open[leaf + 1 :]))

    def expanded(self, leaf: int, found: Candidate) -> _State:
        """Return the tree with a leaf replaced by the candidate's question."""
        expansion = found.question.expansion
        mapping, points = expansion.mapping, found.question.bags.points
        bounds = () if mapping.space == "category" else needed_bounds(found.volume, points)
        node = Question(mapping, expansion.variables, found.volume, 0, 0, 0, bounds)
        parts = found.question.partition(found.volume)
        return _State(
            self.tree.expanded(leaf, expansion.n_new, node),
            (*self.sequences[:leaf], *parts, *self.sequences[leaf + 1 :]),
            np.vstack([self.presence[:leaf], found.presence, self.presence[leaf + 1 :]]),
            (*self.is_open[:leaf], True, True, True, *self.is_open[leaf + 1 :]),
        )


def _most_promising(state: _State, target: Target, assignment: Assignment) -> int | None:
    """Return the open leaf with the highest potential; None if none can raise the likelihood."""
    best, highest = None, assignment.log_likelihood + 1e-9
    for leaf in np.flatnonzero(state.presence.any(axis=1) & np.array(state.is_open)):
        value = target.potential(state.presence, assignment, int(leaf))
        if value > highest:
            best, highest = int(leaf), value
    return best


def _tested(
    found: Candidate,
    search: LeafSearch,
    target: Target,
    at: OpenLeaf,
    settings: TreeSettings,
    rng: np.random.Generator,
) -> float | None:
    """Return the p-value of the best candidate if it is significant, else None."""
    if settings.test == "permutation":
        p_value = permutation_p(found, search, target, at, settings, rng)
        return p_value if p_value <= settings.alpha else None
    return found.p_value if found.p_value < sidak(settings.alpha, found.n_tried) else None
