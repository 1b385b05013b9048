"""What compiling the kernels that ``make run`` needs costs, with an empty cache and with a full one."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

from table import Cell, Table

PROBE = Path(__file__).resolve().parent / "compile_probe.py"


def probe(cache: str) -> dict[str, float]:
    """Run the probe in a new process with a cache folder of its own."""
    environment = os.environ | {"NUMBA_CACHE_DIR": cache, "NUMBA_DISABLE_JIT": "0"}
    done = subprocess.run(  # noqa: S603 - our own script
        [sys.executable, str(PROBE)], env=environment, capture_output=True, text=True, check=True
    )
    measured: dict[str, float] = json.loads(done.stdout.splitlines()[-1])
    return measured


def row(name: str, measured: dict[str, float]) -> tuple[Cell, ...]:
    """Return a row of the table; compiling is what the first job took longer than the second."""
    compiling = measured["first"] - measured["second"]
    return name, measured["import"], compiling, measured["second"]


def run() -> Table:
    """Measure with an empty and with a full cache."""
    with tempfile.TemporaryDirectory() as cache:
        rows = (row("empty", probe(cache)), row("full", probe(cache)))
    return Table(
        "compile",
        "Aim: compiling at most 60 s with an empty cache, 3 s with a full one.",
        ("cache", "import s", "compile or load s", "job itself s"),
        rows,
    )


if __name__ == "__main__":
    run().report()
