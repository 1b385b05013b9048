"""Draw scenes of the one-step outcome tasks as pictures, with their outcomes."""

from __future__ import annotations

from pathlib import Path

import matplotlib.image
import numpy as np

from relforest import Scenes
from relforest.playing import Frame, paint
from relforest.worlds.blocks import balance_scale_scenes, drop_on_scenes
from relforest.worlds.blocks.frames import block_things, table_stage

# The post and the beam of the scale are not objects of the scenes: half sizes and poses, drawn in grey.
SCALE = (np.array([[1.0, 5.0], [10.0, 0.25]]), np.array([[0.0, 5.0, 0.0], [0.0, 10.25, 0.0]]))


def picture(scenes: Scenes, number: int, caption: str, beside: tuple[np.ndarray, np.ndarray]) -> np.ndarray:
    """Return a picture of a scene with additional boxes."""
    objects = scenes.objects(number)
    location, extent, angle, color = (
        scenes.values[name][objects] for name in ("location", "extent", "orientation", "color")
    )
    half_extents, poses = beside
    # The orientation of a scene is twice the angle of the longer side.
    blocks = block_things(
        np.concatenate([half_extents, extent]),
        np.concatenate([poses, np.column_stack([location, angle / 2])]),
        np.concatenate([np.full((len(poses), 3), 0.55), color]),
    )
    return paint(table_stage(), Frame(0.0, blocks, caption=caption))


rng = np.random.default_rng(3)
nothing = (np.empty((0, 2)), np.empty((0, 3)))
balance, tips_left = balance_scale_scenes(rng, 50)
dropped, rests_over = drop_on_scenes(rng, 50)
print(f"balance scale: {tips_left.mean():.0%} of {len(balance)} scenes tip to the left")
print(f"dropOn: in {rests_over.mean():.0%} of {len(dropped)} scenes the block comes to rest over the support")
for name, scenes, labels, words, beside in (
    ("balance-scale", balance, tips_left, ("tips to the right", "tips to the left"), SCALE),
    ("drop-on", dropped, rests_over, ("falls beside it", "comes to rest over it"), nothing),
):
    most = int(np.argmax(scenes.counts))
    image = picture(scenes, most, words[int(labels[most])], beside)
    matplotlib.image.imsave(Path(f"blocks-{name}.png"), image)
