"""Write passes.parquet: 600 invented soccer passes, one row per player.

A pass fails if an opponent stands between passer and receiver: it is cut early or late. How much space the
receiver has is the distance to the nearest other player. The table does not say so; `relforest fit` finds it
out. Usage: ``python examples/make_passes.py [FILE]``.
"""

from __future__ import annotations

import sys

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq


def passes(n_passes: int, seed: int) -> pa.Table:
    """Return a table with places and space in metres, theta in radians."""
    rng = np.random.default_rng(seed)
    names = ("pass", "player", "x", "y", "theta", "passer", "receiver", "completed", "cut", "space")
    rows: dict[str, list[object]] = {name: [] for name in names}
    for number in range(n_passes):
        places = rng.uniform(0.0, 20.0, size=(rng.integers(5, 9), 2))
        passer, receiver, *others = places
        along = receiver - passer
        relative = np.array(others) - passer
        forward = relative @ along / (along @ along)
        sideways = np.abs(relative @ [-along[1], along[0]]) / (along @ along)
        stopped = forward[(forward > 0.1) & (forward < 0.9) & (sideways < 0.2)]
        completed = not len(stopped)
        cut = "no" if completed else "early" if stopped.min() < 0.5 else "late"
        space = float(np.linalg.norm(np.array(others) - receiver, axis=1).min())
        said = ("player 0", "player 1", completed, cut, space)
        for player, (x, y) in enumerate(places):
            values = (number, f"player {player}", x, y, rng.uniform(-np.pi, np.pi))
            for name, value in zip(rows, (*values, *said), strict=True):
                rows[name].append(value)
    return pa.table(rows)


if __name__ == "__main__":
    target = sys.argv[1] if len(sys.argv) > 1 else "passes.parquet"
    pq.write_table(passes(600, seed=0), target)
    print(f"wrote {target}")
