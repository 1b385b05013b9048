from __future__ import annotations

import operator
import os
from typing import Any, Literal

import joblib
import numpy as np
import pytest
from threadpoolctl import threadpool_info

from relforest.support.errors import InputError
from relforest.support.parallel import one_blas_thread, run_tasks
from relforest.support.rng import generator, stream

# Worker processes cannot import this file, so what they run comes from libraries.


def blas_threads(pools: list[dict[str, Any]]) -> set[int]:
    return {pool["num_threads"] for pool in pools if pool["user_api"] == "blas"}


def fail(task: int) -> int:
    raise InputError(f"task {task} cannot run")


@pytest.mark.parametrize("prefer", ["threads", "processes"])
def test_results_do_not_depend_on_the_number_of_jobs(prefer: Literal["threads", "processes"]) -> None:
    seed = np.random.SeedSequence(5)
    tasks = [(generator(stream(seed, task)).standard_normal((80, 80)),) for task in range(6)]
    with one_blas_thread():
        expected = [np.linalg.inv(*task) for task in tasks]

    for n_jobs in (1, 2):
        np.testing.assert_array_equal(run_tasks(np.linalg.inv, tasks, n_jobs=n_jobs, prefer=prefer), expected)


def test_a_backend_configured_by_the_user_is_used() -> None:
    with joblib.parallel_config("threading"):
        assert run_tasks(os.getpid, [(), ()], n_jobs=2, prefer="processes") == [os.getpid()] * 2


@pytest.mark.parametrize("prefer", ["threads", "processes"])
def test_a_cluster_of_dask_gives_the_same_results(prefer: Literal["threads", "processes"]) -> None:
    distributed = pytest.importorskip("distributed")
    tasks = [(generator(np.random.SeedSequence(task)).standard_normal((20, 20)),) for task in range(4)]
    expected = run_tasks(np.linalg.inv, tasks, prefer=prefer)
    with (
        distributed.LocalCluster(
            n_workers=1, threads_per_worker=2, processes=False, dashboard_address=None
        ) as cluster,
        distributed.Client(cluster),
        joblib.parallel_config("dask"),
    ):
        found = run_tasks(np.linalg.inv, tasks, n_jobs=2, prefer=prefer)

    np.testing.assert_array_equal(found, expected)


def test_all_cores_may_be_used() -> None:
    assert run_tasks(divmod, [(7, 2), (9, 4)], n_jobs=-1, prefer="threads") == [(3, 1), (2, 1)]


def test_no_tasks_give_no_results() -> None:
    assert run_tasks(divmod, [], n_jobs=2, prefer="processes") == []


@pytest.mark.parametrize("n_jobs", [1, 2])
def test_tasks_run_with_one_blas_thread(n_jobs: int) -> None:
    for pools in run_tasks(threadpool_info, [(), ()], n_jobs=n_jobs, prefer="processes"):
        assert blas_threads(pools) <= {1}


def test_the_blas_limit_ends_with_its_block() -> None:
    before = blas_threads(threadpool_info())
    with one_blas_thread():
        inside = blas_threads(threadpool_info())

    assert inside == {1}
    assert blas_threads(threadpool_info()) == before


@pytest.mark.parametrize("n_jobs", [1, 2])
def test_an_error_of_a_task_reaches_the_caller(n_jobs: int) -> None:
    with pytest.raises(InputError, match="task 3 cannot run"):
        run_tasks(fail, [(3,), (3,)], n_jobs=n_jobs, prefer="threads")


@pytest.mark.parametrize("n_jobs", [0, -2, True, 1.0, None])
def test_other_numbers_of_jobs_are_refused(n_jobs: object) -> None:
    with pytest.raises(InputError, match="n_jobs must be a positive integer, or -1 for all cores, got "):
        run_tasks(fail, [(1,)], n_jobs=n_jobs, prefer="threads")  # type: ignore[arg-type]  # hostile on purpose


@pytest.mark.parametrize("prefer", ["threads", "processes"])
@pytest.mark.parametrize("n_jobs", [1, 2])
def test_a_result_may_continue_its_task(prefer: Literal["threads", "processes"], n_jobs: int) -> None:
    taken: list[tuple[int, int]] = []

    def double(number: int, result: int) -> tuple[int, int] | None:
        taken.append((number, result))
        return (result, 2) if result < 20 else None

    results = run_tasks(operator.mul, [(1, 2), (3, 2), (50, 2)], n_jobs=n_jobs, prefer=prefer, then=double)

    assert results == [32, 24, 100]
    assert sorted(taken) == [(0, 2 * 2**k) for k in range(5)] + [(1, 6), (1, 12), (1, 24), (2, 100)]
