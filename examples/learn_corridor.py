"""Learn a policy for the corridor from 100 episodes per iteration, and look at one of its trees."""

from __future__ import annotations

import gymnasium

import relforest as rf

env = gymnasium.make("relforest/Corridor-v0")
agent = rf.SMRFRPI(env, random_state=0).learn(iterations=2, episodes=100)
for row in agent.metrics_:
    print(row)
evaluation = agent.evaluate(env, episodes=200, seed=1)
print("mean reward", round(float(evaluation.rewards.mean()), 2))
print(agent.value_.forests[0][0])
