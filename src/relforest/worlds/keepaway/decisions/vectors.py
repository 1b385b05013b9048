"""Actions as vectors of a fixed length, for learners that know nothing of objects.

They are as long as there are players, so what is learned from them plays with these numbers of players only.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, final

import numpy as np
from numpy.typing import NDArray

from relforest.smdp import Decisions
from relforest.support.errors import InputError
from relforest.support.jit import kernel
from relforest.worlds.keepaway.decisions.scene import location_of
from relforest.worlds.keepaway.decisions.variables import by_distance, n_variables, state_variables
from relforest.worlds.keepaway.server.layout import X, Y

N_NUMBERS: Final = 8
"""Numbers of a player in `ActionObjects`."""


@final
@dataclass(frozen=True, slots=True)
class ActionVariables:
    """The type of an action, 0 to hold and 1 to pass, and the state variables of the benchmark.

    A pass is seen from its receiver: wherever teammates are listed, the receiver comes first instead of the
    nearest. See `relforest.worlds.keepaway.decisions.variables` for order and units.
    """

    keepers: int
    takers: int

    @property
    def width(self) -> int:
        """Length of a vector: 14 for 3 against 2."""
        return 1 + n_variables(self.keepers, self.takers)

    def vectors(self, decisions: Decisions) -> NDArray[np.float64]:
        """Return the vectors of all actions, (c, width).

        Raises
        ------
        InputError
            If there is another number of players.
        """
        out = np.empty((len(decisions.types), self.width))
        players = _players(decisions, self.keepers + self.takers)
        _write_variables(players, decisions.owners, decisions.arguments, self.keepers, out)
        return out


@final
@dataclass(frozen=True, slots=True)
class ActionObjects:
    """A row of numbers for each player, end to end: the holder, the receiver, other keepers and the takers.

    Zeros stand where nobody receives, and where a keeper is missing because it receives. The numbers are 1
    for a player, then 1 for the holder, for the receiver, and for a keeper; the location in tens of metres,
    and that seen from the holder. Other keepers and takers are ordered by distance from the holder.
    """

    keepers: int
    takers: int

    @property
    def n_rows(self) -> int:
        """Number of rows: one more than there are players."""
        return 1 + self.keepers + self.takers

    @property
    def width(self) -> int:
        """Length of a vector: 48 for 3 against 2."""
        return N_NUMBERS * self.n_rows

    def vectors(self, decisions: Decisions) -> NDArray[np.float64]:
        """Return the vectors of all actions, (c, width).

        Raises
        ------
        InputError
            If there is another number of players.
        """
        out = np.zeros((len(decisions.types), self.n_rows, N_NUMBERS))
        players = _players(decisions, self.keepers + self.takers)
        _write_objects(players, decisions.owners, decisions.arguments, self.keepers, out)
        return out.reshape(len(out), self.width)


def _players(decisions: Decisions, n: int) -> NDArray[np.float64]:
    """Return where the players of all decisions are, (s, n, 2)."""
    found = decisions.objects[1] if len(decisions) else n
    if not (np.diff(decisions.objects) == n).all():
        raise InputError(
            f"this was learned with {n} players, not {found}: choose the same numbers of players"
        )
    return np.ascontiguousarray(location_of(decisions.matrix)).reshape(-1, n, 2)


@kernel
def _write_variables(
    players: NDArray[np.float64],
    owners: NDArray[np.int64],
    arguments: NDArray[np.int64],
    keepers: int,
    out: NDArray[np.float64],
) -> None:
    n, state = players.shape[1], -1
    mates, variables = np.empty(keepers - 1, dtype=np.int64), np.empty(out.shape[1] - 1)
    # Where the teammates' distances to K1, to the centre, to takers, and their angles begin.
    blocks = (1, n, 2 * n - 1, 2 * n + keepers - 2)
    for i in range(len(owners)):
        if owners[i] != state:
            state = owners[i]
            scene = players[state]
            state_variables(scene, scene[arguments[i, 0]], keepers, variables)
            by_distance(scene, arguments[i, 0], 0, mates)
        out[i, 0] = 0.0 if arguments[i, 1] < 0 else 1.0
        out[i, 1:] = variables
        for rank in range(keepers - 1):
            if mates[rank] == arguments[i, 1]:
                for first in blocks:
                    out[i, 1 + first] = variables[first + rank]
                    out[i, 2 + first : 2 + first + rank] = variables[first : first + rank]


@kernel
def _write_objects(
    players: NDArray[np.float64],
    owners: NDArray[np.int64],
    arguments: NDArray[np.int64],
    keepers: int,
    out: NDArray[np.float64],
) -> None:
    n = players.shape[1]
    order = np.empty(n, dtype=np.int64)
    for i in range(len(owners)):
        scene, holder, receiver = players[owners[i]], arguments[i, 0], arguments[i, 1]
        order[0] = holder
        by_distance(scene, holder, 0, order[1:keepers])
        by_distance(scene, holder, keepers, order[keepers:])
        for j in range(n):
            player = order[j]
            # The second row is the receiver's.
            row = 1 if player == receiver else (j + 1 if j > 0 else 0)
            out[i, row, 0] = 1.0
            out[i, row, 1] = 1.0 if player == holder else 0.0
            out[i, row, 2] = 1.0 if player == receiver else 0.0
            out[i, row, 3] = 1.0 if player < keepers else 0.0
            out[i, row, 4], out[i, row, 5] = scene[player, X] / 10.0, scene[player, Y] / 10.0
            out[i, row, 6] = (scene[player, X] - scene[holder, X]) / 10.0
            out[i, row, 7] = (scene[player, Y] - scene[holder, Y]) / 10.0
