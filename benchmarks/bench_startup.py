"""What importing the library and asking the command line for help cost, beside importing other packages."""

from __future__ import annotations

import resource
import subprocess
import sys
from statistics import median

from table import Cell, Table

PEER = "import sklearn.svm, numba, matplotlib.pyplot, gymnasium, pyarrow"
REPEATS = 5
COMMANDS = {
    "import of other packages": ["-c", PEER],
    "import relforest": ["-c", "import relforest"],
    "relforest --version": ["-m", "relforest", "--version"],
    "relforest --help": ["-m", "relforest", "--help"],
    "relforest learn --help": ["-m", "relforest", "learn", "--help"],
    "relforest fit --help": ["-m", "relforest", "fit", "--help"],
    "relforest fti": ["-m", "relforest", "fti"],
    "relforest learn maze": ["-m", "relforest", "learn", "maze"],
}


def cpu_seconds(arguments: list[str]) -> float:
    """Return the CPU time of a Python process."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([sys.executable, *arguments], capture_output=True, check=False)  # noqa: S603 - our own
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime


def run() -> Table:
    """Measure all commands in turn, several times, so that a change of the machine's pace concerns all."""
    rounds = [{name: cpu_seconds(arguments) for name, arguments in COMMANDS.items()} for _ in range(REPEATS)]
    seconds = {name: median(measured[name] for measured in rounds) for name in COMMANDS}
    peer = seconds["import of other packages"]
    rows: tuple[tuple[Cell, ...], ...] = tuple((name, spent, spent / peer) for name, spent in seconds.items())
    return Table(
        "startup",
        "Other packages: scikit-learn's SVMs, Numba, Matplotlib's pyplot, Gymnasium and PyArrow. "
        "At most 0.25 for commands and 0.5 for the library; the aim is 0.1.",
        ("command", "CPU s", "ratio"),
        rows,
    )


if __name__ == "__main__":
    run().report()
