from __future__ import annotations

import threading

import numpy as np
import pytest
import scipy.linalg  # noqa: F401, its BLAS is one of those limited
from threadpoolctl import threadpool_info, threadpool_limits

from relforest.support import parallel
from relforest.support.blas import one_blas_thread


def blas_threads() -> set[int]:
    return {pool["num_threads"] for pool in threadpool_info() if pool["user_api"] == "blas"}


@pytest.fixture(autouse=True)
def _three_threads() -> object:
    with threadpool_limits(3, user_api="blas"):
        yield


def test_the_limit_ends_with_its_block() -> None:
    with one_blas_thread():
        assert blas_threads() == {1}
    assert blas_threads() == {3}


def test_an_inner_block_does_not_lift_the_limit_of_an_outer_one() -> None:
    with one_blas_thread():
        with one_blas_thread():
            pass
        assert blas_threads() == {1}
    assert blas_threads() == {3}


def test_blocks_of_two_threads_may_overlap() -> None:
    entered, may_leave = threading.Event(), threading.Event()

    def hold() -> None:
        with one_blas_thread():
            entered.set()
            may_leave.wait(30)

    other = threading.Thread(target=hold)
    with one_blas_thread():
        other.start()
        assert entered.wait(30)
    # The first block has ended, the second has not.
    assert blas_threads() == {1}
    may_leave.set()
    other.join(30)
    assert blas_threads() == {3}


def test_an_error_lifts_the_limit() -> None:
    with pytest.raises(np.linalg.LinAlgError), one_blas_thread():
        np.linalg.inv(np.zeros((2, 2)))
    assert blas_threads() == {3}


def test_many_threads_leave_the_number_as_it_was() -> None:
    def enter_often() -> None:
        for _ in range(200):
            with one_blas_thread():
                pass

    threads = [threading.Thread(target=enter_often) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(60)
    assert blas_threads() == {3}


def test_parallel_tasks_use_the_same_limit() -> None:
    assert parallel.one_blas_thread is one_blas_thread
