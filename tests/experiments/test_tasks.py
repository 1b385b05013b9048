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
