"""Read many damaged files of every format, and count what happens.

    python tests/fuzz_files.py --count 100000 --seed 0 --jobs 2

Only errors of ours are allowed, within `LONGEST` seconds of CPU time. Everything else is a finding: it is
printed with the command that repeats it, and its files are kept with ``--keep``.
"""

from __future__ import annotations

import argparse
import multiprocessing
import resource
import shutil
import signal
import sys
import traceback
import warnings
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from tempfile import TemporaryDirectory
from time import process_time
from typing import Final, final

from fuzz_formats import FORMATS, Format, mutate
from mutations import case_generator
from relforest.support.errors import RelforestError

LONGEST: Final = 5.0
_CHUNK: Final = 2500


class TooSlowError(BaseException):
    """Reading took more CPU time than `LONGEST` seconds."""


@final
@dataclass(frozen=True, slots=True)
class Outcome:
    """What became of some cases of one format."""

    cases: int = 0
    fine: int = 0
    refused: int = 0
    slowest: float = 0.0
    memory: float = 0.0
    findings: tuple[tuple[int, str], ...] = field(default=())

    def __add__(self, other: Outcome) -> Outcome:
        """Return both together."""
        return Outcome(
            self.cases + other.cases,
            self.fine + other.fine,
            self.refused + other.refused,
            max(self.slowest, other.slowest),
            max(self.memory, other.memory),
            self.findings + other.findings,
        )


def run_cases(name: str, seed: int, numbers: Sequence[int], keep: Path | None = None) -> Outcome:
    """Read the numbered cases of a format, each in an empty folder."""
    chosen = FORMATS[name]
    total = Outcome()
    with TemporaryDirectory() as parent:
        valid = _valid_files(chosen, Path(parent) / "valid")
        _write(valid, Path(parent) / "case")
        chosen.read(Path(parent) / "case")
        before = _peak_megabytes()
        for number in numbers:
            files = mutate(valid, chosen, case_generator(name, seed, number))
            outcome = _read_case(chosen, number, files, Path(parent) / "case")
            if outcome.findings and keep is not None:
                _write(files, keep / f"{name.replace(' ', '-')}-{seed}-{number}")
            total += outcome
    return total + Outcome(memory=_peak_megabytes() - before)


def _read_case(chosen: Format, number: int, files: Mapping[str, bytes], folder: Path) -> Outcome:
    shutil.rmtree(folder, ignore_errors=True)
    _write(files, folder)
    fine, refused = 0, 0
    findings: tuple[tuple[int, str], ...] = ()
    begin = process_time()
    try:
        with _time_limit(), warnings.catch_warnings():
            warnings.simplefilter("error")
            chosen.read(folder)
        fine = 1
    except RelforestError:
        refused = 1
    except KeyboardInterrupt:
        raise
    except BaseException as error:  # noqa: BLE001 - whatever it is, it is a finding
        where = traceback.extract_tb(error.__traceback__)[-1]
        ours = [frame for frame in traceback.extract_tb(error.__traceback__) if "relforest" in frame.filename]
        place = ours[-1] if ours else where
        text = f"{type(error).__name__}: {error!s:.200} ({Path(place.filename).name}:{place.lineno})"
        findings = ((number, text),)
    return Outcome(1, fine, refused, process_time() - begin, 0.0, findings)


def _valid_files(chosen: Format, folder: Path) -> dict[str, bytes]:
    folder.mkdir()
    chosen.make(folder)
    files = (path for path in sorted(folder.rglob("*")) if path.is_file() and path.name != ".lock")
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in files}


def _write(files: Mapping[str, bytes], folder: Path) -> None:
    for name, content in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)


@contextmanager
def _time_limit() -> Iterator[None]:
    def stop(*_: object) -> None:
        raise TooSlowError(f"more than {LONGEST:g} s")

    before = signal.signal(signal.SIGPROF, stop)
    signal.setitimer(signal.ITIMER_PROF, LONGEST)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
        signal.signal(signal.SIGPROF, before)


def _peak_megabytes() -> float:
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def fuzz(count: int, seed: int, jobs: int, names: Sequence[str], keep: Path | None) -> dict[str, Outcome]:
    """Share cases among formats and processes."""
    weights = {name: FORMATS[name].weight for name in names}
    tasks = []
    for name in names:
        own = max(round(count * weights[name] / sum(weights.values())), 1)
        tasks += [
            (name, seed, range(begin, min(begin + _CHUNK, own)), keep) for begin in range(0, own, _CHUNK)
        ]
    outcomes = dict.fromkeys(names, Outcome())
    # A new process for every task, so that its peak of memory is its own.
    with multiprocessing.get_context("spawn").Pool(jobs, maxtasksperchild=1) as pool:
        for name, outcome in pool.imap_unordered(_run_task, tasks):
            outcomes[name] += outcome
    return outcomes


def _run_task(task: tuple[str, int, Sequence[int], Path | None]) -> tuple[str, Outcome]:
    return task[0], run_cases(*task)


def table(outcomes: Mapping[str, Outcome]) -> str:
    """Return a line per format."""
    lines = [f"{'format':18}{'files':>8}{'fine':>8}{'refused':>9}{'foreign':>9}{'slowest':>10}{'memory':>10}"]
    for name, found in outcomes.items():
        lines.append(
            f"{name:18}{found.cases:8}{found.fine:8}{found.refused:9}{len(found.findings):9}"
            f"{found.slowest:8.2f} s{found.memory:7.0f} MB"
        )
    return "\n".join(lines)


def main() -> int:
    """Run the command line; the exit code is 1 if anything was found."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--count", type=int, default=10_000, help="cases over all formats")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--jobs", type=int, default=2, help="processes")
    parser.add_argument("--format", choices=FORMATS, action="append", help="only this one; may be repeated")
    parser.add_argument("--case", type=int, help="read only this case of the format, and show its error")
    parser.add_argument("--keep", type=Path, help="folder for the files of findings")
    options = parser.parse_args()
    names = options.format or list(FORMATS)
    if options.case is not None:
        outcomes = {name: run_cases(name, options.seed, [options.case], options.keep) for name in names}
    else:
        outcomes = fuzz(options.count, options.seed, options.jobs, names, options.keep)
    sys.stdout.write(f"{table(outcomes)}\n")
    for name, found in outcomes.items():
        for number, text in found.findings:
            sys.stdout.write(
                f"{text}\n    python tests/fuzz_files.py --format {name!r} --seed {options.seed} "
                f"--case {number}\n"
            )
    return int(any(found.findings for found in outcomes.values()))


if __name__ == "__main__":
    sys.exit(main())
