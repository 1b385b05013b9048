"""Whether SMRF trees recover known relational concepts, and carry them over to larger scenes.

`settings` holds the concepts and thresholds, `run` learns a tree and tests it, `analysis` turns the table
into findings and a figure. The question, the command and the result seen stand in ``README.md``.
"""

from __future__ import annotations

from relforest.experiments.concepts.analysis import figures, summarize
from relforest.experiments.concepts.run import compute
from relforest.experiments.concepts.settings import SETTINGS, SMOKE

__all__ = ["SETTINGS", "SMOKE", "compute", "figures", "summarize"]
