"""Reinforcement learning with SMRF trees as features (Palmer 2015, chapter 6).

An agent gathers experience (`rollout`, `experience`), labels it by Bellman error (`bellman`), grows trees on
the labels (`relforest.trees`), keeps those with which policy iteration fits better (`lspi`, `lstdq`,
`selection`), and starts again with the better policy. Start with `SMRFRPI` in `rpi`, then `rounds`;
`checkpoint` describes a run folder.
"""

from __future__ import annotations

from relforest.rl.lspi import LSPISettings
from relforest.rl.rpi import SMRFRPI, Evaluation
from relforest.rl.settings import RPISettings
from relforest.rl.value import ValueFunction

__all__ = ["SMRFRPI", "Evaluation", "LSPISettings", "RPISettings", "ValueFunction"]
