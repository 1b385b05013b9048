"""A variant -> for each moment whether the killed and resumed run left the files of the uninterrupted one."""

from __future__ import annotations

import filecmp
import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import Final

from relforest.experiments.resume.settings import ResumeSetting
from relforest.experiments.run_metrics import iterations_of
from relforest.experiments.study import Place
from relforest.experiments.table import Row
from relforest.support.errors import RelforestError, RunFolderError
from relforest.support.locks import FolderLock
from relforest.support.rng import generator

TASK: Final = "corridor"

# Clock times, and the lock; every other file must be the same.
_LOCK: Final = ".lock"
_MAY_DIFFER: Final = {"timings.jsonl", _LOCK}
_PATIENCE: Final = 10.0


def compute(setting: ResumeSetting, place: Place) -> list[Row]:
    """Return a row per moment.

    Its columns are variant, moment, fraction, seconds, alive, iterations, files, differing, identical.
    ``fraction`` and ``seconds`` say when the run was killed first, ``alive`` whether it was still running
    then, ``iterations`` how many its runs had completed; seconds and iterations depend on the machine.
    """
    folder = place.folder / "runs" / f"{place.index:02d}"
    # An earlier attempt at this setting may have been interrupted: its durations would mean nothing.
    shutil.rmtree(folder, ignore_errors=True)
    if setting.moments > 1:
        _finish(setting, folder / "warm-up", place.seed, setting.jobs)
    begin = time.perf_counter()
    _finish(setting, folder / "uninterrupted", place.seed, setting.jobs)
    duration = time.perf_counter() - begin
    draws = generator(place.stream).random((setting.moments, setting.kills))
    rows: list[Row] = []
    for moment in range(setting.moments):
        out = folder / f"killed-{moment:02d}"
        fraction = (moment + float(draws[moment, 0])) / setting.moments
        alive = kill_after(command(setting, out, place.seed, setting.jobs), fraction * duration)
        await_locks(out)
        iterations = sum(max(iterations_of(path), 0) for path in _run_folders(setting, out))
        for again in draws[moment, 1:]:
            kill_after(command(setting, out, place.seed, setting.resumed_jobs), float(again) * duration)
            await_locks(out)
        _finish(setting, out, place.seed, setting.resumed_jobs)
        same, different = compare(folder / "uninterrupted", out)
        rows.append(
            {
                "variant": setting.title,
                "moment": moment,
                "fraction": fraction,
                "seconds": fraction * duration,
                "alive": alive,
                "iterations": iterations,
                "files": len(same) + len(different),
                "differing": " ".join(different),
                "identical": not different,
            }
        )
    return rows


def command(setting: ResumeSetting, out: Path, seed: int, jobs: int) -> list[str]:
    """Return the command line of a variant."""
    options = {
        "episodes": setting.episodes,
        "iterations": setting.iterations,
        "runs": setting.runs,
        "jobs": jobs,
        "seed": seed,
        "out": out,
    }
    words = [word for name, value in options.items() for word in (f"--{name}", str(value))]
    start = "import sys; from relforest.cli.app import main; sys.exit(main())"
    return [sys.executable, "-c", start, "learn", TASK, *words]


def kill_after(words: list[str], seconds: float) -> bool:
    """Start a command, and kill it and all processes that it has started after a while.

    Returns
    -------
    bool
        Whether it was still running.
    """
    with subprocess.Popen(  # noqa: S603 - our own command line
        words, start_new_session=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    ) as process:
        try:
            process.wait(timeout=seconds)
        except subprocess.TimeoutExpired:
            alive = True
        else:
            alive = False
        with suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
    return alive


def await_locks(out: Path) -> None:
    """Wait for killed workers, which end a moment after their parent and hold their locks until then."""
    limit = time.monotonic() + _PATIENCE
    for lock in sorted(out.rglob(_LOCK)):
        while True:
            try:
                with FolderLock(lock.parent):
                    break
            except RunFolderError:
                if time.monotonic() > limit:
                    raise
                time.sleep(0.02)


def compare(folder: Path, other: Path) -> tuple[list[str], list[str]]:
    """Return the names of the files that are the same in two folders, and of those that are not."""
    names = sorted({name for root in (folder, other) for name in _files(root)})
    same = [
        name
        for name in names
        if (folder / name).exists()
        and (other / name).exists()
        and filecmp.cmp(folder / name, other / name, shallow=False)
    ]
    return same, [name for name in names if name not in same]


def _finish(setting: ResumeSetting, out: Path, seed: int, jobs: int) -> None:
    words = command(setting, out, seed, jobs)
    done = subprocess.run(words, capture_output=True, text=True, check=False)  # noqa: S603 - our own command line
    if done.returncode != 0:
        raise RelforestError(
            f"relforest learn failed in {out} with exit status {done.returncode}:\n{done.stderr[-2000:]}"
        )


def _run_folders(setting: ResumeSetting, out: Path) -> list[Path]:
    return [out] if setting.runs == 1 else [out / f"run-{number:02d}" for number in range(setting.runs)]


def _files(folder: Path) -> Iterator[str]:
    for path in folder.rglob("*"):
        if path.is_file() and path.name not in _MAY_DIFFER:
            yield path.relative_to(folder).as_posix()
