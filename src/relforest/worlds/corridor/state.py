"""The state of the corridor: where the agent is and how many steps the episode has taken."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from relforest.support.options import at_least, in_range


@final
@dataclass(frozen=True, slots=True)
class CorridorState:
    """One moment of an episode: the agent's location in corridor lengths, and the steps taken since it began.

    Raises
    ------
    InputError
        If ``x`` is not a number from 0 (left edge) to 1, or ``steps`` is not an integer of at least 0.
    """

    x: float
    steps: int = 0

    def __post_init__(self) -> None:
        # The world builds a state from plain numbers in every step.
        if type(self.x) is not float or not 0.0 <= self.x <= 1.0:
            object.__setattr__(self, "x", in_range("x", self.x, 0.0, 1.0))
        if type(self.steps) is not int or self.steps < 0:
            object.__setattr__(self, "steps", at_least("steps", self.steps, 0))


def initial_state(rng: np.random.Generator) -> CorridorState:
    """Draw the first state of an episode: the location is one uniform number from ``rng``."""
    return CorridorState(rng.random())
