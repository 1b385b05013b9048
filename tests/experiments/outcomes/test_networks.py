from __future__ import annotations

import numpy as np
import pytest

from experiments.outcomes.test_rivals import SCENES
from relforest.experiments.outcomes.networks import NETWORKS, sets
from relforest.experiments.outcomes.run import unavailable
from relforest.experiments.outcomes.scenes import Labelled
from relforest.experiments.outcomes.settings import SETTINGS
from small_trees import plane, scenes_in


def test_objects_are_vectors_seen_from_the_arguments() -> None:
    vectors, places = sets(SCENES)

    # Weight, whether it is A, difference from A.
    assert places.tolist() == [[True, True, True], [True, False, False]]
    assert vectors.tolist() == [[[2, 0, -8], [10, 1, 0], [5, 0, -5]], [[1, 1, 0], [0, 0, 0], [0, 0, 0]]]


def test_a_scene_without_objects_has_an_empty_place() -> None:
    vectors, places = sets(scenes_in(plane(), [[]]))

    assert places.tolist() == [[False]]
    assert vectors.tolist() == [[[0.0, 0.0]]]


@pytest.mark.parametrize("name", NETWORKS)
def test_networks_learn_a_relation(name: str) -> None:
    pytest.importorskip("torch", reason="PyTorch is not installed: install the extra 'relforest[bench]'")
    places = np.random.default_rng(0).uniform(0, 10, (300, 3, 2))
    scenes = scenes_in(plane("A"), places.tolist(), [[0]] * 300)
    labels = np.linalg.norm(places[:, :1] - places[:, 1:], axis=2).min(axis=1) < 4
    scores = NETWORKS[name](Labelled(scenes.take(np.arange(200)), labels[:200]), 0)

    assert np.mean((scores(scenes)[200:] > 0.0) == labels[200:]) > 0.85


def test_settings_with_networks_need_pytorch(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("relforest.experiments.outcomes.run.find_spec", lambda _: None)

    assert {setting.part for setting in unavailable(SETTINGS)} == {"networks"}
