"""A variant -> for each moment, whether the killed and resumed run has the files of an uninterrupted one."""

from __future__ import annotations

import filecmp
import os
import shutil
import signal
import subprocess
import time
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Final, final

from relforest.experiments.resume.settings import PARENT, ResumeSetting
from relforest.experiments.run_config import RunConfig
from relforest.experiments.study import Context
from relforest.experiments.table import Row
from relforest.runs.store import iterations_of
from relforest.support.errors import InputError, RelforestError
from relforest.support.files import read_input
from relforest.support.locks import LOCK
from relforest.support.progress import report
from relforest.support.rng import generator
from relforest.support.workers import start

LONGEST: Final = 2.0
"""Seconds after which no process of a killed run may be left."""

# A child process inherits ignored signals, for example from a worker process or from nohup.
_RELFOREST: Final = """
import signal
signal.signal(signal.SIGINT, signal.default_int_handler)
signal.signal(signal.SIGHUP, signal.SIG_DFL)
from relforest.cli.app import main
sys.exit(main())
"""
_LOOK_SECONDS: Final = 0.05

# Clock times, and the lock; every other file must be the same.
_MAY_DIFFER: Final = {"timings.jsonl", LOCK}


@final
@dataclass(frozen=True, slots=True)
class Kill:
    """A way to end a run: a signal to all of its processes, or to the first one."""

    signal: signal.Signals
    all_processes: bool

    @property
    def name(self) -> str:
        """The signal and its receivers."""
        return f"{self.signal.name} to {'all' if self.all_processes else 'the first'}"


KILLS: Final = (
    Kill(signal.SIGKILL, all_processes=True),
    Kill(signal.SIGKILL, all_processes=False),
    Kill(signal.SIGTERM, all_processes=False),
    Kill(signal.SIGINT, all_processes=True),
    Kill(signal.SIGHUP, all_processes=True),
)
"""The last four: a crash of the first process, a batch system, Ctrl-C, a closed terminal."""


def compute(setting: ResumeSetting, context: Context) -> list[Row]:
    """Return a row per moment.

    Its columns are variant, moment, fraction, seconds, signal, alive, survivors, iterations, files,
    differing, identical. ``fraction`` and ``seconds`` say when the run was killed first, ``signal`` how,
    ``alive`` whether it was still running then, ``survivors`` how many of its processes were still running
    `LONGEST` seconds after any of the kills, ``iterations`` how many iterations its runs had completed;
    seconds and iterations depend on the machine.
    """
    folder = context.folder / "runs" / f"{context.index:02d}"
    # An earlier attempt at this setting may have been interrupted: its durations would mean nothing.
    shutil.rmtree(folder, ignore_errors=True)
    if setting.moments > 1:
        _finish(setting, folder / "warm-up", context.seed, setting.jobs)
    begin = time.perf_counter()
    _finish(setting, folder / "uninterrupted", context.seed, setting.jobs)
    duration = time.perf_counter() - begin
    draws = generator(context.stream).random((setting.moments, setting.kills))
    rows: list[Row] = []
    for moment in range(setting.moments):
        report("runs killed", moment, setting.moments)
        out = folder / f"killed-{moment:02d}"
        fraction = (moment + float(draws[moment, 0])) / setting.moments
        kill = KILLS[1 + moment % (len(KILLS) - 1)] if setting.whom == PARENT else KILLS[0]
        first = command(setting, out, context.seed, setting.jobs)
        alive, survivors = kill_after(first, fraction * duration, kill)
        folders = RunConfig(setting.task, runs=setting.runs).folders(out)
        iterations = sum(max(iterations_of(path), 0) for path in folders)
        for again in draws[moment, 1:]:
            next_one = command(setting, out, context.seed, setting.resumed_jobs)
            survivors += kill_after(next_one, float(again) * duration, kill)[1]
        _finish(setting, out, context.seed, setting.resumed_jobs)
        same, different = compare(folder / "uninterrupted", out)
        if not different:
            shutil.rmtree(out)
        rows.append(
            {
                "variant": setting.title,
                "moment": setting.part * setting.moments + moment,
                "fraction": fraction,
                "seconds": fraction * duration,
                "signal": kill.name,
                "alive": alive,
                "survivors": survivors,
                "iterations": iterations,
                "files": len(same) + len(different),
                "differing": " ".join(different),
                "identical": not different,
            }
        )
    return rows


def command(setting: ResumeSetting, out: Path, seed: int, jobs: int) -> list[str]:
    """Return the arguments of ``relforest`` in a variant."""
    options = {
        "method": setting.method,
        "episodes": setting.episodes,
        "iterations": setting.iterations,
        "runs": setting.runs,
        "jobs": jobs,
        "seed": seed,
        "out": out,
    }
    words = [word for name, value in options.items() for word in (f"--{name}", str(value))]
    return ["learn", setting.task, *words]


def kill_after(arguments: list[str], seconds: float, kill: Kill) -> tuple[bool, int]:
    """Start ``relforest`` and kill it after a while.

    Returns
    -------
    alive : bool
        Whether it was still running.
    survivors : int
        How many of its processes were still running after `LONGEST` seconds and had to be killed.
    """
    with start(
        _RELFOREST,
        arguments,
        start_new_session=True,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    ) as process:
        try:
            process.wait(timeout=seconds)
        except subprocess.TimeoutExpired:
            alive = True
        else:
            alive = False
        with suppress(ProcessLookupError):
            (os.killpg if kill.all_processes else os.kill)(process.pid, kill.signal)
        limit = time.monotonic() + LONGEST
        while (survivors := running(process.pid)) and time.monotonic() < limit:
            time.sleep(_LOOK_SECONDS)
            process.poll()
        with suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
    return alive, survivors


def running(group: int) -> int:
    """Return how many processes of a group are running, zombies not counted."""
    count = 0
    for status in Path("/proc").glob("[0-9]*/stat"):
        # The name of the program stands in parentheses and may hold anything.
        with suppress(InputError):
            state, _, its_group = read_input(status).rpartition(b")")[2].split()[:3]
            count += int(its_group) == group and state != b"Z"
    return count


def compare(folder: Path, other: Path) -> tuple[list[str], list[str]]:
    """Return the names of the files that are equal in two folders, and of those that differ."""
    names = sorted({name for root in (folder, other) for name in _files(root)})
    same, different, missing = filecmp.cmpfiles(folder, other, names, shallow=False)
    return same, sorted([*different, *missing])


def _finish(setting: ResumeSetting, out: Path, seed: int, jobs: int) -> None:
    with start(
        _RELFOREST, command(setting, out, seed, jobs), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE
    ) as process:
        _, errors = process.communicate()
    if process.returncode != 0:
        raise RelforestError(
            f"relforest learn failed in {out} with exit status {process.returncode}:\n"
            f"{errors.decode(errors='replace')[-2000:]}"
        )


def _files(folder: Path) -> Iterator[str]:
    for path in folder.rglob("*"):
        if path.is_file() and path.name not in _MAY_DIFFER:
            yield path.relative_to(folder).as_posix()
