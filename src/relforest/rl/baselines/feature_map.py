"""The input of a linear learner: for each action, the features that are not zero.

`FeatureMap` is all that a learner needs. `DenseFeatures` turns any function that returns a row of numbers per
action into one; `relforest.rl.baselines.tile_coding.TileCoding` is a sparse one.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Final, Generic, NamedTuple, Protocol, TypeVar, final

import numpy as np
from numpy.typing import ArrayLike

from relforest.rl.baselines.kernels import LIMIT
from relforest.scenes.arrays import FloatArray, IntArray
from relforest.support.errors import InputError
from relforest.support.options import at_least

Observation = TypeVar("Observation")
Observation_contra = TypeVar("Observation_contra", contravariant=True)

MAX_FEATURES: Final = 10_000_000
"""Largest number of features of a map: a longer weight vector indicates a mistake in the options."""


class Features(NamedTuple):
    """The features of all actions in one state, n actions with k entries each.

    The value of action a under weights w is the sum over j of ``w[indices[a, j]] * values[a, j]``.
    """

    indices: IntArray  # (n, k), from 0 to n_features - 1, different within a row
    values: FloatArray  # (n, k), finite; entries may be 0


class FeatureMap(Protocol[Observation_contra]):
    """Turns observations into features.

    Two maps are the same if `to_dict` returns the same; weights learned with one then fit the other.
    """

    @property
    def n_features(self) -> int:
        """Length of the weight vector."""
        ...

    @property
    def n_active(self) -> int:
        """Largest number of nonzero features of an action; step sizes are divided by it."""
        ...

    def features(self, observation: Observation_contra, /) -> Features:
        """Return the features of each available action, at least one, in fresh or constant arrays."""
        ...

    def to_dict(self) -> dict[str, Any]:
        """Return plain JSON values that identify this map; "kind" names its class."""
        ...


@final
class DenseFeatures(Generic[Observation]):
    """Any function from an observation to a row of numbers per action.

    All actions share one weight vector. Actions that should not share weights, such as actions of different
    types, need nonzero values in different columns.

    Parameters
    ----------
    function : callable
        Returns an (n_actions, n_features) array; the number of actions may differ between states.
    n_features : int
        Number of columns, 1 to 10 million.
    n_active : int, optional
        The divisor of step sizes, by default the number of columns. Where most are 0, give the number that
        are not. Steps do not overshoot if it is at least the squared length of every row and alpha is at
        most 1.
    name : str
        The name that identifies this function in a model file.

    Raises
    ------
    InputError
        If an option is out of its range.

    Examples
    --------
    >>> import numpy as np
    >>> pair = DenseFeatures(lambda x: np.array([[1.0, x, 0, 0], [0, 0, 1.0, x]]), 4, n_active=2)
    >>> pair.features(0.5).values[1]
    array([0. , 0. , 1. , 0.5])
    """

    def __init__(
        self,
        function: Callable[[Observation], ArrayLike],
        n_features: int,
        *,
        n_active: int | None = None,
        name: str = "dense",
    ) -> None:
        self._n_features = at_least("n_features", n_features, 1)
        if self._n_features > MAX_FEATURES:
            raise InputError(f"n_features must be at most {MAX_FEATURES}, got {n_features}")
        self._n_active = self._n_features if n_active is None else at_least("n_active", n_active, 1)
        if not isinstance(name, str) or not name:
            raise InputError(f"name must be a non-empty string, got {name!r}")
        self._function = function
        self._name = name
        self._indices: IntArray = np.empty((0, self._n_features), dtype=np.int64)

    @property
    def n_features(self) -> int:
        """Number of columns."""
        return self._n_features

    @property
    def n_active(self) -> int:
        """The divisor of step sizes."""
        return self._n_active

    def features(self, observation: Observation, /) -> Features:
        """Return the rows of the function with the numbers of their columns.

        Raises
        ------
        InputError
            If the function returns the wrong shape, no rows, or a number that is not finite or exceeds 1e100.
        """
        try:
            values = np.array(self._function(observation), dtype=np.float64, order="C")
        except (TypeError, ValueError) as error:
            raise InputError(f"the features {self._name!r} must be an array of numbers: {error}") from error
        if values.ndim != 2 or values.shape[1] != self._n_features or not len(values):
            raise InputError(
                f"the features {self._name!r} must have a row per action and {self._n_features} columns, "
                f"got the shape {values.shape}"
            )
        if not np.abs(values).max() <= LIMIT:
            action, column = np.argwhere(~(np.abs(values) <= LIMIT))[0]
            raise InputError(
                f"the features {self._name!r} of action {action} hold {values[action, column]} in column "
                f"{column}; give finite numbers, best from -1 to 1"
            )
        return Features(self._columns(len(values)), values)

    def to_dict(self) -> dict[str, Any]:
        """Return name and size; the function itself cannot be stored."""
        return {
            "kind": "dense",
            "name": self._name,
            "n_features": self._n_features,
            "n_active": self._n_active,
        }

    def _columns(self, n_actions: int) -> IntArray:
        """Return every column number for each action; the longest table so far serves all of them."""
        table = self._indices
        if len(table) < n_actions:
            table = np.tile(np.arange(self._n_features, dtype=np.int64), (n_actions, 1))
            table.flags.writeable = False
            self._indices = table
        return table[:n_actions]
