from __future__ import annotations

import resource
from pathlib import Path

import numpy as np
import pytest

from experiments.mil import fakes
from relforest.experiments.mil.steps import DONE, Job
from relforest.experiments.mil.worker import cpu_limit, cpu_seconds, peak_memory, work_through

LONG = 10_000.0


def test_a_job_is_worked_through_step_by_step(tmp_path: Path) -> None:
    job = Job(fakes.echo, {"start": 1}, 2, LONG, tmp_path / "job.json")
    work_through(job)
    steps = job.saved()

    assert [(step.state, step.values["number"]) for step in steps] == [(DONE, 1), (DONE, 2)]
    assert all(step.cpu_seconds is not None and 0 <= step.cpu_seconds < 1 for step in steps)
    work_through(job)
    assert job.saved() == steps


def test_a_failing_step_is_not_saved(tmp_path: Path) -> None:
    job = Job(fakes.second_crashes, {}, 3, LONG, tmp_path / "job.json")
    with pytest.raises(ValueError, match="no luck today"):
        work_through(job)

    assert len(job.saved()) == 1


def test_the_limit_holds_only_inside_its_block() -> None:
    before = resource.getrlimit(resource.RLIMIT_CPU)
    with cpu_limit(LONG):
        soft, hard = resource.getrlimit(resource.RLIMIT_CPU)
        assert cpu_seconds() + LONG - 1 < soft < cpu_seconds() + LONG + 1
        assert hard == before[1]
    assert resource.getrlimit(resource.RLIMIT_CPU) == (before[1], before[1])


def test_cpu_time_is_counted_finely_under_a_limit() -> None:
    def spent() -> float:
        begin = cpu_seconds()
        np.sort(np.arange(20_000) % 97)
        return cpu_seconds() - begin

    with cpu_limit(LONG):
        assert len({spent() for _ in range(20)}) > 3


def test_memory_of_processes() -> None:
    assert peak_memory() > 20 * fakes.MEGABYTE
    # There is no such process.
    assert peak_memory(2**22 + 1) == 0
