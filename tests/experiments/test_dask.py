"""Runs are learned by workers that share no folder with the driver; only where Dask is installed."""

from __future__ import annotations

from pathlib import Path

import joblib
import pytest

from experiments.run_folders import TWO_RUNS, contents
from interpreted import compiled_only
from relforest.experiments.runs import learn_runs

distributed = pytest.importorskip("distributed")

pytestmark = compiled_only


# Dask may use what newer versions of Python or pandas deprecate.
@pytest.mark.filterwarnings("default")
def test_workers_in_another_directory_learn_the_same(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "workers").mkdir()
    monkeypatch.chdir(tmp_path / "workers")
    with (
        distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster,
        distributed.Client(cluster),
        joblib.parallel_config("dask"),
    ):
        # The workers stay where they are, and a relative name means something else to them.
        monkeypatch.chdir(tmp_path)
        learn_runs(TWO_RUNS, "remote", n_jobs=2)
    learn_runs(TWO_RUNS, "local")

    assert contents(tmp_path / "remote") == contents(tmp_path / "local")
    assert not any((tmp_path / "workers").rglob("*.json"))
