"""Tile coding (CMAC): every variable is cut into overlapping intervals, each with a weight per action.

The tilings are one-dimensional, as in the keepaway benchmark of Stone et al. (2005): a value is a sum of one
function per variable, and each of these is piecewise constant on intervals of width / tilings, but learned in
steps as wide as a tile. With bells in the tiles, the features are radial basis functions of single variables.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any, Final, Literal, TypeAlias, final, get_args

import numpy as np
from numpy.typing import ArrayLike

from relforest.rl.baselines.feature_map import MAX_FEATURES, Features
from relforest.rl.baselines.kernels import active_tiles, bells
from relforest.scenes.arrays import FloatArray
from relforest.support.errors import InputError, ModelFormatError
from relforest.support.options import at_least, in_range, one_of

TileKind: TypeAlias = Literal["tiles", "bells"]

DEFAULT_TILES: Final = 64
MAX_VARIABLES: Final = 10_000
"""Number of tile widths that each variable covers by default."""


@final
class TileCoding:
    """One-dimensional tilings of each variable, for each action.

    With ``q = floor(s / width * tilings)`` for a variable of value s, its tiling j (0 to tilings - 1) has s
    in cell ``floor((q - j) / tilings)``: tiles are `widths` wide, and each tiling is shifted by
    ``width / tilings`` relative to the previous one. Variables are limited to a range, so that weights fit in
    an array rather than a hash table: a value outside the range has the tiles of the nearer bound.

    Parameters
    ----------
    widths : sequence of float
        Width of the tiles of each variable, in its unit, above 0.
    n_actions : int
        Number of actions, the same in all states.
    tilings : int
        Number of tilings per variable. With k variables, ``k * tilings`` features are active per action.
    lower, upper : float or sequence of float
        Range of the variables, one number for all or one each. By default from 0 over 64 tile widths.
    kind : {"tiles", "bells"}
        What an active tile contributes: 1, or the value of a Gaussian in the middle of the tile with an
        eighth of its width as standard deviation, scaled so that its square is 1 on average over the tile.
        With bells, values are smooth in the variables; 8 tilings or more hide where the centres are.

    Raises
    ------
    InputError
        If an option is out of its range, or more than 10 million features would be needed.

    Notes
    -----
    The feature of tiling j and cell c is numbered ``tilings * c + j`` up to a constant. The active tiles of
    a variable are then simply the numbers ``q - tilings + 1`` to ``q``.

    References
    ----------
    Stone, Sutton and Kuhlmann (2005), "Reinforcement learning for RoboCup soccer keepaway";
    Palmer (2015), section 7.5.2, which compares with it. Taylor and Stone (2007), "Cross-domain transfer for
    reinforcement learning", for radial basis functions in keepaway.

    Examples
    --------
    >>> tiles = TileCoding([2.0, 10.0], 3, tilings=4)
    >>> tiles.n_active, tiles.features([1.3, 45.0]).indices.shape
    (8, (3, 8))
    """

    def __init__(
        self,
        widths: Sequence[float],
        n_actions: int,
        *,
        tilings: int = 32,
        lower: float | Sequence[float] = 0.0,
        upper: float | Sequence[float] | None = None,
        kind: TileKind = "tiles",
    ) -> None:
        self._kind = one_of("kind", kind, get_args(TileKind))
        self._widths = _one_each("widths", widths, None)
        self._n_actions = at_least("n_actions", n_actions, 1)
        self._tilings = at_least("tilings", tilings, 1)
        n_variables = len(self._widths)
        self._lower = _one_each("lower", lower, n_variables)
        if upper is None:
            reach = [DEFAULT_TILES * width for width in self._widths]
            upper = [low + more for low, more in zip(self._lower, reach, strict=True)]
        self._upper = _one_each("upper", upper, n_variables)
        steps = [self._steps(i) for i in range(n_variables)]
        ends = np.cumsum([0] + [last - first + self._tilings for first, last in steps])
        self._n_features = self._n_actions * int(ends[-1])
        if self._n_features > MAX_FEATURES:
            raise InputError(
                f"these tiles need {self._n_features} features, more than {MAX_FEATURES}: "
                "use wider tiles, a narrower range (lower, upper) or fewer tilings"
            )
        self._tiles = (
            np.array(self._widths),
            np.array(self._lower),
            np.array(self._upper),
            np.array([end - first for end, (first, _) in zip(ends, steps, strict=False)], dtype=np.int64),
            self._tilings,
            int(ends[-1]),
        )
        self._ones: FloatArray = np.ones((self._n_actions, self.n_active))
        self._ones.flags.writeable = False

    @property
    def n_variables(self) -> int:
        """Number of variables of an observation."""
        return len(self._widths)

    @property
    def n_actions(self) -> int:
        """Number of actions."""
        return self._n_actions

    @property
    def n_features(self) -> int:
        """Number of tiles over all actions."""
        return self._n_features

    @property
    def n_active(self) -> int:
        """Number of active tiles of an action, tilings times variables."""
        return self._tilings * len(self._widths)

    def features(self, observation: ArrayLike, /) -> Features:
        """Return the active tiles of each action, variable after variable.

        Parameters
        ----------
        observation : (n_variables,) array-like of float
            The variables, in the order of the widths.

        Raises
        ------
        InputError
            If the number of variables is wrong, or a variable is NaN or infinite.
        """
        try:
            variables = np.array(observation, dtype=np.float64)
        except (TypeError, ValueError) as error:
            raise InputError(f"an observation must be an array of numbers: {error}") from error
        if variables.shape != (len(self._widths),):
            raise InputError(
                f"an observation must hold {len(self._widths)} variables, one per tile width, "
                f"got the shape {variables.shape}"
            )
        indices = np.empty(self._ones.shape, dtype=np.int64)
        bad = active_tiles(*self._tiles, variables, indices)
        if bad >= 0:
            raise InputError(f"variable {bad} of an observation must be finite, got {variables[bad]}")
        if self._kind == "tiles":
            return Features(indices, self._ones)
        widths, lower, upper, _, tilings, _ = self._tiles
        values = np.empty(self._ones.shape)
        bells(widths, lower, upper, tilings, variables, values)
        return Features(indices, values)

    def to_dict(self) -> dict[str, Any]:
        """Return the options as plain JSON values."""
        return {
            "kind": self._kind,
            "widths": list(self._widths),
            "n_actions": self._n_actions,
            "tilings": self._tilings,
            "lower": list(self._lower),
            "upper": list(self._upper),
        }

    @classmethod
    def from_dict(cls, document: object) -> TileCoding:
        """Read what `to_dict` returned.

        Raises
        ------
        ModelFormatError
            If an option is missing, unknown or out of its range.
        """
        names = ("kind", "widths", "n_actions", "tilings", "lower", "upper")
        if not isinstance(document, Mapping) or set(document) != set(names):
            raise ModelFormatError(
                f"malformed tile coding: expected {', '.join(names)}, got {document!r:.200}"
            )
        try:
            return cls(**document)
        except InputError as error:
            raise ModelFormatError(f"malformed tile coding: {error}") from error

    def _steps(self, i: int) -> tuple[int, int]:
        """Return q at both bounds of variable i."""
        width, low, high = self._widths[i], self._lower[i], self._upper[i]
        if not width > 0:
            raise InputError(f"widths[{i}] must be above 0, got {width}")
        if not low < high:
            raise InputError(f"upper[{i}] must be above lower[{i}] = {low}, got {high}")
        # Beyond 2**53, neighbouring steps cannot be told apart.
        if max(abs(low), abs(high)) / width * self._tilings > 2**53:
            raise InputError(
                f"widths[{i}] = {width} is too small for the range from {low} to {high}: use wider tiles"
            )
        return math.floor(low / width * self._tilings), math.floor(high / width * self._tilings)


def _one_each(name: str, numbers: float | Sequence[float], count: int | None) -> tuple[float, ...]:
    """Return `count` finite numbers, or any number of them but none if it is None."""
    if isinstance(numbers, (Sequence, np.ndarray)) and not isinstance(numbers, str):
        entries = list(numbers)
    else:
        entries = [numbers] * (count or 0)
    if len(entries) > MAX_VARIABLES:
        raise InputError(f"{name} must be at most {MAX_VARIABLES} numbers, got {len(entries)}")
    if not entries or (count is not None and len(entries) != count):
        expected = "at least one number" if count is None else f"one number, or {count} as the widths"
        raise InputError(f"{name} must be {expected}, got {numbers!r:.200}")
    return tuple(
        in_range(f"{name}[{i}]", entry, -math.inf, math.inf, open_low=True, open_high=True)
        for i, entry in enumerate(entries)
    )
