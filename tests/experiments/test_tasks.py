from __future__ import annotations

import pytest

from relforest.experiments.tasks import TASKS, task_named
from relforest.smdp import World
from relforest.support.errors import InputError
from relforest.worlds import ENVIRONMENT_IDS
from relforest.worlds.blocks.arch_policies import TrainerPolicy
from relforest.worlds.blocks.env import BlocksEnv
from relforest.worlds.blocks.policies import RandomPolicy
from relforest.worlds.blocks.samplers import SAMPLERS


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


def test_blocks_are_explored_as_in_the_source() -> None:
    for name in ("high-towers", "color-grouping"):
        env = task_named(name).make()
        practice = task_named(name).practice(env)
        assert practice.training is None
        assert practice.explorer == practice.beginner == RandomPolicy((0.75, 0.25))


def test_the_arch_is_practised_where_it_is_tested_with_a_trainer() -> None:
    task = task_named("arch")
    env = task.make()
    practice, world = task.practice(env), env.unwrapped
    assert practice.training is None
    assert isinstance(world, BlocksEnv)
    assert (world.task.pays, world.task.sampler) == ("end", SAMPLERS["test"])
    assert isinstance(practice.explorer, TrainerPolicy)
    assert practice.explorer.world is world


def test_the_source_pays_only_for_what_is_claimed_in_training() -> None:
    task = task_named("arch-done")
    env = task.make(0.5)
    practice = task.practice(env, 0.5)
    tested, training = env.unwrapped, practice.training and practice.training.unwrapped
    assert isinstance(tested, BlocksEnv)
    assert isinstance(training, BlocksEnv)
    assert (tested.task.pays, training.task.pays) == ("end", "done")
    assert (tested.task.sampler, training.task.sampler) == (SAMPLERS["test"], SAMPLERS["training"])
    assert (tested.discount, training.discount) == (0.5, 0.5)
    assert isinstance(practice.explorer, TrainerPolicy)
    # It plans in the world where it acts.
    assert practice.explorer.world is training
    assert practice.beginner == RandomPolicy((0.9 * 0.25, 0.9 * 0.75, 0.1))
    found = practice.to_dict(env)["practice"]
    assert found["training"]["sampler"] == "training"
    assert (found["explorer"], found["search"]) == ("TrainerPolicy", {"width": 5, "rounds": 2})


@pytest.mark.parametrize("name", ["corridor", "keepaway"])
def test_other_tasks_are_practised_by_random_play(name: str) -> None:
    env = task_named(name).make()
    assert task_named(name).practice(env).to_dict(env) == {}


def test_a_discount_out_of_range_is_refused() -> None:
    with pytest.raises(
        InputError, match=r"discount must be a number of at least 0 and of at most 1, got 1.5"
    ):
        task_named("corridor").make(1.5)
