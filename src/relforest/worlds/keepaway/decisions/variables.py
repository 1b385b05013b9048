"""The state variables of the benchmark: distances and angles, players sorted by distance.

With K keepers and T takers, their number is 4 K + 2 T - 3. K1 is the keeper nearest to the ball, usually the
one that must decide; K2, K3, ... are its teammates and T1, T2, ... the takers, the nearest to K1 first; C is
the centre of the field. In order:

- the distance from K1 to C;
- the distances from K1 to K2, K3, ...;
- the distances from K1 to T1, T2, ...;
- the distances from K2, K3, ... to C;
- the distances from T1, T2, ... to C;
- for each of K2, K3, ...: the distance to the taker nearest to it;
- for each of K2, K3, ...: the smallest angle at K1 between it and a taker, 0 to 180 degrees.

References
----------
Stone, Kuhlmann, Taylor, and Liu (2006), "Keepaway soccer: from machine learning testbed to benchmark".
Palmer (2015), section 7.5.1.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np
from numpy.typing import NDArray

from relforest.support.jit import kernel
from relforest.support.options import at_least
from relforest.worlds.keepaway.server.layout import X, Y
from relforest.worlds.keepaway.server.rounding import TIE

ANGLE_WIDTH: Final = 10.0
"""Width of the benchmark's tiles for an angle, in degrees."""


def n_variables(keepers: int, takers: int) -> int:
    """Return the number of state variables: 13 for 3 against 2, 19 for 4 against 3.

    Raises
    ------
    InputError
        If ``keepers`` is less than 2 or ``takers`` less than 1.
    """
    return 4 * at_least("keepers", keepers, 2) + 2 * at_least("takers", takers, 1) - 3


def variable_names(keepers: int, takers: int) -> tuple[str, ...]:
    """Return a name for each state variable, such as ``"K1-T2"`` or ``"angle T-K1-K3"``.

    Raises
    ------
    InputError
        If ``keepers`` is less than 2 or ``takers`` less than 1.
    """
    n_variables(keepers, takers)
    mates = [f"K{rank}" for rank in range(2, keepers + 1)]
    opponents = [f"T{rank}" for rank in range(1, takers + 1)]
    return (
        "K1-C",
        *(f"K1-{player}" for player in [*mates, *opponents]),
        *(f"{player}-C" for player in [*mates, *opponents]),
        *(f"{mate}-nearest T" for mate in mates),
        *(f"angle T-K1-{mate}" for mate in mates),
    )


def tile_widths(keepers: int, takers: int) -> tuple[float, ...]:
    """Return the width of the benchmark's tiles for each state variable, in metres and degrees.

    The benchmark defines them for 3 keepers against 2 takers and for 4 against 3. Other numbers follow the
    same pattern: 2 m for distances of keepers to K1 and to the centre, except 3 m for the farthest of several
    teammates; 3 m for distances of takers, except 2 m from K1 to the first of one or two takers; 4 m
    for distances of teammates to their nearest taker; 10 degrees for angles.

    Raises
    ------
    InputError
        If ``keepers`` is less than 2 or ``takers`` less than 1.

    References
    ----------
    Stone, Kuhlmann, Taylor, and Liu (2006), "Keepaway soccer: from machine learning testbed to benchmark".
    """
    n_variables(keepers, takers)
    mates = (2.0,) * (keepers - 2) + (3.0 if keepers > 2 else 2.0,)
    pressing = (2.0 if takers <= 2 else 3.0,) + (3.0,) * (takers - 1)
    return (
        *(2.0, *mates, *pressing),
        *(*mates, *(3.0,) * takers),
        *((4.0,) * (keepers - 1) + (ANGLE_WIDTH,) * (keepers - 1)),
    )


@kernel
def nearest_keeper(players: NDArray[np.float64], ball: NDArray[np.float64], keepers: int) -> int:
    """Return the keeper nearest to the ball; of several, the one with the highest number."""
    best, least = -1, math.inf
    for i in range(keepers - 1, -1, -1):
        distance = _squared(players[i, X] - ball[X], players[i, Y] - ball[Y])
        if distance < least - TIE:
            best, least = i, distance
    return best


@kernel
def by_distance(players: NDArray[np.float64], centre: int, first: int, out: NDArray[np.int64]) -> None:
    """Write players to `out`, the nearest to the player `centre` first; equally near ones from the highest.

    It considers as many players as needed to fill `out`, from the number `first` on, and skips `centre`.
    """
    count = len(out)
    beyond = first + count + (1 if first <= centre <= first + count else 0)
    filled = 0
    for i in range(beyond - 1, first - 1, -1):
        if i != centre:
            distance = _apart(players, centre, i)
            place = filled
            while place > 0 and distance < _apart(players, centre, out[place - 1]) - TIE:
                out[place] = out[place - 1]
                place -= 1
            out[place] = i
            filled += 1


@kernel
def state_variables(
    players: NDArray[np.float64], ball: NDArray[np.float64], keepers: int, out: NDArray[np.float64]
) -> None:
    """Write the state variables of one state to `out`.

    Parameters
    ----------
    players : (n, >= 2) float64
        One row per player, keepers first: x, y in metres; what follows is not used. Usually what
        the deciding keeper perceives.
    ball : (>= 2,) float64
        x, y in metres.
    keepers : int
        How many of the players are keepers.
    out : (n_variables,) float64
        Metres and degrees, in the order given above.
    """
    takers = len(players) - keepers
    mates, opponents = np.empty(keepers - 1, dtype=np.int64), np.empty(takers, dtype=np.int64)
    decider = nearest_keeper(players, ball, keepers)
    by_distance(players, decider, 0, mates)
    by_distance(players, decider, keepers, opponents)
    out[0] = math.sqrt(_squared(players[decider, X], players[decider, Y]))
    mate, near = 1, keepers
    to_centre, taker_to_centre = keepers + takers, 2 * keepers + takers - 1
    nearest = 2 * (keepers + takers) - 1
    angle = nearest + keepers - 1
    for rank in range(takers):
        i = opponents[rank]
        out[near + rank] = math.sqrt(_apart(players, decider, i))
        out[taker_to_centre + rank] = math.sqrt(_squared(players[i, X], players[i, Y]))
    for rank in range(keepers - 1):
        i = mates[rank]
        out[mate + rank] = math.sqrt(_apart(players, decider, i))
        out[to_centre + rank] = math.sqrt(_squared(players[i, X], players[i, Y]))
        least, narrowest = math.inf, math.inf
        for j in range(keepers, keepers + takers):
            least = min(least, _apart(players, i, j))
            narrowest = min(narrowest, _angle(players, decider, i, j))
        out[nearest + rank] = math.sqrt(least)
        out[angle + rank] = math.degrees(narrowest)


@kernel
def _squared(x: float, y: float) -> float:
    return x * x + y * y


@kernel
def _apart(players: NDArray[np.float64], i: int, j: int) -> float:
    return _squared(players[i, X] - players[j, X], players[i, Y] - players[j, Y])


@kernel
def _angle(players: NDArray[np.float64], apex: int, i: int, j: int) -> float:
    # atan2 needs no lengths, is exact where the lines coincide, and gives 0 for a player at the apex: adding
    # 0 makes 0 of the -0 for which it would give pi.
    ax, ay = players[i, X] - players[apex, X], players[i, Y] - players[apex, Y]
    bx, by = players[j, X] - players[apex, X], players[j, Y] - players[apex, Y]
    return math.atan2(abs(ax * by - ay * bx), ax * bx + ay * by + 0.0)
