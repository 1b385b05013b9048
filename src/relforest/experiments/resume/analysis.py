"""Table -> how many killed runs ended with the files of the uninterrupted one."""

from __future__ import annotations

from collections.abc import Mapping

from matplotlib.figure import Figure

from relforest.experiments.claims import Claim, Findings
from relforest.experiments.table import Table, aligned


def summarize(table: Table) -> Findings:
    """List every moment, and claim for every variant that no file differs."""
    parts, claims = [], []
    for variant in map(str, table.distinct("variant")):
        own = table.where(variant=variant)
        rows = [
            (
                f"{row['fraction']:.3f}",
                f"{row['seconds']:.2f}",
                "yes" if row["alive"] else "no",
                str(row["iterations"]),
                str(row["files"]),
                "yes" if row["identical"] else f"NO: {row['differing']}",
            )
            for row in own.rows
        ]
        header = ("killed at", "seconds", "running", "iterations by then", "files", "identical in the end")
        parts.append(f"{variant}\n" + aligned(header, rows))
        differing = len(own) - own.numbers("identical").sum()
        claims.append(
            Claim(f"{variant}: runs that ended differently, of {len(own)}", float(differing), high=0.0)
        )
    title = (
        "relforest learn killed with SIGKILL, its workers included, and started again: all files but clock\n"
        "times compared with those of an uninterrupted run (killed at: fraction of the duration of that run)"
    )
    return Findings("\n\n".join((title, *parts)), tuple(claims))


def figures(table: Table) -> Mapping[str, Figure]:  # noqa: ARG001 - every study has this function
    """Return no figure: the table says it all."""
    return {}
