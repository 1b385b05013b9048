"""Forests grow on a Dask cluster as they do alone; only where Dask is installed."""

from __future__ import annotations

import json
from typing import Any

import joblib
import numpy as np
import pytest
from sklearn.base import clone

from forests.team_scenes import guest_on_the_left, scenes_of
from relforest import SMRFForestClassifier
from relforest.trees import TreeSettings

distributed = pytest.importorskip("distributed")


# Dask may use what newer versions of Python or pandas deprecate.
@pytest.mark.filterwarnings("default")
@pytest.mark.parametrize("growth", [None, TreeSettings(attempts=1)], ids=["conditions", "smrf"])
def test_a_forest_is_the_same_with_any_workers(growth: TreeSettings | None) -> None:
    scenes = scenes_of(np.random.default_rng(0), 40, 2)
    y = guest_on_the_left(scenes)
    model = SMRFForestClassifier(n_trees=4, growth=growth, random_state=0)
    alone = written(model.fit(scenes, y))
    two = written(clone(model).set_params(n_jobs=2).fit(scenes, y))
    with (
        distributed.LocalCluster(
            n_workers=1, threads_per_worker=2, processes=False, dashboard_address=None
        ) as cluster,
        distributed.Client(cluster),
        joblib.parallel_config("dask"),
    ):
        remote = written(clone(model).set_params(n_jobs=2).fit(scenes, y))

    assert alone == two == remote


def written(model: Any) -> str:
    return json.dumps(model.ensemble_.to_dict()) + str(model.oob_score_)
