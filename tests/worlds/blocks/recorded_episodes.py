"""Made-up episodes: blocks fall, then one after the other is carried onto the first."""

from __future__ import annotations

import numpy as np

from relforest.worlds.blocks.recording import NOBODY, Mark, OptionRecord, Recording

SECONDS = 8.0
"""Each option takes as long; the drop takes 2 seconds."""


def recording(
    *, task: str = "high-towers", blocks: int = 4, options: int = 2, lost: bool = False, seed: int = 0
) -> Recording:
    """Record a made-up episode; with ``lost``, the last block falls off the table after 5 seconds."""
    rng = np.random.default_rng(seed)
    sides = rng.uniform(0.5, 5.0, (blocks, 2))
    places = np.stack([np.linspace(-28.0, 28.0, blocks), sides[:, 1], np.zeros(blocks)], axis=1)
    fall = np.linspace(1.0, 0.0, 51)[:, None, None] ** 2
    parts = [places + fall * np.array([0.0, 30.0, 0.3])]
    held = [np.full(51, NOBODY)]
    carried = []
    scores = [float(places[:, 1].mean())]
    for number in range(options):
        block, top = 1 + number % (blocks - 1), float((places[:, 1] + sides[:, 1]).max())
        target = np.array([places[0, 0], top + sides[block, 1], 0.1])
        times = np.linspace(0, 1, round(25 * SECONDS) + 1)[1:]
        path = np.repeat(places[None], len(times), axis=0)
        share = np.clip(times * 1.2 - 0.1, 0, 1)[:, None]
        path[:, block] += share * (target - places[block]) + 5 * np.sin(np.pi * share) * [0.0, 1.0, 0.0]
        places = path[-1]
        parts.append(path)
        held.append(np.where((share[:, 0] > 0) & (share[:, 0] < 1), 10 + block, NOBODY))
        scores.append(float(places[:, 1].mean()))
        begin, name = 2.0 + SECONDS * number, "move" if task == "arch" else "put"
        carried.append(
            OptionRecord(
                name,
                (10 + block,) if task == "arch" else (10 + block, 10),
                float(target[0]) if task == "arch" else None,
                begin,
                begin + SECONDS,
                scores[-1] - scores[-2],
                scores[-1],
            )
        )
    poses = np.concatenate(parts)
    if lost:
        poses[125:, -1] = np.nan
    marks = tuple((Mark(-12.0, -4.0, 0.0, 0.0 if task != "arch" else 7.5, 1.25),) for _ in scores)
    return Recording(
        task=task,
        ids=np.arange(10, 10 + blocks),
        half_extents=sides,
        colors=np.round(rng.random((blocks, 3)), 3),
        times=np.arange(len(poses)) / 25,
        poses=poses,
        held=np.concatenate(held),
        options=tuple(carried),
        first_score=scores[0],
        marks=marks,
    )
