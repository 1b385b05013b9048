"""Policies of the benchmark: random, always hold, and the hand-coded one.

Simulations use the kernel `hand_coded`; the classes follow the protocol of learned policies:
``choose(decision, rng)`` returns a position in the decision.
"""

from __future__ import annotations

import operator
from dataclasses import dataclass
from typing import Final, final

import numpy as np
from numpy.typing import NDArray

from relforest.smdp import Decision
from relforest.support.errors import InputError
from relforest.support.jit import kernel
from relforest.worlds.keepaway.decisions.scene import HOLD_TYPE, location_of
from relforest.worlds.keepaway.decisions.variables import n_variables, state_variables
from relforest.worlds.keepaway.server.rounding import TIE

CALM: Final = 5.0
"""Metres from the nearest taker to the ball holder beyond which the hand-coded policy holds."""

HOLD_SCORE: Final = 90.0
"""The score, in degrees, that a pass must exceed to be preferred to holding."""

DISTANCE_WEIGHT: Final = 4.0
"""The weight of a metre between a receiver and its nearest taker, in degrees of free angle."""


@kernel
def hand_coded(variables: NDArray[np.float64], keepers: int, takers: int) -> int:
    """Return the action of the benchmark's hand-coded policy: 0 = hold, i = pass to K(i+1).

    Hold while no taker is within 5 m of K1. Otherwise hold scores 90, and a pass four times the
    receiver's distance to its nearest taker plus the free angle to it; the first of the highest scores wins.
    The state variables are those of `relforest.worlds.keepaway.decisions.variables`.
    """
    if variables[keepers] > CALM + TIE:
        return 0
    nearest = 2 * (keepers + takers) - 1
    best, highest = 0, HOLD_SCORE
    for rank in range(keepers - 1):
        score = DISTANCE_WEIGHT * variables[nearest + rank] + variables[nearest + keepers - 1 + rank]
        if score > highest + TIE:
            best, highest = rank + 1, score
    return best


def checked_action(action: object, keepers: int) -> int:
    """Return the action chosen by a policy ``(state_variables, rng) -> int`` as a plain integer.

    Raises
    ------
    InputError
        If it is not an integer from 0 to ``keepers - 1``.
    """
    try:
        chosen = operator.index(action)  # type: ignore[arg-type]
    except TypeError:
        chosen = -1
    if isinstance(action, bool) or not 0 <= chosen < keepers:
        raise InputError(
            f"the policy must return an integer from 0 (hold) to {keepers - 1} (pass to the farthest "
            f"teammate), got {action!r}"
        )
    return chosen


@final
@dataclass(frozen=True, slots=True)
class RandomPolicy:
    """Choose uniformly among holding and passing to each teammate."""

    def choose(self, decision: Decision, rng: np.random.Generator) -> int:
        """Return a uniform position in `decision`; consumes one integer from `rng`."""
        decision.check_offers()
        return int(rng.integers(len(decision)))


@final
@dataclass(frozen=True, slots=True)
class HoldPolicy:
    """Always hold the ball."""

    def choose(self, decision: Decision, rng: np.random.Generator) -> int:  # noqa: ARG002 - the protocol's
        """Return the position of holding in `decision`; `rng` is not consumed."""
        decision.check_offers()
        return int(np.flatnonzero(decision.types == HOLD_TYPE)[0])


@final
@dataclass(frozen=True, slots=True)
class HandCodedPolicy:
    """Hold until a taker comes close, then pass to the most open teammate.

    A decision does not contain the ball, so the ball is assumed to be at the keeper that must decide. That
    keeper is the nearest to it unless two keepers can reach the ball.
    """

    def choose(self, decision: Decision, rng: np.random.Generator) -> int:  # noqa: ARG002 - the protocol's
        """Return the position of the action in `decision`; `rng` is not consumed."""
        keepers = len(decision)
        action = hand_coded(decision_variables(decision), keepers, decision.n_objects - keepers)
        return int(np.flatnonzero(decision.indices == action)[0])

    def values(self, decision: Decision) -> NDArray[np.float64]:
        """Return the scores that are compared, (n_actions,); NaN for passes that are ignored."""
        keepers, variables = len(decision), decision_variables(decision)
        if variables[keepers] > CALM + TIE:
            return np.array([HOLD_SCORE] + [np.nan] * (keepers - 1))
        near, angles = np.split(variables[2 * decision.n_objects - 1 :], 2)
        return np.concatenate([[HOLD_SCORE], DISTANCE_WEIGHT * near + angles])[decision.indices]


def decision_variables(decision: Decision) -> NDArray[np.float64]:
    """Return the state variables of a decision, with the ball at the keeper that must decide.

    Raises
    ------
    InputError
        If the decision offers no action, as at the end of an episode, when no keeper has the ball.
    """
    decision.check_offers()
    # There is one action for each keeper: hold, and a pass to each of the others.
    keepers = len(decision)
    variables = np.empty(n_variables(keepers, decision.n_objects - keepers))
    players = location_of(decision.objects).copy()
    state_variables(players, players[decision.arguments[0, 0]], keepers, variables)
    return variables
