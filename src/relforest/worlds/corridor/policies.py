"""Hand-coded policies: the optimal one and the random one.

They are the upper and the lower bound in every figure of the corridor, and follow the protocol of learned
policies: ``choose(decision, rng)`` returns a position in the decision.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, final

import numpy as np

from relforest.smdp import Decision
from relforest.worlds.corridor.dynamics import LEFT, RIGHT

MIDDLE: Final = 0.5


@final
@dataclass(frozen=True, slots=True)
class OptimalPolicy:
    """Walk to the nearer edge: left if the agent is left of the middle, otherwise right.

    It earns about 8.69 per episode of 10 steps.

    References
    ----------
    Palmer (2015), section 7.3.1.
    """

    def choose(self, decision: Decision, rng: np.random.Generator) -> int:  # noqa: ARG002 - the protocol's
        """Return the position of the best action in `decision`; `rng` is not consumed."""
        decision.check_offers()
        best = LEFT if decision.objects[0, 0] < MIDDLE else RIGHT
        return int(np.flatnonzero(decision.types == best)[0])


@final
@dataclass(frozen=True, slots=True)
class RandomPolicy:
    """Choose uniformly among the available actions.

    It earns about 2.61 per episode of 10 steps.
    """

    def choose(self, decision: Decision, rng: np.random.Generator) -> int:
        """Return a uniform position in `decision`; consumes one integer from `rng`."""
        decision.check_offers()
        return int(rng.integers(len(decision)))
