from __future__ import annotations

import numpy as np

from relforest.datasets import between_scenes
from relforest.experiments.concepts.ellipse import CentredEllipse
from relforest.metrics import peirce_skill_score
from relforest.scenes import Scenes


def scene(*others: tuple[float, float]) -> Scenes:
    """A at (0, 0), B at (0, 2), so that u = y / 2 and v = -x / 2 or x / 2, and other objects."""
    rows = [(0.0, 0.0), (0.0, 2.0), *others]
    objects = [{"id": name, "location": place} for name, place in zip("ABCDEF", rows, strict=False)]
    return Scenes.from_dicts([{"id": 0, "objects": objects, "arguments": {"A": "A", "B": "B"}}])


def test_an_object_inside_makes_a_scene_positive() -> None:
    ellipse = CentredEllipse(0.3, 0.1)

    # (0.15, 1): u = .5, v = .075 <= .1 inside; (0.25, 1): v = .125 outside; (0, 1.7): u = .85.
    assert ellipse.predict(scene((0.15, 1.0), (9.0, 9.0))).tolist() == [True]
    assert ellipse.predict(scene((0.25, 1.0), (0.0, 1.7))).tolist() == [False]


def test_the_best_ellipse_resembles_the_box_and_no_ellipse_equals_it() -> None:
    scenes, labels = between_scenes(np.random.default_rng(0), 400)
    ellipse = CentredEllipse.best(scenes, labels)

    # The box reaches .3 along and .15 across; an ellipse through its corners .42 and .21.
    assert 0.3 <= ellipse.along <= 0.43
    assert 0.15 <= ellipse.across <= 0.22
    assert 0.85 < peirce_skill_score(labels, ellipse.predict(scenes)) < 1
