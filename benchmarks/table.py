"""Tables that are printed and saved."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from relforest.support.files import write_text

RESULTS = Path(__file__).resolve().parent / "results"

Cell = str | int | float


@dataclass(frozen=True, slots=True)
class Table:
    """What one benchmark found: ``name`` is that of its CSV file, ``note`` says what must hold."""

    name: str
    note: str
    columns: tuple[str, ...]
    rows: tuple[tuple[Cell, ...], ...]

    def report(self) -> None:
        """Print the table and save it as ``results/NAME.csv``."""
        print(self)
        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\n")
        writer.writerow(self.columns)
        writer.writerows(self.rows)
        RESULTS.mkdir(exist_ok=True)
        write_text(RESULTS / f"{self.name}.csv", text.getvalue())

    def __str__(self) -> str:
        """Return the table with aligned columns."""
        lines = [self.columns, *([_shown(cell) for cell in row] for row in self.rows)]
        widths = [max(len(line[i]) for line in lines) for i in range(len(self.columns))]
        body = "\n".join(_aligned(line, widths) for line in lines)
        return f"\n{self.name}\n{body}\n{self.note}"


def _aligned(cells: Sequence[str], widths: Sequence[int]) -> str:
    first, *others = zip(cells, widths, strict=True)
    return "  ".join([first[0].ljust(first[1]), *(cell.rjust(width) for cell, width in others)])


def _shown(cell: Cell) -> str:
    return f"{cell:.4g}" if isinstance(cell, float) else str(cell)
