"""Made-up episodes: the ball goes round among the keepers, and the takers run after it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from relforest.worlds.keepaway.layout import OUT
from relforest.worlds.keepaway.recording import Decisions, Recording


def recording(
    *,
    keepers: int = 3,
    takers: int = 2,
    cycles: int = 40,
    field: tuple[float, float] = (20.0, 20.0),
    end: int = OUT,
    values: bool = True,
    seed: int = 0,
) -> Recording:
    """Record a made-up episode: keeper 0 holds in cycles 5 to 9 and passes; every 12 cycles another does."""
    rng = np.random.default_rng(seed)
    n, sides = keepers + takers, np.array(field)
    players = np.zeros((cycles + 1, n, 5))
    homes = rng.uniform(-0.35, 0.35, (n, 2)) * sides
    ball = np.zeros((cycles + 1, 4))
    rows: list[tuple[int, int, int]] = []
    for time in range(cycles + 1):
        turn, phase = divmod(max(time - 5, 0), 12)
        holder, mate = turn % keepers, (turn + 1) % keepers
        homes[:keepers] += rng.normal(0, 0.15, (keepers, 2))
        share = np.clip((phase - 4) / 8, 0, 1)
        players[time, :keepers, :2] = homes[:keepers]
        spot = homes[holder] + share * (homes[mate] - homes[holder]) + 0.6
        ball[time, :2] = spot
        homes[keepers:] += 0.08 * (spot - homes[keepers:]) + rng.normal(0, 0.1, (takers, 2))
        players[time, keepers:, :2] = homes[keepers:]
        toward = spot - players[time, :, :2]
        players[time, :, 4] = np.degrees(np.arctan2(toward[:, 1], toward[:, 0]))
        if time >= 5 and phase <= 4 and time < cycles:
            rows.append((time, holder, int(phase == 4)))
    return Recording(
        field,
        keepers,
        np.round(players, 3),
        np.round(ball, 3),
        rng.integers(0, 4, (cycles, n, 3)),
        _decisions(rows, keepers, values=values, rng=rng),
        end,
    )


def _decisions(
    rows: list[tuple[int, int, int]], keepers: int, *, values: bool, rng: np.random.Generator
) -> Decisions:
    table: NDArray[np.int64] = np.array(rows, dtype=np.int64).reshape(-1, 3)
    orders = np.array(
        [[(actor + step) % keepers for step in range(keepers)] for _, actor, _ in rows], dtype=np.int64
    ).reshape(-1, keepers)
    worth = rng.normal(10, 2, orders.shape) if values else np.full(orders.shape, np.nan)
    return Decisions(table[:, 0], table[:, 1], table[:, 2], orders, worth)
