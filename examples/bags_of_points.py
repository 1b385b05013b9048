"""Find the region that makes a bag of points positive, and the points that lie in it.

Half of the bags are positive; each of them has one point in a narrow diagonal between two clouds. Covariant
aggregation is told the labels of bags only.
"""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

import relforest as rf
from relforest.datasets import covariant1
from relforest.reports import save_figure

train, test = (covariant1(np.random.default_rng(seed), reading="printed") for seed in (0, 1))
model = rf.CovAggClassifier(random_state=0).fit(train.bags, train.labels)

volume = model.volume_
print("centre", volume.mean.round(2))
print("semi-axes", [axis.round(2).tolist() for axis in volume.axes])
score = rf.metrics.peirce_skill_score(test.labels, model.predict(test.bags))
print(f"Peirce skill score {score:.2f}")
print("witnesses of the first bags", model.witness(test.bags)[:5])

figure = Figure(figsize=(6, 4), layout="constrained")
axes = figure.add_subplot(aspect="equal", xlabel="first feature", ylabel="second feature")
for positive, color, name in ((False, "#b4540a", "in negative bags"), (True, "#265496", "in positive bags")):
    bags = [bag for bag, label in zip(train.bags, train.labels, strict=True) if label == positive]
    axes.plot(*np.concatenate(bags).T, ".", color=color, alpha=0.5, label=name)
turn = np.linspace(0.0, 2.0 * np.pi, 200)
outline = volume.mean + np.column_stack([np.cos(turn), np.sin(turn)]) @ volume.axes
axes.plot(*outline.T, color="#262626", label="the volume")
axes.legend()
save_figure(figure, "volume.png")
