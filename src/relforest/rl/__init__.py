"""Reinforcement learning with SMRF trees as features.

An agent gathers experience (`rollout`, `experience`), labels it by Bellman error (`bellman`), grows trees on
the labels (`relforest.trees`), keeps those that let policy iteration fit better (`lspi`, `lstdq`,
`selection`), and starts again with the better policy. Start with `SMRFRPI` in `rpi`, then `rounds`;
`checkpoint` describes a run folder.
"""

from __future__ import annotations
