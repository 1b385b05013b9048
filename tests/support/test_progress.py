from __future__ import annotations

import pytest

from relforest.support import progress
from relforest.support.parallel import run_tasks
from relforest.support.progress import (
    Stage,
    is_heard,
    listening,
    part,
    printed_to_stderr,
    report,
    report_stage,
)


def test_reports_reach_the_innermost_listener() -> None:
    outer: list[Stage] = []
    inner: list[Stage] = []

    report("nobody hears this")
    with listening(outer.append):
        report("growing trees", 1, 4)
        with listening(inner.append):
            report("compiling")
        report_stage(Stage("growing trees", 2, 4))

    assert outer == [Stage("growing trees", 1, 4), Stage("growing trees", 2, 4)]
    assert inner == [Stage("compiling")]
    assert not is_heard()
    report_stage(Stage("nobody hears this either"))


def test_a_stage_reads_as_one_line() -> None:
    assert str(Stage("compiling")) == "compiling"
    assert str(Stage("sequences", 3)) == "sequences: 3"
    assert str(Stage("growing trees", 3, 10)) == "growing trees: 3 of 10"
    assert (
        str(Stage("growing trees", 3, 10, ("run 0", "round 2"))) == "run 0, round 2, growing trees: 3 of 10"
    )


def test_reports_say_of_which_part_they_are() -> None:
    heard: list[str] = []
    with part("nobody listens"):
        report("lost")
    with listening(lambda stage: heard.append(str(stage))), part("run 1"):
        with part("round 2"):
            report("growing trees", 1, 4)
        report("testing")

    assert heard == ["run 1, round 2, growing trees: 1 of 4", "run 1, testing"]


def test_reports_of_threads_are_heard() -> None:
    heard: list[Stage] = []
    with listening(heard.append):
        run_tasks(report, [(f"task {number}", None, None) for number in range(4)], n_jobs=2, prefer="threads")

    assert sorted(stage.name for stage in heard) == ["task 0", "task 1", "task 2", "task 3"]


def test_verbose_prints_at_most_a_line_a_second(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    clock = iter([10.0, 10.5, 11.1])
    monkeypatch.setattr(progress, "monotonic", lambda: next(clock))
    with printed_to_stderr(verbose=True):
        for done in range(3):
            report("growing trees", done, 3)
    with printed_to_stderr(verbose=False):
        report("unheard")

    assert capsys.readouterr().err == "growing trees: 0 of 3\ngrowing trees: 2 of 3\n"
