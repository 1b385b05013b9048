from __future__ import annotations

from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium import spaces

from relforest.adapters import ObjectEnv
from relforest.scenes import Attribute, Schema
from relforest.support.errors import InputError
from relforest.testing import check_world

SCHEMA = Schema((Attribute("location", 2), Attribute("size", 1)))


class Marbles(gymnasium.Env[Any, Any]):
    """A marble rolls; the others appear and vanish. It may be kicked only while its number is even."""

    action_space = spaces.Discrete(2)
    observation_space = spaces.Box(-1e3, 1e3, (5, 4), np.float64)

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> Any:
        super().reset(seed=seed, options=options)
        self.steps = 0
        return self._seen()

    def step(self, action: int) -> Any:
        self.steps += 1
        seen, info = self._seen()
        return seen, np.float32(action), self.steps == 4, False, info | {"duration": 0.5}

    def _seen(self) -> Any:
        rows = np.column_stack([self.np_random.uniform(-1.0, 1.0, (5, 3)), np.ones(5)])
        rows[1 + self.steps :, 3] = 0.0
        return rows, {"action_mask": np.array([1, self.steps % 2 == 0], dtype=np.int8), "steps": self.steps}


def present(seen: Any) -> Any:
    return seen[seen[:, 3] > 0.0, :3]


def world(**options: Any) -> ObjectEnv:
    chosen: dict[str, Any] = {
        "objects": present,
        "actions": ("wait", "kick"),
        "slots": 5,
        "parameters": ("marble",),
    } | options
    return ObjectEnv(Marbles(), SCHEMA, chosen.pop("objects"), chosen.pop("actions"), **chosen)


@pytest.mark.filterwarnings("ignore:.*A Box observation space")
def test_it_follows_the_conventions_of_worlds() -> None:
    check_world(world)


def test_the_first_object_is_bound_to_every_available_action() -> None:
    env = world()
    env.reset(seed=0)
    decision = env.decision()
    assert decision.arguments.tolist() == [[0], [0]]
    _, reward, terminated, truncated, info = env.step(np.int64(1))
    assert (reward, terminated, truncated) == (1.0, False, False)
    assert (info["duration"], info["steps"], info["scene"].counts.tolist()) == (0.5, 1, [2])
    assert env.decision().indices.tolist() == [0]


def test_what_is_undefined_stays_so_in_the_scene_and_is_0_in_the_observation() -> None:
    env = world(objects=lambda seen: present(seen) * [1.0, 1.0, np.nan])
    observation, info = env.reset(seed=0)
    assert np.isnan(env.decision().objects[:, 2]).all()
    assert np.isnan(info["scene"].matrix[:, 2]).all()
    assert observation["size"].tolist() == [[0.0]] * 5
    assert observation["mask"].tolist() == [1, 0, 0, 0, 0]


@pytest.mark.parametrize(
    ("options", "complaint"),
    [
        ({"actions": ("wait",)}, "a Discrete space of 1 actions"),
        ({"discount": 0.0}, "discount"),
        ({"slots": 0}, "slots"),
        ({"objects": lambda _: np.zeros((6, 3))}, r"1 to 5 objects in rows of 3 numbers.*\(6, 3\)"),
        ({"objects": lambda _: np.zeros((0, 3))}, r"1 to 5 objects"),
        ({"objects": lambda _: np.zeros((2, 2))}, r"rows of 3 numbers"),
        ({"objects": lambda _: np.zeros(3)}, r"shape \(3,\)"),
    ],
)
def test_what_does_not_fit_is_refused(options: dict[str, Any], complaint: str) -> None:
    with pytest.raises(InputError, match=complaint):
        world(**options).reset(seed=0)


def test_nothing_can_be_decided_before_the_first_episode() -> None:
    with pytest.raises(InputError, match="call reset"):
        world().decision()
