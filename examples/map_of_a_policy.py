"""Learn keepaway from 100 episodes, and map what the policy would do wherever the takers stand.

The takers, two stars side by side, are moved over the field while the keepers stand still.
"""

from __future__ import annotations

import gymnasium
import numpy as np
from numpy.typing import NDArray

from relforest.experiments.keepaway_picture import formations, scene_decision
from relforest.reports import save_figure
from relforest.reports.policy_map import policy_map_figure
from relforest.rl.fitted import QLearner, QSettings
from relforest.runs import advance

env = gymnasium.make("relforest/Keepaway-v0", keepers=3, takers=2, size=20.0)
learner = QLearner(env, QSettings(), np.random.SeedSequence(0), 100, 20)
run, _ = advance(learner, None)
run, _ = advance(learner, run)
value = run.state.value
print("random play", run.metrics[0]["test_reward"], "learned", run.metrics[1]["test_reward"])


def values(states: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the values of all actions in each state."""
    return np.array([value.values(scene_decision(players, keepers=3, actor=0)) for players in states])


figure = policy_map_figure(
    formations(env.unwrapped.setup),
    values,
    keepers=3,
    field=(20.0, 20.0),
    step=1.0,
    title="after 100 episodes",
)
save_figure(figure, "policy-map.png")
