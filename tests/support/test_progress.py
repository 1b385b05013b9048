from __future__ import annotations

from relforest.support.progress import Stage, is_heard, listening, report


def test_reports_reach_the_innermost_listener() -> None:
    outer: list[Stage] = []
    inner: list[Stage] = []

    report("nobody hears this")
    with listening(outer.append):
        report("growing trees", 1, 4)
        with listening(inner.append):
            report("compiling")
        report("growing trees", 2, 4)

    assert outer == [Stage("growing trees", 1, 4), Stage("growing trees", 2, 4)]
    assert inner == [Stage("compiling")]
    assert not is_heard()


def test_a_stage_reads_as_one_line() -> None:
    assert str(Stage("compiling")) == "compiling"
    assert str(Stage("sequences", 3)) == "sequences: 3"
    assert str(Stage("growing trees", 3, 10)) == "growing trees: 3 of 10"
