"""Find the region that makes a bag of points positive, and the points that lie in it."""

from __future__ import annotations

import numpy as np

import relforest as rf
from relforest.datasets import covariant1

train, test = (covariant1(np.random.default_rng(seed), reading="printed") for seed in (0, 1))
model = rf.CovAggClassifier(random_state=0).fit(train.bags, train.labels)

volume = model.volume_
print("centre", volume.mean.round(2))
print("semi-axes", [axis.round(2).tolist() for axis in volume.axes])
score = rf.metrics.peirce_skill_score(test.labels, model.predict(test.bags))
print(f"Peirce skill score {score:.2f}")
print("witnesses of the first bags", model.witness(test.bags)[:5])
