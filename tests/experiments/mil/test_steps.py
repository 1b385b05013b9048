from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest

from experiments.mil import fakes
from relforest.experiments.mil.steps import DONE, STOPPED, Job, Step
from relforest.support.errors import RunFolderError

HEAD = '{"format": "relforest-mil-steps", "version": 1, "asked": {"start": 1}, "steps": '
STEPS = [Step(DONE, 0.25, 1000, {"pss": 0.5}), Step(STOPPED, None, 2000)]


@pytest.fixture
def job(tmp_path: Path) -> Job:
    return Job(fakes.echo, {"start": 1}, 3, 1.0, tmp_path / "job.json")


def test_what_is_saved_is_read_again(job: Job) -> None:
    assert job.saved() == []
    job.save(STEPS)

    assert job.saved() == STEPS
    again = Job.from_dict(json.loads(json.dumps(job.to_dict())))
    assert again.prepare is fakes.echo
    assert again.saved() == STEPS


def test_a_job_is_over_after_its_last_step_or_a_stopped_one(job: Job) -> None:
    assert [job.is_over(steps) for steps in ([], STEPS[:1], STEPS, STEPS[:1] * 3)] == [
        False,
        False,
        True,
        True,
    ]
    other = replace(job, ends_when_stopped=False)
    assert [other.is_over(STEPS), other.is_over([*STEPS, STEPS[0]])] == [False, True]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "is damaged"),
        ('{"format": "relforest-mil-steps", "version": 1}', "is damaged .*'steps'"),
        (
            '{"format": "relforest-mil-steps", "version": 1, "asked": {"start": 1}, "steps": [{}]}',
            "is damaged",
        ),
        (
            HEAD + '[{"state": "new", "cpu_seconds": 1.0, "peak_bytes": 1}]}',
            "is damaged .*not a step",
        ),
        (
            HEAD + '[{"state": "done", "cpu_seconds": 1.0, "peak_bytes": 1, "values": {"pss": [0.5]}}]}',
            "is damaged .*not plain",
        ),
        ('{"format": "relforest-mil-steps", "version": 1, "asked": {"start": 2}, "steps": []}', "other work"),
    ],
)
def test_files_of_other_work_are_refused(job: Job, text: str, message: str) -> None:
    job.file.write_text(text)

    with pytest.raises(RunFolderError, match=rf"job\.json .*{message}.*; delete the file to compute"):
        job.saved()


def test_a_file_with_too_many_steps_is_refused(job: Job) -> None:
    job.save(STEPS * 2)

    with pytest.raises(RunFolderError, match="other work"):
        job.saved()
