from __future__ import annotations

import numpy as np
import pytest

from interpreted import compiled_only
from relforest.support.errors import InputError
from relforest.worlds.keepaway import keepaway_pass_scenes
from relforest.worlds.keepaway.decisions.scene import KEEPER_COLOR


@compiled_only
@pytest.mark.parametrize(("keepers", "takers", "size"), [(3, 2, 20.0), (4, 3, 25.0)])
def test_passes_are_between_keepers(keepers: int, takers: int, size: float) -> None:
    rules = {"keepers": keepers, "takers": takers, "size": size}
    scenes, labels = keepaway_pass_scenes(np.random.default_rng(0), 80, **rules)  # type: ignore[arg-type]

    assert scenes.schema.parameters == ("holder", "receiver")
    assert (len(scenes), len(labels), set(scenes.counts.tolist())) == (80, 80, {keepers + takers})
    assert (scenes.arguments[:, 0] != scenes.arguments[:, 1]).all()
    colors = scenes.matrix[:, scenes.schema.columns("color")]
    assert (colors[scenes.arguments] == KEEPER_COLOR).all()
    assert np.abs(scenes.matrix[:, :2]).max() <= size / 2 + 5
    assert 0.6 < labels.mean() < 1.0


@compiled_only
def test_passes_depend_on_the_seed_only() -> None:
    one, other, third = (keepaway_pass_scenes(np.random.default_rng(seed), 20)[0] for seed in (1, 1, 2))

    assert one == other
    assert one != third


def test_numbers_out_of_range_are_refused() -> None:
    with pytest.raises(InputError, match="n must be"):
        keepaway_pass_scenes(np.random.default_rng(0), 0)
    with pytest.raises(InputError, match="keepers must be"):
        keepaway_pass_scenes(np.random.default_rng(0), 5, keepers=1)
    with pytest.raises(InputError, match="rng must be a numpy Generator"):
        keepaway_pass_scenes(0, 5)  # type: ignore[arg-type]
