"""Record episodes of three worlds and write each as a small animation.

A recording holds frames of shapes; here they become pictures, and the pictures an animated WebP. `page` would
make a page of them that plays in any browser. Usage: ``python examples/moving_worlds.py [SECONDS]``.
"""

from __future__ import annotations

import sys
from dataclasses import replace

import gymnasium
from PIL import Image

from relforest.playing import Recording, paint, record_episodes
from relforest.worlds.blocks.policies import make_policy
from relforest.worlds.keepaway import HandCodedPolicy

WIDTH, PAUSE = 360, 125  # pixels, milliseconds


def animate(recording: Recording, path: str, seconds: float, pace: float) -> None:
    """Write the first seconds of an episode, played `pace` times as fast as it was."""
    stage = replace(recording.stage, pixels=WIDTH)
    pictures, due = [], 0.0
    for frame in recording.frames:
        if due <= frame.time <= seconds:
            pictures.append(Image.fromarray(paint(stage, frame)))
            due += pace * PAUSE / 1000
    first, *others = pictures
    first.save(path, save_all=True, append_images=others, duration=PAUSE, loop=0, quality=50)
    print(
        f"{path}: {len(pictures)} pictures, {recording.duration:.1f} s in all, reward {recording.reward:.2f}"
    )


seconds = float(sys.argv[1]) if len(sys.argv) > 1 else 60.0

env = gymnasium.make("relforest/Keepaway-v0", keepers=4, takers=3, size=25.0)
(game,) = record_episodes(env, HandCodedPolicy(), seed=3)
animate(game, "keepaway.webp", seconds, pace=1.0)

for world, policy, seed in (("HighTowers", "large-first", 1), ("ColorGrouping", "manual", 2)):
    env = gymnasium.make(f"relforest/{world}-v0")
    (episode,) = record_episodes(env, make_policy(policy, env.unwrapped), seed=seed)
    animate(episode, f"{world}.webp", seconds, pace=3.0)
