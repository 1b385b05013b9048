"""Running the command line inside the test, and small tables for it."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any, final

import numpy as np
import pyarrow as pa
import pytest
from pyarrow import csv, parquet

from relforest.cli.app import main

N_SCENES = 40
COLUMNS = ("--scene", "pass", "--object", "player", "--attribute", "extent=x")

# What a slow machine, or one that has not compiled the kernels yet, says in between.
_AT_TIMES = re.compile(r"^(compiling, .*|.* \(\d+ s\))\n", re.MULTILINE)


@final
@dataclass(frozen=True, slots=True)
class Outcome:
    """What a command left behind."""

    code: int
    out: str
    err: str


@final
class CommandLine:
    """Runs commands and captures what they print."""

    def __init__(self, capsys: pytest.CaptureFixture[str]) -> None:
        self._capsys = capsys

    def __call__(self, *arguments: object) -> Outcome:
        self._capsys.readouterr()
        try:
            code = main([str(argument) for argument in arguments])
        except SystemExit as exit_:
            code = int(exit_.code or 0)
        printed = self._capsys.readouterr()
        return Outcome(code, printed.out, _AT_TIMES.sub("", printed.err))


def passes(*, n_players: int = 3, seed: int = 0, **columns: list[Any]) -> pa.Table:
    """Passes of a few players; it is completed if a player stands between 0.45 and 0.55.

    Columns: pass (100, 101, ...), player ("p0", ...), x, passer (always "p0"), completed. Others, given as
    one value per row, replace them or are added.
    """
    rng = np.random.default_rng(seed)
    completed = np.arange(N_SCENES) % 2 == 0
    x = rng.uniform(0.0, 0.4, (N_SCENES, n_players))
    x[completed, -1] = rng.uniform(0.45, 0.55, completed.sum())
    table = {
        "pass": np.repeat(np.arange(N_SCENES) + 100, n_players),
        "player": [f"p{number}" for number in range(n_players)] * N_SCENES,
        "x": x.ravel(),
        "passer": ["p0"] * (N_SCENES * n_players),
        "completed": np.repeat(completed, n_players),
    }
    return pa.table(table | columns)


def write(table: pa.Table, path: Path) -> Path:
    """Write a table as the suffix says."""
    if path.suffix == ".csv":
        csv.write_csv(table, path)
    else:
        parquet.write_table(table, path)
    return path
