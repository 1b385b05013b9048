"""Recorded games of the real server, and whether their steps obey the formulas of our physics."""

from __future__ import annotations

from pathlib import Path
from typing import Final

import numpy as np

from relforest.support.files import read_npz
from relforest.worlds.keepaway.server.bounds import StepCount, Steps, step_violations

TRAJECTORIES: Final = "keepaway-trajectories.npz"
"""Name of the recording: 32 episodes of random play on server 19."""

# Positions and velocities are rounded to 4 decimals, angles to 3, and then to float32.
_ROUNDING: Final = 0.51e-4
_BODY_ROUNDING: Final = 0.51e-3
# Server 19 does not dash backwards.
_MIN_DASH_POWER: Final = 0


def recorded_steps(path: Path) -> Steps:
    """Return all steps of a recording but the last of each episode, since final states were not recorded.

    Parameters
    ----------
    path : path
        Arrays ``t`` (T,), ``ep_end``, ``ball`` (T, 4), ``players`` (T, n, >= 5), ``cmd_type`` (T, n) and
        ``cmd_arg`` (T, n, 2): states, and the commands executed in the cycle that follows.

    Raises
    ------
    ModelFormatError
        If the file is missing, malformed or lacks an array.
    """
    data = read_npz(path, ["t", "ep_end", "ball", "players", "cmd_type", "cmd_arg"])
    following = np.flatnonzero(np.diff(data["t"]) == 1)
    first = following[~np.isin(data["t"][following + 1], data["ep_end"])]
    players, ball = data["players"][:, :, :5].astype(np.float64), data["ball"].astype(np.float64)
    commands = np.concatenate([data["cmd_type"][:, :, None], data["cmd_arg"]], axis=2).astype(np.int64)
    return Steps(ball[first], players[first], commands[first], ball[first + 1], players[first + 1])


def recorded_step_counts(path: Path) -> dict[str, StepCount]:
    """Count the steps of a recording of server 19 by motion, and those that no noise can explain."""
    return step_violations(
        recorded_steps(path),
        rounding=_ROUNDING,
        body_rounding=_BODY_ROUNDING,
        min_dash_power=_MIN_DASH_POWER,
    )
