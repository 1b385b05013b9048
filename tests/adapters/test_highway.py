from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from relforest.adapters import highway_world
from relforest.rl.policy import RandomPolicy
from relforest.rl.rollout import rollout
from relforest.testing import check_world

pytest.importorskip("highway_env")


@pytest.mark.filterwarnings("ignore:.*A Box observation space")
def test_a_road_follows_the_conventions_of_worlds() -> None:
    check_world(lambda: highway_world(config={"duration": 5}), steps=10)


def test_the_agent_comes_first_and_others_are_seen_from_there() -> None:
    world = highway_world(vehicles=6, config={"vehicles_count": 9, "vehicles_density": 2})
    _, info = world.reset(seed=3)
    objects = world.decision().objects
    unwrapped: Any = world.env.unwrapped
    car = unwrapped.vehicle
    assert objects.shape == (6, 4)
    np.testing.assert_allclose(objects[0], [0.0, car.position[1], *car.velocity], atol=1e-4)
    assert info["scene"].counts.tolist() == [6]


def test_random_driving_is_paid() -> None:
    played = rollout(highway_world(config={"duration": 3}), RandomPolicy(), 2, np.random.SeedSequence(0))
    assert (played.episode_rewards > 0.0).all()
    assert (played.episode_durations <= 3.0).all()
