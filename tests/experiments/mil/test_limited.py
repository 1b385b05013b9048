from __future__ import annotations

import json
import os
import resource
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest

from experiments.mil import fakes
from relforest.experiments.mil.limited import run_job
from relforest.experiments.mil.steps import DONE, STOPPED, Job
from relforest.support.errors import InputError, RelforestError
from relforest.support.parallel import run_tasks

LIMIT = 1.0
PATIENCE = 120.0


def states(job: Job) -> list[str]:
    return [step.state for step in run_job(job, "a job")]


def test_steps_are_done_in_another_process_and_saved(tmp_path: Path) -> None:
    job = Job(fakes.echo, {"start": 5}, 3, LIMIT, tmp_path / "deep" / "job.json")
    steps = run_job(job, "echo")

    assert [step.values["number"] for step in steps] == [5, 6, 7]
    (process,) = {step.values["process"] for step in steps}
    assert process != os.getpid()
    assert all(step.peak_bytes > 20 * fakes.MEGABYTE for step in steps)
    assert job.saved() == steps
    # Nothing is left to do, so that no process is started.
    assert run_job(job, "echo") == steps


def test_compiled_code_that_takes_too_long_is_stopped(tmp_path: Path) -> None:
    job = Job(fakes.second_burns, {}, 4, LIMIT, tmp_path / "job.json")
    steps = run_job(job, "a job")

    assert [step.state for step in steps] == [DONE, STOPPED]
    assert steps[1].cpu_seconds is None
    # Looked up while it was running.
    assert steps[1].peak_bytes > 20 * fakes.MEGABYTE
    assert job.saved() == steps
    assert [path.name for path in tmp_path.iterdir()] == ["job.json"]


def test_others_may_follow_a_stopped_step(tmp_path: Path) -> None:
    job = Job(fakes.second_burns, {}, 3, LIMIT, tmp_path / "job.json", ends_when_stopped=False)

    assert states(job) == [DONE, STOPPED, DONE]


def test_a_failure_names_the_work_the_step_and_the_fault(tmp_path: Path) -> None:
    job = Job(fakes.second_crashes, {}, 3, LIMIT, tmp_path / "job.json")

    with pytest.raises(RelforestError, match=r"Musk 1, DD, step 1 \(of 0 to 2\)") as failure:
        run_job(job, "Musk 1, DD")
    assert "exit status 1" in str(failure.value)
    assert "ValueError: no luck today" in str(failure.value)
    assert [step.state for step in job.saved()] == [DONE]


def test_a_killed_process_is_a_failure_too(tmp_path: Path) -> None:
    job = Job(fakes.second_is_killed, {}, 2, LIMIT, tmp_path / "job.json")

    with pytest.raises(RelforestError, match=r"step 1 .*was killed, perhaps for lack of memory"):
        run_job(job, "a job")


def test_a_limit_exceeded_before_the_first_step_is_not_the_methods(tmp_path: Path) -> None:
    job = Job(fakes.never_begins, {}, 2, LIMIT, tmp_path / "job.json")

    with pytest.raises(
        RelforestError, match=r"Musk 1, DD: .* more than 600 CPU seconds before its first step"
    ):
        run_job(job, "Musk 1, DD")
    assert job.saved() == []


def test_a_smaller_limit_of_the_machine_is_told_at_the_start(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    job = Job(fakes.echo, {"start": 0}, 2, 300.0, tmp_path / "job.json")
    done = run_job(job, "echo")
    monkeypatch.setattr(resource, "getrlimit", lambda _: (60, 60))

    # Nothing is left to do.
    assert run_job(job, "echo") == done
    job.save(done[:1])
    with pytest.raises(InputError, match=r"may take 300 CPU seconds, but .* after 60: raise .*ulimit -t"):
        run_job(job, "echo")


def test_the_limit_of_the_machine_may_have_killed_a_process(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    job = Job(fakes.second_is_killed, {}, 2, LIMIT, tmp_path / "job.json")
    monkeypatch.setattr(resource, "getrlimit", lambda _: (60, 60))

    with pytest.raises(RelforestError, match=r"perhaps after 60 CPU seconds in all \(ulimit -t\)"):
        run_job(job, "a job")


def test_memory_is_that_of_the_steps_so_far(tmp_path: Path) -> None:
    job = Job(fakes.second_is_large, {"megabytes": 200}, 2, LIMIT, tmp_path / "job.json")
    small, large = run_job(job, "a job")

    assert large.values["size"] == 200 * fakes.MEGABYTE
    assert 150 * fakes.MEGABYTE < large.peak_bytes - small.peak_bytes < 250 * fakes.MEGABYTE


def test_only_the_rest_of_a_job_is_done(tmp_path: Path) -> None:
    job = Job(fakes.echo, {"start": 0}, 3, LIMIT, tmp_path / "job.json")
    whole = run_job(job, "echo")
    job.save(whole[:1])
    resumed = run_job(job, "echo")

    assert resumed[0] == whole[0]
    assert [step.values["number"] for step in resumed] == [0, 1, 2]
    assert resumed[1].values["process"] != whole[1].values["process"]


def test_jobs_may_be_run_by_workers(tmp_path: Path) -> None:
    jobs = [Job(fakes.echo, {"start": n}, 1, LIMIT, tmp_path / f"{n}.json") for n in (10, 20)]
    found = run_tasks(run_job, [(job, "echo") for job in jobs], n_jobs=2, prefer="processes")

    assert [step.values["number"] for steps in found for step in steps] == [10, 20]


def test_a_process_ends_with_the_one_that_started_it(tmp_path: Path) -> None:
    file = tmp_path / "job.json"
    start = f"import sys; sys.path[:] = {sys.path!r}; from experiments.mil.fakes import main; main()"
    with subprocess.Popen([sys.executable, "-c", start, str(file)]) as process:
        wait_for(file.exists)
        process.kill()
    worker = json.loads(file.read_text())["steps"][0]["values"]["process"]

    wait_for(lambda: not is_running(worker))


def wait_for(condition: Any) -> None:
    limit = time.monotonic() + PATIENCE
    while not condition():
        assert time.monotonic() < limit, "waited in vain"
        time.sleep(0.05)


def is_running(process: int) -> bool:
    status = Path(f"/proc/{process}/stat")
    # Where nobody asks for its status, what has ended remains as a zombie.
    return status.exists() and status.read_text().rpartition(")")[2].split()[0] != "Z"
