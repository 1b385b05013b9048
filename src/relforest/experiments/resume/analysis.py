"""Table -> how many killed runs ended with the files of the uninterrupted one."""

from __future__ import annotations

from collections.abc import Mapping

from matplotlib.figure import Figure

from relforest.experiments.claims import Claim, Findings
from relforest.experiments.resume.run import LONGEST
from relforest.experiments.table import Table, aligned


def summarize(table: Table) -> Findings:
    """List every moment, and claim for every variant that no file differs and no process survives."""
    parts, claims = [], []
    for variant in map(str, table.distinct("variant")):
        own = table.where(variant=variant)
        rows = [
            (
                f"{row['fraction']:.3f}",
                f"{row['seconds']:.2f}",
                str(row["signal"]),
                "yes" if row["alive"] else "no",
                str(row["survivors"]),
                str(row["iterations"]),
                str(row["files"]),
                "yes" if row["identical"] else f"NO: {row['differing']}",
            )
            for row in own.rows
        ]
        header = (
            *("killed at", "seconds", "signal", "running", "survivors"),
            *("iterations by then", "files", "identical in the end"),
        )
        parts.append(f"{variant}\n" + aligned(header, rows))
        differing = len(own) - own.numbers("identical").sum()
        claims.append(
            Claim(f"{variant}: runs that ended differently, of {len(own)}", float(differing), high=0.0)
        )
        surviving = float(own.numbers("survivors").sum())
        claims.append(Claim(f"{variant}: processes left after {LONGEST:g} s", surviving, high=0.0))
    title = (
        "relforest learn killed and started again: all files except clock times compared with those of an\n"
        "uninterrupted run (killed at: fraction of the duration of that run; running: when it was killed;\n"
        f"survivors: processes still running {LONGEST:g} s later)"
    )
    return Findings("\n\n".join((title, *parts)), tuple(claims))


def figures(table: Table) -> Mapping[str, Figure]:  # noqa: ARG001 - every study has this function
    """Return no figure: the table says it all."""
    return {}
