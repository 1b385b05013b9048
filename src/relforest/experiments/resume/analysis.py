"""Table -> how many killed runs ended with the files of the uninterrupted one."""

from __future__ import annotations

from operator import attrgetter
from typing import Final

from relforest.experiments.claims import Claim, Findings
from relforest.experiments.registry import heading
from relforest.experiments.resume.run import LONGEST, compute
from relforest.experiments.resume.settings import SETTINGS, SMOKE
from relforest.experiments.sheets import Sheet
from relforest.experiments.study import Study
from relforest.experiments.table import Table

_TEXT: Final = (
    "relforest learn killed and started again: all files except clock times compared with those of an\n"
    "uninterrupted run (killed at: fraction of the duration of that run; running: when it was killed;\n"
    f"survivors: processes still running {LONGEST:g} s later)"
)
_COLUMNS: Final = {
    "killed at": "fraction",
    "seconds": "seconds",
    "signal": "signal",
    "running": "alive",
    "survivors": "survivors",
    "iterations by then": "iterations",
    "files": "files",
    "identical in the end": "identical",
    "differing": "differing",
}
_FORMATS: Final = {"killed at": ".3f", "seconds": ".2f"}


def summarize(table: Table) -> Findings:
    """List every moment, and claim for every variant that no file differs and no process survives."""
    parts, claims = [], []
    for (variant,), own in table.groups("variant").items():
        rows = [tuple(row[column] for column in _COLUMNS.values()) for row in own.rows]
        parts.append(Sheet(str(variant), {**dict.fromkeys(_COLUMNS, ""), **_FORMATS}, tuple(rows)))
        differing = len(own) - float(own.numbers("identical").sum())
        surviving = float(own.numbers("survivors").sum())
        claims += [
            Claim(f"{variant}: runs that ended differently, of {len(own)}", differing, high=0.0),
            Claim(f"{variant}: processes left after {LONGEST:g} s", surviving, high=0.0),
        ]
    return Findings(_TEXT, tuple(claims), tuple(parts))


STUDY: Final = Study(
    *heading(__package__),
    SETTINGS,
    SMOKE,
    compute,
    summarize,
    compiles=False,
    choices={"methods": attrgetter("name")},
)
