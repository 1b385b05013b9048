"""The contract between worlds and learners: a semi-Markov decision process over objects.

In every state, a world offers a finite set of ground actions: action types with objects of the state bound
to their parameters. An action may be an option that lasts longer than one unit of time (Palmer (2015),
section 2.1). `World` and the conventions below are all that a learner needs from a world; a world knows
nothing about learners.

Conventions of the Gymnasium face of a world
--------------------------------------------
- The action space is a flat ``Discrete`` space; `Decision.indices` lists the available members, and
  ``info["action_mask"]`` (int8 over the whole space) marks the same ones. A world may offer them as a method
  too: ``action_masks()``, bool.
- ``info["scene"]`` is a `relforest.Scenes` of length 1: the objects of the state, no arguments bound and no
  private ones (see `Decision`).
- After a step, ``info["duration"]`` is the time that the action took, in the world's units, finite and not
  negative. It is 0 if another agent must choose at the same moment, before any time passes.
- After a reset, ``info["duration_before"]`` and ``info["reward_before"]`` may be the time and the reward
  before the first decision, 0 if they are missing. They belong to the score of the episode, and to no action.
- The reward of ``env.step`` is the undiscounted total over the action; ``info["discounted_reward"]`` is
  the total discounted to the beginning of the action, and may be omitted if it equals the reward.
- ``terminated`` marks a terminal state (nothing follows, its value is 0); ``truncated`` marks a time limit.
- `Decision.remaining`, where the task limits the number of actions, falls by one with every action; it is 0
  in a terminal state, and 0 only at the end of an episode. A task without such a limit leaves it out.

`relforest.testing.check_world` checks whether a world follows them.

A world may also offer to play many episodes together, which is faster (`LockstepWorld`), and to propose more
actions while somebody chooses (`RefiningWorld`).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol, final, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from relforest.support.errors import InputError
from relforest.support.options import at_least

if TYPE_CHECKING:
    from relforest.scenes import Schema

UNBOUND = -1
"""Marks an argument position that an action type does not use."""

NO_LIMIT = -1
"""Marks, in columns, a state in a task that does not limit the number of actions."""


@final
@dataclass(frozen=True, slots=True)
class ActionType:
    """A type of action, with named parameters that objects are bound to.

    Parameters
    ----------
    name : str
        Name of the action type, such as ``"pass"``.
    parameters : tuple of str
        Names of the parameters in binding order, such as ``("passer", "receiver")``; empty for an action
        without arguments.

    Raises
    ------
    InputError
        If a name is not a non-empty string, or a parameter appears twice.
    """

    name: str
    parameters: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        if isinstance(self.parameters, str):
            raise InputError(
                f"parameters of action type {self.name!r} must be a tuple of names, not a string"
            )
        object.__setattr__(self, "parameters", tuple(self.parameters))
        for name in (self.name, *self.parameters):
            if not isinstance(name, str) or not name:
                raise InputError(
                    f"names of action types and parameters must be non-empty strings, got {name!r}"
                )
        if len(set(self.parameters)) < self.arity:
            raise InputError(
                f"action type {self.name!r} names a parameter twice: {self.parameters}; rename one"
            )

    @property
    def arity(self) -> int:
        """Number of parameters."""
        return len(self.parameters)


@final
@dataclass(frozen=True, slots=True)
class Action:
    """A ground action: an action type with objects bound to its parameters.

    Parameters
    ----------
    type : int
        Position in the world's ``action_types``.
    arguments : tuple of int
        Positions of the bound objects in the scene, in parameter order.

    Raises
    ------
    InputError
        If ``type`` or an argument is not a non-negative integer.
    """

    type: int
    arguments: tuple[int, ...] = ()

    def __post_init__(self) -> None:
        for position in (self.type, *self.arguments):
            integral = isinstance(position, (int, np.integer)) and not isinstance(position, bool)
            if not integral or position < 0:
                raise InputError(
                    f"the type and the arguments of an action must be positions (0, 1, ...), got {position!r}"
                )
        object.__setattr__(self, "type", int(self.type))
        object.__setattr__(self, "arguments", tuple(int(position) for position in self.arguments))


@final
@dataclass(frozen=True, slots=True, eq=False)
class Decision:
    """The objects of a state and the ground actions available in it.

    The scene of an action, which is what learners see of it, holds the objects that all actions share, and
    the private objects that the action binds. A virtual object, which represents a place that an action may
    aim at, is private: an action sees only the place that it aims at itself.

    Letters: n objects, w columns of the schema, m actions, k the largest arity among the world's action
    types. Construction checks types and shapes only, because worlds build one decision per step;
    `check_decision` checks the values against the world.

    Parameters
    ----------
    objects : (n, w) float64
        One row per object in the units of the world, NaN = undefined.
    types : (m,) int64
        The action type of each action.
    arguments : (m, k) int64
        Positions of the bound objects (rows of ``objects``) in parameter order, `UNBOUND` beyond
        the arity of the action type.
    indices : (m,) int64
        The action's number in the flat ``Discrete`` space.
    n_private : int
        Number of private objects: the last rows. A private object that no action binds does not appear in any
        scene.
    remaining : int, optional
        How many actions the episode can still take, the chosen one included, where the task limits their
        number. None: no such limit.

    Raises
    ------
    InputError
        If an array has the wrong number of dimensions, a type that cannot be cast safely, or a length that
        disagrees with the others, ``n_private`` is not from 0 to n, or ``remaining`` is negative or no
        integer.

    Notes
    -----
    The arrays become read-only views. A terminal state may offer no actions.

    References
    ----------
    Palmer (2015), section 6.5 (virtual objects).
    """

    objects: NDArray[np.float64]
    types: NDArray[np.int64]
    arguments: NDArray[np.int64]
    indices: NDArray[np.int64]
    n_private: int = 0
    remaining: int | None = None

    def __post_init__(self) -> None:
        for name, dtype, ndim in _COLUMNS:
            array = getattr(self, name)
            if type(array) is np.ndarray and array.dtype == dtype and array.ndim == ndim:
                if not array.flags.writeable:
                    continue
                array = array.view()
            else:
                array = _converted(name, array, dtype, ndim)
            array.flags.writeable = False
            object.__setattr__(self, name, array)
        if not len(self.types) == len(self.arguments) == len(self.indices):
            raise InputError(
                "types, arguments and indices must have one entry for each action, "
                f"got {len(self.types)}, {len(self.arguments)} and {len(self.indices)}"
            )
        if self.n_private:
            object.__setattr__(self, "n_private", at_least("n_private", self.n_private, 0))
        if self.n_private > len(self.objects):
            raise InputError(
                f"n_private must be at most {len(self.objects)}, the number of objects, got {self.n_private}"
            )
        if self.remaining is not None:
            object.__setattr__(self, "remaining", at_least("remaining", self.remaining, 0))

    def __len__(self) -> int:
        """Return the number of available actions."""
        return len(self.types)

    @property
    def n_objects(self) -> int:
        """Number of objects, shared and private."""
        return len(self.objects)

    @property
    def n_shared(self) -> int:
        """Number of objects that appear in the scene of every action: the first rows."""
        return len(self.objects) - self.n_private

    def check_offers(self) -> None:
        """Raise `InputError` if no action is available, as after the end of an episode."""
        if not len(self):
            raise InputError("the decision offers no action: the episode has ended, call reset() first")

    def action(self, position: int) -> Action:
        """Return the available action at `position` (0 <= position < len) as a structured value.

        Raises
        ------
        InputError
            If the position does not exist.
        """
        if not isinstance(position, (int, np.integer)) or not 0 <= position < len(self):
            raise InputError(f"position must name one of the {len(self)} available actions, got {position!r}")
        bound = self.arguments[position]
        return Action(int(self.types[position]), tuple(int(row) for row in bound[bound != UNBOUND]))


@final
@dataclass(frozen=True, slots=True, eq=False)
class Decisions:
    """Many decisions in columns.

    Letters as for `Decision`, and: s decisions, r object rows, c actions, of all decisions together. Nothing
    is checked; worlds build such columns in every step.

    Parameters
    ----------
    matrix : (r, w) float64
        The objects of all decisions, one row each.
    objects : (s + 1,) int64
        Decision ``i`` has the rows ``objects[i]`` to ``objects[i + 1]`` (exclusive).
    private : (s,) int64
        `Decision.n_private` of each.
    remaining : (s,) int64
        `Decision.remaining` of each, `NO_LIMIT` for None.
    candidates : (s + 1,) int64
        Decision ``i`` offers the actions ``candidates[i]`` to ``candidates[i + 1]`` (exclusive).
    types : (c,) int64
    arguments : (c, k) int64
        Positions among the objects of their own decision.
    indices : (c,) int64

    Notes
    -----
    The arrays become read-only views.
    """

    matrix: NDArray[np.float64]
    objects: NDArray[np.int64]
    private: NDArray[np.int64]
    remaining: NDArray[np.int64]
    candidates: NDArray[np.int64]
    types: NDArray[np.int64]
    arguments: NDArray[np.int64]
    indices: NDArray[np.int64]

    def __post_init__(self) -> None:
        for name in _NAMES:
            array = getattr(self, name).view()
            array.flags.writeable = False
            object.__setattr__(self, name, array)

    @classmethod
    def of(cls, decisions: Sequence[Decision]) -> Decisions:
        """Return the columns of at least one decision."""
        remaining = [NO_LIMIT if each.remaining is None else each.remaining for each in decisions]
        return cls(
            np.concatenate([each.objects for each in decisions]),
            np.cumsum([0, *(each.n_objects for each in decisions)]),
            np.array([each.n_private for each in decisions]),
            np.array(remaining),
            np.cumsum([0, *map(len, decisions)]),
            np.concatenate([each.types for each in decisions]),
            np.concatenate([each.arguments for each in decisions]),
            np.concatenate([each.indices for each in decisions]),
        )

    @classmethod
    def joined(cls, parts: Sequence[Decisions]) -> Decisions:
        """Return all decisions of at least one part, in the given order."""
        columns = {name: np.concatenate([getattr(part, name) for part in parts]) for name in _NAMES}
        for name in ("objects", "candidates"):
            counts = [np.diff(getattr(part, name)) for part in parts]
            columns[name] = np.cumsum(np.concatenate([[0], *counts]))
        return cls(**columns)

    def __len__(self) -> int:
        """Return the number of decisions."""
        return len(self.private)

    def __getitem__(self, i: int) -> Decision:
        """Return one of them (0 <= i < len)."""
        rows = slice(self.objects[i], self.objects[i + 1])
        own = slice(self.candidates[i], self.candidates[i + 1])
        remaining = int(self.remaining[i])
        return Decision(
            self.matrix[rows],
            self.types[own],
            self.arguments[own],
            self.indices[own],
            int(self.private[i]),
            None if remaining == NO_LIMIT else remaining,
        )

    def __iter__(self) -> Iterator[Decision]:
        """Iterate over them."""
        return map(self.__getitem__, range(len(self)))

    @property
    def n_actions(self) -> NDArray[np.int64]:
        """The number of actions that each decision offers, (s,)."""
        return np.diff(self.candidates)

    @property
    def owners(self) -> NDArray[np.int64]:
        """The number of the decision that offers each action, (c,)."""
        return np.repeat(np.arange(len(self)), self.n_actions)

    def take(self, order: NDArray[np.int64]) -> Decisions:
        """Return some of them in another order."""
        rows, objects = _gathered(self.objects, order)
        own, candidates = _gathered(self.candidates, order)
        return Decisions(
            self.matrix[rows],
            objects,
            self.private[order],
            self.remaining[order],
            candidates,
            self.types[own],
            self.arguments[own],
            self.indices[own],
        )


_NAMES = tuple(field.name for field in fields(Decisions))


def _gathered(
    offsets: NDArray[np.int64], order: NDArray[np.int64]
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return the members of groups in another order, and where the groups then begin and end."""
    counts = np.diff(offsets)[order]
    ends = np.concatenate([[0], np.cumsum(counts)])
    return np.arange(ends[-1]) + np.repeat(offsets[order] - ends[:-1], counts), ends


@runtime_checkable
class World(Protocol):
    """What a learner needs from a world; the ``unwrapped`` environment of every world implements it."""

    @property
    def schema(self) -> Schema:
        """Attributes of the objects, without parameters: those belong to the action types."""
        ...

    @property
    def action_types(self) -> tuple[ActionType, ...]:
        """The action types, in the order that `Decision.types` counts."""
        ...

    @property
    def discount(self) -> float:
        """Discount factor gamma per unit of ``info["duration"]``, in (0, 1]."""
        ...

    def decision(self) -> Decision:
        """Return the objects and the available ground actions of the present state."""
        ...


@runtime_checkable
class RefiningWorld(World, Protocol):
    """A world with actions that aim at places, which proposes further places near those it offers.

    A search for the best place is a conversation with such a world. A policy may ask while it chooses: the
    decision to be recorded is what ``decision()`` returns after the choice.

    References
    ----------
    Palmer (2015), section 6.5 (beam search across sampled actions).
    """

    def refine(self, positions: NDArray[np.int64]) -> Decision:
        """Return the present decision with more actions, like those at some positions.

        From now on ``decision()`` returns the same, and the new actions can be taken. Shared objects and
        actions stay as they are; new private objects and new actions follow the others. Nothing is added for
        actions that aim nowhere, for places that are offered already, or when the world cannot offer more.
        The next step or reset forgets what was added.
        """
        ...


class Outcomes(NamedTuple):
    """What a step of e episodes brought, all (e,)."""

    rewards: NDArray[np.float64]  # undiscounted
    discounted: NDArray[np.float64]  # discounted to the beginning of the action
    durations: NDArray[np.float64]
    terminal: NDArray[np.bool_]
    truncated: NDArray[np.bool_]


class Lockstep(Protocol):
    """Episodes that are played together; none depends on the others. They are named by their numbers."""

    @property
    def before(self) -> NDArray[np.float64]:
        """Reward and time before the first decision of each episode, (2, e)."""
        ...

    def decisions(self, episodes: NDArray[np.int64]) -> Decisions:
        """Return the present decisions of some episodes (e,)."""
        ...

    def step(self, episodes: NDArray[np.int64], actions: NDArray[np.int64]) -> Outcomes:
        """Take an action of the flat ``Discrete`` space (e,) in each of these episodes, which go on."""
        ...


@runtime_checkable
class LockstepWorld(World, Protocol):
    """A world that can play many episodes together."""

    @property
    def lockstep(self) -> Callable[[Sequence[int]], Lockstep] | None:
        """What begins an episode for each of several seeds; None if that is impossible at present.

        Episode i is what follows ``reset(seed=seeds[i])``, to the last bit; this environment does not change.
        """
        ...


def check_decision(decision: Decision, schema: Schema, action_types: Sequence[ActionType]) -> None:
    """Check the values of a decision against the world it comes from.

    Parameters
    ----------
    decision : Decision
        The decision of one state.
    schema : Schema
    action_types : sequence of ActionType
        Those of the world.

    Raises
    ------
    InputError
        If the objects do not fit the schema, a value is infinite, an action has an unknown type, an argument
        is missing, superfluous or not an object of the state, an index is negative or appears twice, or
        actions remain although none is offered.
    """
    n_objects, width = decision.objects.shape
    if width != schema.width:
        raise InputError(f"objects has {width} columns, but the schema of the world has {schema.width}")
    if np.isinf(decision.objects).any():
        raise InputError("objects contains an infinite value; use NaN for undefined values")
    largest = max((action_type.arity for action_type in action_types), default=0)
    if decision.arguments.shape[1] != largest:
        raise InputError(
            f"arguments has {decision.arguments.shape[1]} columns, "
            f"but the largest arity of the action types is {largest}"
        )
    if len(np.unique(decision.indices)) < len(decision) or (decision.indices < 0).any():
        raise InputError(f"indices must be distinct and not negative, got {decision.indices.tolist()}")
    if decision.remaining and not len(decision):
        raise InputError(f"remaining must be 0 in a state without actions, got {decision.remaining}")
    for position, (type_, arguments) in enumerate(zip(decision.types, decision.arguments, strict=True)):
        if not 0 <= type_ < len(action_types):
            raise InputError(
                f"action {position} has type {type_}, but there are {len(action_types)} action types"
            )
        arity = action_types[type_].arity
        bound, unused = arguments[:arity], arguments[arity:]
        if (bound < 0).any() or (bound >= n_objects).any() or (unused != UNBOUND).any():
            raise InputError(
                f"action {position} ({action_types[type_].name}) has arguments {arguments.tolist()}; "
                f"the first {arity} must be positions of the {n_objects} objects, the others {UNBOUND}"
            )


def check_refined(before: Decision, after: Decision) -> None:
    """Check what `RefiningWorld.refine` returned against the decision before; `check_decision` holds besides.

    Raises
    ------
    InputError
        If an object or an action changed, a number is used twice, a new object is shared, infinite or
        entirely undefined, or a new action binds no new object.
    """
    n, m = before.n_objects, len(before)
    for name, length in (("objects", n), ("types", m), ("arguments", m), ("indices", m)):
        if not np.array_equal(
            getattr(before, name), getattr(after, name)[:length], equal_nan=name == "objects"
        ):
            raise InputError(f"refine() must keep {name} of earlier actions as they were: only append")
    if (after.n_shared, after.remaining) != (before.n_shared, before.remaining):
        raise InputError("refine() must keep the shared objects and the number of remaining actions")
    added, places = after.objects[n:], after.arguments[m:]
    if np.isinf(added).any() or np.isnan(added).all(axis=1).any():
        raise InputError("refine() must add finite places, but added one that is infinite or undefined")
    if not ((places >= n) & (places < after.n_objects)).any(axis=1).all():
        raise InputError("each action that refine() adds must bind one of the private objects that it adds")
    if len(np.unique(after.indices)) < len(after):
        raise InputError("refine() must give each action that it adds a number of its own")


_COLUMNS = (
    ("objects", np.dtype(np.float64), 2),
    ("types", np.dtype(np.int64), 1),
    ("arguments", np.dtype(np.int64), 2),
    ("indices", np.dtype(np.int64), 1),
)


def _converted(name: str, values: object, dtype: np.dtype[Any], ndim: int) -> NDArray[Any]:
    """Return `values` as a new array of the type that a column needs, or raise `InputError`."""
    try:
        array = np.array(values)
    except ValueError as error:
        raise InputError(f"{name} must be a {ndim}-dimensional array of {dtype}: {error}") from error
    if array.ndim != ndim or not (np.can_cast(array.dtype, dtype, "same_kind") or array.size == 0):
        raise InputError(
            f"{name} must be a {ndim}-dimensional array of {dtype}, "
            f"got {array.ndim} dimensions of {array.dtype}"
        )
    return array.astype(dtype)
