"""Whether our blocks world is that of the author's simulator, how good hand-made policies are, its speed.

`settings` holds what is dropped, lifted and played and what the author's simulator gave, `run` makes one
measurement with the help of `episodes`, `samples` groups the rows of the table, `analysis` turns them into
findings and `pictures` into figures. The question, the command and the result seen stand in ``README.md``.
"""

from __future__ import annotations

from relforest.experiments.blocks.analysis import summarize
from relforest.experiments.blocks.pictures import figures
from relforest.experiments.blocks.run import compute
from relforest.experiments.blocks.settings import SETTINGS, SMOKE

__all__ = ["SETTINGS", "SMOKE", "compute", "figures", "summarize"]
