from __future__ import annotations

import os
import resource
from collections.abc import Iterator

import numpy as np
import pytest

from relforest.support.errors import InputError, RelforestError
from relforest.support.limited import LimitedProcess, cpu_limit, cpu_seconds, peak_memory
from relforest.support.progress import Stage, listening, report

LONG = 10_000.0
MEGABYTE = 10**6


@pytest.fixture
def process() -> Iterator[LimitedProcess]:
    made = LimitedProcess()
    yield made
    made.close()


def number_of_process() -> int:
    report("looking")
    return os.getpid()


def allocate(megabytes: int) -> int:
    return len(bytearray(megabytes * MEGABYTE))


def burn() -> None:
    """Never come back from compiled code."""
    with cpu_limit(0.5):
        sum(range(10**14))


def fail(how: str) -> None:
    if how == "killed":
        os.kill(os.getpid(), 9)
    raise ValueError("no luck today")


def test_a_process_is_kept_until_a_limit_ends_it(process: LimitedProcess) -> None:
    stages: list[Stage] = []
    with listening(stages.append):
        first, small = process.call("work", number_of_process)
    size, large = process.call("work", allocate, 200)

    assert first != os.getpid()
    assert [stage.name for stage in stages] == ["looking"]
    assert size == 200 * MEGABYTE
    assert 150 * MEGABYTE < large - small < 250 * MEGABYTE
    # Memory of what was stopped is looked up while it runs.
    value, peak = process.call("work", burn)
    assert (value, peak >= large) == (None, True)
    second, _ = process.call("work", number_of_process)
    assert second != first
    # Other work does not inherit its memory.
    assert process.call("other work", number_of_process)[0] != second


def test_failures_are_named_with_the_work(process: LimitedProcess) -> None:
    with pytest.raises(RelforestError, match="Musk 1, DD: ValueError: no luck today") as failure:
        process.call("Musk 1, DD", fail, "error")
    assert "in fail" in str(failure.value)
    with pytest.raises(RelforestError, match=r"work: .* ended with signal SIGKILL"):
        process.call("work", fail, "killed")


def test_the_limit_holds_only_inside_its_block() -> None:
    before = resource.getrlimit(resource.RLIMIT_CPU)
    with cpu_limit(LONG):
        soft, hard = resource.getrlimit(resource.RLIMIT_CPU)
        assert cpu_seconds() + LONG - 1 < soft < cpu_seconds() + LONG + 1
        assert hard == before[1]
    assert resource.getrlimit(resource.RLIMIT_CPU) == (before[1], before[1])


def test_a_smaller_limit_of_the_machine_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(resource, "getrlimit", lambda _: (60, 60))

    with (
        pytest.raises(InputError, match=r"may take 10000 CPU seconds, but .* after 60 in all: .*ulimit -t"),
        cpu_limit(LONG),
    ):
        pass


def test_cpu_time_is_counted_finely_under_a_limit() -> None:
    def spent() -> float:
        begin = cpu_seconds()
        np.sort(np.arange(20_000) % 97)
        return cpu_seconds() - begin

    with cpu_limit(LONG):
        assert len({spent() for _ in range(20)}) > 3


def test_memory_of_processes() -> None:
    assert peak_memory() > 20 * MEGABYTE
    # There is no such process.
    assert peak_memory(2**22 + 1) == 0
