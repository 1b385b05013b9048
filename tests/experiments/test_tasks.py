from __future__ import annotations

import pytest

from relforest.experiments.tasks import TASKS, task_named
from relforest.smdp import World
from relforest.support.errors import InputError
from relforest.worlds import ENVIRONMENT_IDS


def test_every_task_makes_a_world() -> None:
    for name, task in TASKS.items():
        assert task.name == name
        assert task.world in ENVIRONMENT_IDS
        env = task.make()
        env.reset(seed=0)
        assert isinstance(env.unwrapped, World)
        env.close()


def test_an_unknown_task_is_named_with_those_that_exist() -> None:
    with pytest.raises(InputError, match=r"task must be one of 'corridor'.*, got 'corridors'"):
        task_named("corridors")


@pytest.mark.parametrize("name", list(TASKS))
def test_a_discount_of_ones_own_reaches_the_world(name: str) -> None:
    for discount in (0.5, 1.0):
        env = task_named(name).make(discount)
        _, info = env.reset(seed=0)
        action = env.action_space.sample(info["action_mask"])
        _, reward, _, _, info = env.step(action)
        discounted = info.get("discounted_reward", reward)
        env.close()

        assert env.unwrapped.discount == discount  # type: ignore[attr-defined]  # a World
        if discount == 1.0:
            assert discounted == reward
        elif name.startswith("keepaway"):
            # A reward of 1 per cycle, 1 + 1/2 + 1/4 + ...
            assert discounted == pytest.approx(2.0 - 2.0 ** (1.0 - info["duration"]))
        elif name != "corridor":
            # All of it is earned by the last of the steps, which take a hundredth of a second.
            assert discounted == pytest.approx(reward * 0.5 ** (info["duration"] - 0.01))


def test_a_discount_out_of_range_is_refused() -> None:
    with pytest.raises(
        InputError, match=r"discount must be a number of at least 0 and of at most 1, got 1.5"
    ):
        task_named("corridor").make(1.5)
