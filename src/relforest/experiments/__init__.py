"""Runs of the learner in folders that survive any interruption, and the studies that reproduce the source.

`learn_runs` is ``relforest learn``: it turns a `RunConfig` of one of the `TASKS` into a run folder.
`run_study` is ``relforest experiment``: it turns one of the `STUDIES` into a folder of rows, findings and
figures. A study is a package with settings, run, analysis and a README, and a name in `registry`.
"""

from __future__ import annotations

from relforest.support.front_door import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
