from __future__ import annotations

import numpy as np

from relforest.experiments.outcomes.protocol import cross_validated, shares, transferred
from relforest.trees import Tree
from small_trees import leaf, near_tree, plane


def test_trees_and_questions_are_counted() -> None:
    schema = plane()

    assert shares([near_tree(schema), Tree(schema, (leaf(0.5),))]) == {"stubs": 0.5, "share of distance": 1.0}


def test_machines_are_judged_by_scenes_they_have_not_seen() -> None:
    rng = np.random.default_rng(0)
    labels = np.arange(100) % 4 == 0
    telling, noise = labels[:, np.newaxis].astype(float), rng.standard_normal((100, 1))

    assert cross_validated(telling, labels, rng) == 1.0
    assert abs(cross_validated(noise, labels, rng)) < 0.4
    assert transferred((telling, labels), (1.0 - telling, labels), rng) == -1.0
