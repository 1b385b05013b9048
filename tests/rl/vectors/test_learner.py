from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from experiments.run_folders import contents
from interpreted import compiled_only
from relforest.rl.vectors import LSPI, LinearQ, NetworkQ, TreesQ
from relforest.rl.vectors.approximator import Approximator
from relforest.rl.vectors.learner import read_value
from relforest.runs.learner import advance
from relforest.runs.store import RunStore, read_checkpoint
from relforest.support.errors import ModelFormatError
from rl.small_worlds import Picking
from rl.vectors.picked_things import Things, learner

pytestmark = compiled_only

EVERY = [
    LinearQ(ridge=1.0),
    LSPI(ridge=1.0),
    TreesQ("trees", sweeps=2),
    TreesQ("boosting", sweeps=2),
    NetworkQ("dqn", sweeps=2, steps=5),
]


@pytest.mark.parametrize("approximator", EVERY, ids=lambda each: each.to_dict()["name"])
def test_an_interrupted_run_ends_with_the_same_bytes(approximator: Approximator[Any], tmp_path: Path) -> None:
    if isinstance(approximator, NetworkQ):
        pytest.importorskip("torch")
    found = learner(approximator)
    whole, parts = RunStore(tmp_path / "whole", found), RunStore(tmp_path / "parts", found)
    run = None
    for _ in range(3):
        run, _ = advance(found, run)
        whole.write(run)
        again, _ = advance(found, parts.resume())
        parts.write(again)
    assert contents(tmp_path / "whole") == contents(tmp_path / "parts")
    assert run is not None
    assert run.state.value is not None

    document, env = read_checkpoint(tmp_path / "whole").document, Picking(6)
    value = read_value(document, 2, tmp_path / "whole", found.approximator.model, Things())
    env.reset(seed=1)
    np.testing.assert_array_equal(value.values(env.decision()), run.state.value.values(env.decision()))


def test_a_missing_or_foreign_model_is_refused(tmp_path: Path) -> None:
    found = learner(LinearQ(ridge=1.0))
    run, _ = advance(found, advance(found, None)[0])
    RunStore(tmp_path, found).write(run)
    with pytest.raises(ModelFormatError, match="does not name the values of iteration 1"):
        found.from_plain({}, 1, tmp_path)
    with pytest.raises(ModelFormatError, match="iteration-0001"):
        learner(TreesQ("trees")).from_plain(read_checkpoint(tmp_path).document, 1, tmp_path)
    (tmp_path / "values" / "iteration-0001.npz").unlink()
    with pytest.raises(ModelFormatError, match="iteration-0001"):
        RunStore(tmp_path, found).resume()
