"""Runs of the benchmark's own learner, Sarsa with tile coding."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from time import perf_counter
from typing import Any, Final

from relforest.experiments.keepaway_team import benchmark_team, frozen, play_episodes_with
from relforest.experiments.run_config import RunConfig
from relforest.experiments.sarsa_folder import (
    read_agents,
    read_metrics,
    tidy,
    write_iteration,
)
from relforest.rl.checkpoint import TIMINGS
from relforest.support.files import append_line
from relforest.support.locks import FolderLock
from relforest.support.progress import part
from relforest.support.rng import seed_sequence, stream
from relforest.worlds.keepaway.server.options import KeepawayOptions

_TRAINING: Final = 0
_TESTING: Final = 1
_AGENTS: Final = 2


def learn_sarsa_run(
    config: RunConfig,
    run: int,
    folder: Path,
    report: Callable[[dict[str, Any], dict[str, float]], None] | None = None,
) -> None:
    """Learn one of the runs of a configuration, or resume it, in its own folder.

    Rewards are durations of episodes in cycles. Random streams of games and agents are named by the number of
    the iteration, so an interrupted run continues without a difference.

    Parameters
    ----------
    config : RunConfig
        Of a keepaway task.
    run : int
        Number of the run.
    folder : path
    report : callable, optional
        Called as ``report(row, seconds)`` after each iteration, once it is safe on disk.

    Raises
    ------
    RunFolderError
        If the folder is in use.
    ModelFormatError
        If a file in it is damaged.
    """
    rules = KeepawayOptions(**config.definition.options)
    test_episodes = config.episodes if config.test_episodes is None else config.test_episodes
    with FolderLock(folder):
        metrics = read_metrics(folder)
        tidy(folder, metrics)
        for number in range(len(metrics), config.iterations + 1):
            seed = stream(seed_sequence(config.seed), run, number)
            begin = perf_counter()
            if number == 0:
                trained = None
                team = benchmark_team(
                    rules, config.sarsa, shared=config.is_shared, random_state=stream(seed, _AGENTS)
                )
            else:
                team = read_agents(folder, number - 1, stream(seed, _AGENTS))
                with part(f"iteration {number}, training"):
                    played = play_episodes_with(team, rules, config.episodes, stream(seed, _TRAINING))
                trained = float(played.mean())
            learned = perf_counter()
            seed_of_tests = stream(seed, _TESTING)
            with part(f"iteration {number}, testing"):
                tested = play_episodes_with(frozen(team, seed_of_tests), rules, test_episodes, seed_of_tests)
            measured = perf_counter()
            row = {
                "iteration": number,
                "test_reward": float(tested.mean()),
                "train_reward": trained,
                "trees": 0,
                "leaves": 0,
            }
            metrics = [*metrics, row]
            write_iteration(folder, team, metrics)
            seconds = {
                "learning": learned - begin,
                "testing": measured - learned,
                "writing": perf_counter() - measured,
            }
            line = {"iteration": number, **{name: round(time, 6) for name, time in seconds.items()}}
            append_line(folder / TIMINGS, json.dumps(line))
            if report is not None:
                report(dict(row), seconds)
