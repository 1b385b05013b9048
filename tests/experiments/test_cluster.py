"""A study on a Dask cluster gives the rows that it gives here; only where Dask is installed."""

from __future__ import annotations

import os
import shutil
import signal
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from socket import socket
from time import sleep
from typing import Any, final

import pytest

from relforest.experiments import cluster
from relforest.experiments.claims import Findings
from relforest.experiments.cluster import on_cluster
from relforest.experiments.learned_policies import learned_policy
from relforest.experiments.run_config import RunConfig
from relforest.experiments.runner import run_study
from relforest.experiments.runs import RunInFolder
from relforest.experiments.study import Context, Study
from relforest.experiments.table import Row
from relforest.rl.fitted.settings import Source
from relforest.rl.rollout import rollout
from relforest.runs.store import metrics_of
from relforest.support.errors import InputError, RelforestError
from relforest.support.rng import generator

distributed = pytest.importorskip("distributed")

# Dask may use what newer versions of Python or pandas deprecate.
pytestmark = pytest.mark.filterwarnings("default")


@final
@dataclass(frozen=True, slots=True)
class Throws:
    """Throws of a die; the first player begins with the run of the second one."""

    player: int

    def __str__(self) -> str:
        return f"player {self.player}"


def throw(setting: Throws, context: Context) -> list[Row]:
    sleep(0.2)
    face = int(generator(context.stream).integers(1, 7))
    return [{"player": setting.player, "face": face}]


def look(setting: Throws, _context: Context) -> list[Row]:
    """Tell who computes."""
    return [{"player": setting.player, "process": os.getpid()}]


def learned(setting: Throws, context: Context) -> RunInFolder:
    source = None if setting.player else Source(context.folder / "runs" / "1")
    config = RunConfig("corridor", 4, 1, test_episodes=1, method="smrf-q", source=source)
    return RunInFolder(config, 0, context.folder / "runs" / str(setting.player))


def values_of(setting: Throws, context: Context) -> list[Row]:
    run = learned(setting, context)
    env = run.config.make()
    played = rollout(env, learned_policy(run.folder, env), 1, context.stream)
    return [
        {"player": setting.player, **metrics_of(run.folder)[-1], "again": float(played.episode_rewards[0])}
    ]


DICE = Study(
    "dice",
    "Is it fair?",
    tuple(map(Throws, range(6))),
    (Throws(0),),
    throw,
    lambda table: Findings(f"{len(table)} throws"),
    compiles=False,
)
LEARNING = replace(DICE, settings=DICE.settings[:2], compute=values_of, learned=learned)


@contextmanager
def local_cluster(workers: int, *, processes: bool = True) -> Iterator[Any]:
    with distributed.LocalCluster(
        n_workers=workers, threads_per_worker=1, processes=processes, dashboard_address=None
    ) as found:
        yield found


def contents(folder: Path) -> dict[str, bytes]:
    files = (path for path in folder.rglob("*") if path.suffix not in (".lock", ".jsonl") and path.is_file())
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in files}


def test_without_an_address_tasks_stay_here() -> None:
    with on_cluster(None, 3) as jobs:
        assert jobs == 3


@pytest.mark.parametrize("address", ["nowhere", "x://here:1", ""])
def test_an_address_must_be_one(address: str) -> None:
    with pytest.raises(InputError, match=f"no Dask scheduler answers at '{address}'"), on_cluster(address):
        pass


def test_somebody_else_who_listens_is_no_scheduler(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cluster, "_SECONDS_TO_ANSWER", 0.5)
    with socket() as other:
        other.bind(("127.0.0.1", 0))
        other.listen()
        address = f"tcp://127.0.0.1:{other.getsockname()[1]}"
        with pytest.raises(InputError, match="no Dask scheduler answers"), on_cluster(address):
            pass


def test_a_cluster_without_workers_computes_nothing() -> None:
    with (
        local_cluster(0, processes=False) as there,
        pytest.raises(InputError, match="has no workers"),
        on_cluster(there.scheduler_address),
    ):
        pass


def test_a_worker_is_no_scheduler() -> None:
    with local_cluster(1, processes=False) as there:
        (worker,) = there.workers.values()
        with pytest.raises(InputError, match="is the address of a Dask worker"), on_cluster(worker.address):
            pass


def test_workers_need_the_same_software(monkeypatch: pytest.MonkeyPatch) -> None:
    with local_cluster(1) as there:
        # Every process has another number.
        monkeypatch.setattr(cluster, "versions", os.getpid)
        complaint = r"the worker .* has other software: versions \(\d+ there, "
        with pytest.raises(InputError, match=complaint), on_cluster(there.scheduler_address):
            pass


def test_a_single_setting_is_computed_by_a_single_worker(tmp_path: Path) -> None:
    with local_cluster(1) as there, on_cluster(there.scheduler_address) as jobs:
        run_study(replace(DICE, settings=DICE.settings[:1], compute=look), tmp_path, n_jobs=jobs)
    assert str(os.getpid()) not in (tmp_path / "rows.csv").read_text()


def test_a_killed_worker_changes_no_row(tmp_path: Path) -> None:
    run_study(DICE, tmp_path / "here", n_jobs=2)
    told: list[str] = []
    with local_cluster(2) as there, on_cluster(there.scheduler_address) as jobs:
        victim = next(iter(distributed.get_client().run(os.getpid).values()))

        def tell(line: str) -> None:
            if not told:
                os.kill(victim, signal.SIGKILL)
            told.append(line)

        assert jobs == 2
        run_study(DICE, tmp_path / "there", n_jobs=jobs, on_progress=tell)

    assert len(told) == 6
    assert contents(tmp_path / "there") == contents(tmp_path / "here")


def test_a_lost_cluster_is_told_and_what_was_done_is_kept(tmp_path: Path) -> None:
    with local_cluster(1, processes=False) as there:
        lost = pytest.raises(
            RelforestError, match=r"the Dask cluster was lost .* the same command resumes it"
        )
        with lost, on_cluster(there.scheduler_address) as jobs:
            run_study(DICE, tmp_path, n_jobs=jobs, on_progress=lambda _line: there.close())
    assert list(tmp_path.glob("settings/*"))


def test_workers_need_none_of_the_files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "workers").mkdir()
    monkeypatch.chdir(tmp_path / "workers")
    with local_cluster(1) as there:
        # The workers stay where they are, and a relative name means something else to them.
        monkeypatch.chdir(tmp_path)
        with on_cluster(there.scheduler_address) as jobs:
            run_study(LEARNING, "study", n_jobs=jobs)
    remote = contents(tmp_path / "study")
    shutil.rmtree(tmp_path / "study")
    run_study(LEARNING, "study")

    assert contents(tmp_path / "study") == remote
    assert "runs/0/checkpoint.json" in remote
    assert not any((tmp_path / "workers").iterdir())
