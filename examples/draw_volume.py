"""Draw the region that makes a bag positive, among the points of all bags.

Half of the bags are positive; each of them has one point in a narrow diagonal between two clouds. Covariant
aggregation is told the labels of bags only.
"""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

import relforest as rf
from relforest.datasets import covariant1
from relforest.reports import save_figure

data = covariant1(np.random.default_rng(0))
model = rf.CovAggClassifier(random_state=0).fit(data.bags, data.labels)

figure = Figure(figsize=(6, 4), layout="constrained")
axes = figure.add_subplot(aspect="equal", xlabel="first feature", ylabel="second feature")
for positive, color, name in ((False, "#b4540a", "in negative bags"), (True, "#265496", "in positive bags")):
    points = np.concatenate([bag for bag, label in zip(data.bags, data.labels, strict=True) if label == positive])
    axes.plot(*points.T, ".", color=color, alpha=0.5, label=name)
turn = np.linspace(0.0, 2.0 * np.pi, 200)
volume = model.volume_
outline = volume.mean + np.column_stack([np.cos(turn), np.sin(turn)]) @ volume.axes
axes.plot(*outline.T, color="#262626", label="the volume")
axes.legend()
save_figure(figure, "volume.png")
print("bags with a point inside:", sum(volume.contains(bag).any() for bag in data.bags), "of", len(data))
