"""The objects of a state and the actions available in it, of one state and of many."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields
from typing import Any, final

import numpy as np
from numpy.typing import NDArray

from relforest.support.errors import InputError
from relforest.support.options import at_least

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
