"""The state of the corridor: where the agent is and how many steps the episode has taken."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from relforest.support.errors import InputError


@final
@dataclass(frozen=True, slots=True)
class CorridorState:
    """One moment of an episode.

    Parameters
    ----------
    x : float
        Location of the agent, in corridor lengths, 0 (left edge) to 1 (right edge).
    steps : int
        Steps taken since the beginning of the episode.

    Raises
    ------
    InputError
        If ``x`` lies outside the corridor or ``steps`` is negative.
    """

    x: float
    steps: int = 0

    def __post_init__(self) -> None:
        if not 0.0 <= self.x <= 1.0:
            raise InputError(f"the location of the agent must lie between 0 and 1, got {self.x!r}")
        if self.steps < 0:
            raise InputError(f"steps must be at least 0, got {self.steps!r}")


def initial_state(rng: np.random.Generator) -> CorridorState:
    """Draw the first state of an episode: the location is uniform over the corridor.

    Parameters
    ----------
    rng : numpy.random.Generator
        Consumed by one uniform number.
    """
    return CorridorState(rng.random())
