"""One run, or one hand-made policy -> rows: task, condition, run, where it played, episodes, reward.

For runs, there are also the mean reward of the last batch of training, and the leaves of all trees; for the
last policy the share of the test episodes in which it was paid.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from operator import methodcaller
from pathlib import Path
from typing import TYPE_CHECKING, Final, TypeAlias, cast

import numpy as np
from numpy.typing import NDArray

from relforest.experiments.blocks.episodes import play
from relforest.experiments.learned_policies import AgentPolicy, learned_policy
from relforest.experiments.learning.settings import (
    ARCH,
    BUDGETS,
    KEEPAWAY,
    LARGER,
    LEARNERS,
    OURS,
    LearningSetting,
)
from relforest.experiments.methods import METHODS
from relforest.experiments.run_config import RunConfig
from relforest.experiments.runs import RunInFolder
from relforest.experiments.study import Context, Unavailable
from relforest.experiments.table import Row
from relforest.experiments.tasks import task_named
from relforest.rl.fitted.settings import Source
from relforest.rl.rollout import choices, reset_seed, rollout
from relforest.runs.store import metrics_of
from relforest.support.rng import seed_sequence, stream
from relforest.worlds.blocks.env import BlocksEnv

if TYPE_CHECKING:
    from relforest.worlds.environment import WorldEnv

_TESTS: Final = 1_000_000
# How many times as many episodes tell how good a policy is in the end.
_MORE: Final = 5

Change: TypeAlias = Callable[[AgentPolicy], AgentPolicy]


_CHANGES: Final[Mapping[str, Mapping[str, Change]]] = {
    KEEPAWAY: {f", {n} questions": methodcaller("with_questions", n) for n in BUDGETS},
    ARCH: {", without search": partial(replace, search=None)},
}
"""Task -> what else is tested in the end, by what is added to the name of `OURS`."""


def learned(setting: LearningSetting, context: Context) -> RunInFolder | None:
    """Return the run that a setting is about; None for a hand-made policy."""
    if not setting.episodes:
        return None
    choice = LEARNERS[setting.condition]
    rpi = replace(task_named(setting.task).settings, **choice.rpi) if choice.rpi else None
    config = RunConfig(
        setting.task,
        method=choice.method,
        episodes=setting.episodes,
        iterations=setting.iterations,
        test_episodes=setting.tests,
        runs=setting.runs,
        seed=_seed_of(setting.condition, context.seed),
        rpi=rpi,
        discount=choice.discount,
        source=None if choice.source is None else Source(_folder(choice.source, setting.run, context)),
    )
    folder = _folder(setting.condition, setting.run, context)
    return RunInFolder(config, setting.run, folder)


def unavailable(settings: Sequence[LearningSetting]) -> Mapping[LearningSetting, Unavailable]:
    """Return the settings whose learner needs a package that is not installed."""
    found = {}
    for setting in settings:
        method = METHODS[LEARNERS[setting.condition].method] if setting.episodes else None
        if method is not None and method.is_missing:
            reason = f"{method.needs} is not installed: install the extra 'relforest[bench]'."
            found[setting] = Unavailable(setting.condition, reason)
    return found


def compute(setting: LearningSetting, context: Context) -> list[Row]:
    """Return a row per iteration but the last, and one for each task that is played in the end."""
    head: Row = {"task": setting.task, "condition": setting.condition, "run": setting.run}
    run = learned(setting, context)
    rows: list[Row] = []
    last: Row = {"train": None, "leaves": None}
    for row in () if run is None else metrics_of(run.folder)[: setting.iterations + 1]:
        last = {"train": row["train_reward"], "leaves": row["leaves"]}
        if (number := int(row["iteration"])) < setting.iterations:
            where: Row = {"played": setting.task, "episodes": number * setting.episodes}
            rows.append({**head, **where, "reward": row["test_reward"], **last, "paid": None})
    ends: list[tuple[str, str, Change]] = [
        (task, "", replace) for task in (setting.task, *LARGER[: setting.others])
    ]
    if setting.condition == OURS:
        ends += [(setting.task, name, change) for name, change in _CHANGES.get(setting.task, {}).items()]
    for task, name, change in ends:
        rewards = _rewards(task, setting, run, context, change)
        rows.append(
            {
                **head,
                "condition": setting.condition + name,
                "played": task,
                "episodes": setting.iterations * setting.episodes,
                "reward": float(rewards.mean()),
                **last,
                "paid": float((rewards > 0.0).mean()),
            }
        )
    return rows


def _rewards(
    task: str, setting: LearningSetting, run: RunInFolder | None, context: Context, change: Change
) -> NDArray[np.float64]:
    """Return the rewards of the last test episodes."""
    env = task_named(task).make()
    seed = stream(seed_sequence(context.seed), _TESTS, setting.run)
    world, tests = env.unwrapped, _MORE * setting.tests
    if run is not None:
        policy = learned_policy(run.folder, env)
        policy = change(policy) if isinstance(policy, AgentPolicy) else policy
        rewards = rollout(env, policy, tests, seed).episode_rewards
    elif isinstance(world, BlocksEnv):
        # These policies stop when they have reached what they wanted.
        episodes = ((reset_seed(seed, number), choices(seed, number)) for number in range(tests))
        rewards = np.array([dict(play(world, setting.condition, *each))["total"] for each in episodes])
    else:
        hand_made = cast("WorldEnv", world).policies[setting.condition]
        rewards = rollout(env, hand_made, tests, seed).episode_rewards
    return rewards


def _folder(condition: str, run: int, context: Context) -> Path:
    return context.folder / "runs" / condition / f"run-{run:02d}"


def _seed_of(condition: str, seed: int) -> int:
    """Return the seed of a condition: an integer, so that ``relforest learn --seed`` can repeat its runs."""
    number = list(LEARNERS).index(condition)
    return int(stream(seed_sequence(seed), number).generate_state(1, np.uint32)[0])
