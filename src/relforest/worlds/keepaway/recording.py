"""Episodes as arrays: every cycle, and every decision with the values it was based on."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, final

import numpy as np
from numpy.typing import NDArray

from relforest.support.errors import InputError
from relforest.worlds.keepaway.layout import CAPPED, PLAYING

SECOND: Final = 10
"""Cycles in a second."""


@final
@dataclass(frozen=True, slots=True, eq=False)
class Decisions:
    """The decisions of an episode, in order.

    Letters: d decisions, K keepers.

    Parameters
    ----------
    times : (d,) int64
        Cycles since the episode began.
    actors : (d,) int64
        The keepers that decided.
    actions : (d,) int64
        0 = hold, k = pass to the k-th nearest teammate.
    orders : (d, K) int64
        The keepers in the order of the actions: the actor itself, then its teammates, nearest first.
    values : (d, K) float64
        The values of the actions according to the policy, NaN = unknown.

    Raises
    ------
    InputError
        If the shapes do not agree.
    """

    times: NDArray[np.int64]
    actors: NDArray[np.int64]
    actions: NDArray[np.int64]
    orders: NDArray[np.int64]
    values: NDArray[np.float64]

    def __post_init__(self) -> None:
        n, keepers = len(self.times), self.orders.shape[-1]
        for name, shape in (
            ("actors", (n,)),
            ("actions", (n,)),
            ("orders", (n, keepers)),
            ("values", (n, keepers)),
        ):
            if getattr(self, name).shape != shape:
                raise InputError(f"{name} must have the shape {shape}, got {getattr(self, name).shape}")

    def __len__(self) -> int:
        """Return the number of decisions."""
        return len(self.times)


@final
@dataclass(frozen=True, slots=True, eq=False)
class Recording:
    """An episode, cycle by cycle.

    Letters: t cycles, n players (K keepers, then the takers).

    Parameters
    ----------
    field : (float, float)
        Length (along x) and width, in metres.
    keepers : int
        Number of keepers.
    players : (t + 1, n, 5) float64
        x, y, vx, vy (metres, metres per cycle) and body direction (degrees) before the first cycle and after
        each.
    ball : (t + 1, 4) float64
        x, y, vx, vy.
    commands : (t, n, 3) int64
        What the players did in each cycle: kind, power or moment, direction.
    decisions : Decisions
    end : int
        How the episode ended: OUT, TAKEN or CAPPED; PLAYING if the recording is incomplete.

    Raises
    ------
    InputError
        If the shapes do not agree, or ``end`` is not one of these codes.
    """

    field: tuple[float, float]
    keepers: int
    players: NDArray[np.float64]
    ball: NDArray[np.float64]
    commands: NDArray[np.int64]
    decisions: Decisions
    end: int

    def __post_init__(self) -> None:
        states, n = self.players.shape[:2]
        shapes = {"players": (states, n, 5), "ball": (states, 4), "commands": (states - 1, n, 3)}
        for name, shape in shapes.items():
            if getattr(self, name).shape != shape:
                raise InputError(f"{name} must have the shape {shape}, got {getattr(self, name).shape}")
        if self.decisions.orders.shape[1] != self.keepers or not 0 < self.keepers < n:
            raise InputError(
                f"{self.keepers} keepers among {n} players do not agree with decisions of "
                f"{self.decisions.orders.shape[1]} keepers"
            )
        if not PLAYING <= self.end <= CAPPED:
            raise InputError(f"end must be a code from {PLAYING} to {CAPPED}, got {self.end}")

    @property
    def duration(self) -> int:
        """Cycles of the episode."""
        return len(self.commands)

    @property
    def takers(self) -> int:
        """Number of takers."""
        return int(self.players.shape[1]) - self.keepers

    def trail(self, time: int, *, cycles: int = 15) -> NDArray[np.float64]:
        """Return the last locations of all players and, last, of the ball, (at most cycles + 1, n + 1, 2)."""
        past = slice(max(time - cycles, 0), time + 1)
        return np.concatenate([self.players[past, :, :2], self.ball[past, None, :2]], axis=1)
