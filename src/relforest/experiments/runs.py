"""The run folders of ``relforest learn``, resumed after any interruption.

A run folder holds ``run.json`` (what was asked for, versions, seed; written first), what
`relforest.runs.store` describes, and two pictures. With several runs, each has such a folder, and
``run.json`` and the pictures are in the folder around them. Runs are learned by worker processes, an
iteration at a time; only this process writes.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager, ExitStack, nullcontext
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, TypeAlias, final

from relforest.experiments.run_config import RunConfig
from relforest.experiments.run_pictures import draw_runs
from relforest.runs.learner import Row, Run, Seconds, advance
from relforest.runs.manifest import checked_folder, held
from relforest.runs.store import RunStore, iterations_of
from relforest.support.parallel import checked_jobs, may_leave_machine, one_blas_thread, run_tasks
from relforest.support.progress import part

OnIteration: TypeAlias = Callable[[int, Row, Seconds], None]
_Task: TypeAlias = tuple[RunConfig, int, Run[Any] | None, int]


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
        Called as ``on_iteration(run, row, seconds)`` after each new iteration of each run, once it is on
        disk: `row` is a line of ``metrics.jsonl``, `seconds` the time of each step.

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
    runs = [RunInFolder(config, number, path) for number, path in enumerate(config.folders(folder))]
    with ExitStack() as locks:
        if len(runs) > 1:
            locks.enter_context(
                held(folder, config.manifest(), is_finished=lambda: all(run.is_finished for run in runs))
            )
        for run in runs:
            locks.enter_context(run.held())
        learn_in_folders(runs, n_jobs=n_jobs, on_iteration=on_iteration)
        draw_runs(config, folder)
    return [run.folder for run in runs]


@final
@dataclass(frozen=True, slots=True)
class RunInFolder:
    """One of the runs of a configuration, and its folder."""

    config: RunConfig
    number: int
    folder: Path

    @property
    def is_finished(self) -> bool:
        """Whether it has all its iterations."""
        return iterations_of(self.folder) >= self.config.iterations

    @property
    def source(self) -> Path | None:
        """The folder of the run that it begins with."""
        return None if self.config.source is None else self.config.source.folder

    def held(self) -> AbstractContextManager[None]:
        """Lock the folder for this run."""
        return held(self.folder, self.config.manifest(self.number), is_finished=lambda: self.is_finished)


def learn_in_folders(
    runs: Sequence[RunInFolder],
    *,
    n_jobs: int = 1,
    on_iteration: OnIteration | None = None,
) -> None:
    """Learn or resume runs in folders that the caller holds; see `learn_runs`."""
    left: list[tuple[RunInFolder, RunStore[Any]]] = []
    progress: list[Run[Any] | None] = []
    for run in runs:
        learner = run.config.learner(run.number)
        store = RunStore(run.folder, learner)
        # Finished runs are restored too, but not kept in memory.
        before = store.resume()
        if before is None and run.source is not None:
            # A worker on another machine does not have the run that this one begins with.
            before = Run(learner.start(), ())
        if before is None or before.iteration < run.config.iterations:
            left.append((run, store))
            progress.append(before)
    # Of a single run, candidate trees are learned at the same time.
    n_threads = n_jobs if len(left) == 1 else 1
    if n_jobs != 1 and len(left) > 1 and not may_leave_machine():
        warm_up(left[0][0].config)

    def commit(task: int, result: tuple[Run[Any], Seconds]) -> _Task | None:
        (run, store), (after, seconds) = left[task], result
        store.write(after, seconds)
        if on_iteration is not None:
            on_iteration(run.number, dict(after.metrics[-1]), seconds)
        is_finished = after.iteration >= run.config.iterations
        return None if is_finished else (run.config, run.number, after, n_threads)

    run_tasks(
        _advance,
        [(run.config, run.number, was, n_threads) for (run, _), was in zip(left, progress, strict=True)],
        n_jobs=n_jobs,
        prefer="processes",
        then=commit,
    )


def warm_up(config: RunConfig) -> None:
    """Compile everything that learning needs, so that processes started later find it in the cache."""
    learner = replace(config, episodes=20, test_episodes=1, seed=0).learner(0)
    with part("first a small run"), one_blas_thread():
        advance(learner, advance(learner, None)[0])


def _advance(
    config: RunConfig, number: int, progress: Run[Any] | None, n_jobs: int
) -> tuple[Run[Any], Seconds]:
    """Return one of the runs after its next iteration, in any process."""
    with part(f"run {number}") if config.runs > 1 else nullcontext():
        return advance(config.learner(number, n_jobs=n_jobs), progress)
