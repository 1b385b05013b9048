"""Reinforcement learning with SMRF trees as features (Palmer 2015, chapter 6).

An agent gathers experience (`rollout`, `experience`), labels it by Bellman error (`bellman`), grows trees on
the labels (`relforest.trees`), keeps those that let policy iteration fit better (`lspi`, `lstdq`,
`selection`), and starts again with the better policy. Start with `SMRFRPI` in `rpi`, then `rounds`. `fitted`
learns from the same experience with fewer episodes, by questions that explain returns; `vectors` and
`baselines` hold what it is compared with.
"""

from __future__ import annotations

from relforest.support.front_door import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
