"""Table -> the tables of the source with ours beside them, and the claims."""

from __future__ import annotations

from relforest.experiments.claims import Findings
from relforest.experiments.mil.bounds import exceptions, verdicts
from relforest.experiments.mil.cells import Results
from relforest.experiments.mil.settings import SETTINGS
from relforest.experiments.mil.tables import sheets
from relforest.experiments.table import Table


def summarize(table: Table) -> Findings:
    """Lay the results out beside the source's, and hold them against the bounds."""
    results = Results.of(table)
    laid_out = list(sheets(results))
    parts = [sheet.to_text() for sheet in laid_out]
    lines = list(exceptions(results))
    if lines:
        parts.append("\n".join(["Known differences from the source, without a claim", *lines]))
    markdown = "\n\n".join(sheet.to_markdown() for sheet in laid_out)
    limit = min(setting.cpu_limit for setting in SETTINGS)
    return Findings.of("\n\n".join(parts), verdicts(results, limit), {"tables.md": f"{markdown}\n"})
