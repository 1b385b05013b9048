"""The run folders of ``relforest learn``, resumed after any interruption.

A run folder holds ``run.json`` (configuration, versions, seed; written first), what
`relforest.rl.checkpoint` or, for Sarsa, `relforest.experiments.sarsa_folder` describes, and two pictures.
With several runs, each has such a folder, and ``run.json`` and the pictures are in the folder around them.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, TypeAlias

from relforest.experiments.folders import checked_folder, claimed
from relforest.experiments.run_config import RunConfig
from relforest.experiments.run_metrics import iterations_of, metrics_of
from relforest.experiments.run_pictures import draw_runs
from relforest.experiments.sarsa_runs import learn_sarsa_run
from relforest.experiments.watching import watching
from relforest.rl.rpi import SMRFRPI
from relforest.support.parallel import checked_jobs, run_tasks
from relforest.support.progress import part
from relforest.support.rng import seed_sequence, stream

OnIteration: TypeAlias = Callable[[int, dict[str, Any], dict[str, float]], None]


def learn_runs(
    config: RunConfig,
    out: str | os.PathLike[str],
    *,
    n_jobs: int = 1,
    on_iteration: OnIteration | None = None,
) -> list[Path]:
    """Learn, or resume, until every run has all its iterations; then draw the pictures.

    Parameters
    ----------
    config : RunConfig
    out : path
        Where the files go. Runs of the same configuration that it contains are resumed, with the same result
        as without an interruption; finished ones are left alone, and more iterations extend them.
    n_jobs : int
        Runs learned at the same time, in processes, or candidate trees of a single run, in threads; -1 = all
        cores. The result does not depend on it.
    on_iteration : callable, optional
        Called as ``on_iteration(run, row, seconds)`` after each new iteration of each run: `row` is a line of
        ``metrics.jsonl``, `seconds` the time of each step. Iterations of other processes arrive with a delay
        and without seconds.

    Returns
    -------
    list of path
        The folder of each run.

    Raises
    ------
    InputError
        If `n_jobs` is neither -1 nor at least 1, or `out` cannot be the name of a folder.
    RunFolderError
        If a folder cannot be written to, is in use, is neither empty nor a run folder,
        belongs to another configuration, or is damaged.
    """
    checked_jobs(n_jobs)
    folder = checked_folder(out)
    folders = config.folders(folder)
    if config.runs == 1:
        learn_run(config, 0, folder, n_jobs=n_jobs, on_iteration=on_iteration)
        # Learning locks the folder itself; drawing must not meet another process either.
        with claimed(folder, config.identity(), is_finished=lambda: _is_finished(config, folders)):
            draw_runs(config, folder)
        return folders
    with claimed(folder, config.identity(), is_finished=lambda: _is_finished(config, folders)):
        _learn_many(config, folders, n_jobs, on_iteration)
        draw_runs(config, folder)
    return folders


def learn_run(
    config: RunConfig,
    run: int,
    folder: Path,
    *,
    n_jobs: int = 1,
    on_iteration: OnIteration | None = None,
) -> None:
    """Learn one of the runs of a configuration in its own folder, without drawing pictures.

    Parameters and errors are those of `learn_runs`, `run` is its number.
    """
    report = None
    if on_iteration is not None:
        announce = on_iteration

        def report(row: dict[str, Any], seconds: dict[str, float]) -> None:
            announce(run, row, seconds)

    identity = config.identity(run)
    with claimed(folder, identity, is_finished=lambda: _is_finished(config, [folder])):
        pass
    if not config.is_relational:
        learn_sarsa_run(config, run, folder, report)
        return
    agent = SMRFRPI(
        config.make(),
        settings=config.settings,
        random_state=stream(seed_sequence(config.seed), run),
        n_jobs=n_jobs,
        checkpoint=folder,
    )
    agent.learn(config.iterations, config.episodes, test_episodes=config.test_episodes, on_iteration=report)


def warm_up(config: RunConfig) -> None:
    """Compile everything that learning needs, so that processes started later find it in the cache."""
    with part("first a small run"):
        if config.is_relational:
            agent = SMRFRPI(config.make(), settings=config.settings, random_state=0)
            agent.learn(1, 20, test_episodes=1)
        else:
            with TemporaryDirectory() as folder:
                learn_sarsa_run(replace(config, episodes=1, iterations=1), 0, Path(folder))


def _learn_many(
    config: RunConfig, folders: list[Path], n_jobs: int, on_iteration: OnIteration | None
) -> None:
    tasks = list(enumerate(folders))
    unfinished = [(run, folder) for run, folder in tasks if not _is_finished(config, [folder])]
    if n_jobs == 1 or len(unfinished) < 2:
        for run, folder in tasks:
            _learn_named(config, run, folder, on_iteration)
        return
    warm_up(config)
    with watching(_announcer(dict(unfinished), on_iteration)):
        run_tasks(
            _learn_named,
            [(config, run, folder, None) for run, folder in tasks],
            n_jobs=n_jobs,
            prefer="processes",
        )


def _learn_named(config: RunConfig, run: int, folder: Path, on_iteration: OnIteration | None) -> None:
    with part(f"run {run}"):
        learn_run(config, run, folder, on_iteration=on_iteration)


def _is_finished(config: RunConfig, folders: list[Path]) -> bool:
    return all(iterations_of(folder) >= config.iterations for folder in folders)


def _announcer(folders: dict[int, Path], on_iteration: OnIteration | None) -> Callable[[], None]:
    """Return a function that announces the iterations completed since its last call."""
    if on_iteration is None:
        return lambda: None
    on_new = on_iteration
    known = {run: iterations_of(folder) for run, folder in folders.items()}

    def announce() -> None:
        for run, folder in folders.items():
            if iterations_of(folder) > known[run]:
                new = metrics_of(folder)[known[run] + 1 :]
                known[run] += len(new)
                for row in new:
                    on_new(run, row, {})

    return announce
