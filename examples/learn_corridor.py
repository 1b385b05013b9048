"""Learn a policy for the corridor from 100 episodes per iteration, and look at what it knows.

The picture shows the value of going left and right, the Bellman errors that trees are learned from, and the
leaf of every tree that is active at each place.
"""

from __future__ import annotations

import gymnasium

import relforest as rf
from relforest.experiments.corridor_picture import q_function_figure
from relforest.reports import save_figure

env = gymnasium.make("relforest/Corridor-v0")
agent = rf.SMRFRPI(env, random_state=0).learn(iterations=2, episodes=100)
for row in agent.metrics_:
    print(row)
evaluation = agent.evaluate(env, episodes=200, seed=1)
print("mean reward", round(float(evaluation.rewards.mean()), 2))
print(agent.value_.forests[0][0])
save_figure(q_function_figure(agent), "q-function.png")
