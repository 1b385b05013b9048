from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from multiprocessing.connection import Pipe
from pathlib import Path
from threading import Thread
from typing import Any

import pytest

from relforest.support.errors import InputError, RelforestError
from relforest.support.progress import Stage, listening, part, report
from relforest.support.workers import run_in_processes, serve, start

# What is busy in compiled code or in an import looks at its parent all the same.
BUSY = "import numpy\nwhile True: numpy.linalg.inv(numpy.random.rand(300, 300))"
PARENT = f"""
import sys
sys.path[:] = {sys.path!r}
from relforest.support.workers import start
print(start({BUSY!r}).pid, flush=True)
import time
time.sleep(60)
"""
SCRIPT = f"""
import sys
sys.path[:] = {sys.path!r}
from relforest.support.workers import run_in_processes

def double(number):
    return 2 * number

print(run_in_processes(double, [(1,), (2,)], 2))
"""


class OddError(Exception):
    """Cannot be rebuilt from its message."""

    def __init__(self, first: int, second: int) -> None:
        super().__init__(f"{first} is not {second}")


def counted(number: int) -> tuple[int, int]:
    report("counting", number, 9)
    return number, os.getpid()


def fail(number: int) -> None:
    if number == 3:
        raise InputError("3 is refused")
    time.sleep(60)


def fail_oddly(number: int) -> None:
    raise OddError(number, number + 1)


def end(status: int) -> None:
    if status < 0:
        os.kill(os.getpid(), -status)
    os._exit(status)


def unsendable(_number: int) -> Any:
    return lambda: None


def is_running(process: int) -> bool:
    status = Path(f"/proc/{process}/stat")
    # Where nobody asks for its status, what has ended remains as a zombie.
    return status.exists() and status.read_text().rpartition(")")[2].split()[0] != "Z"


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGTERM])
def test_a_process_ends_within_two_seconds_of_its_parent(number: int) -> None:
    with subprocess.Popen([sys.executable, "-c", PARENT], stdout=subprocess.PIPE, text=True) as parent:
        assert parent.stdout is not None
        child = int(parent.stdout.readline())
        assert is_running(child)
        parent.send_signal(number)
    limit = time.monotonic() + 2.0
    while is_running(child) and time.monotonic() < limit:
        time.sleep(0.05)

    assert not is_running(child)


def test_a_process_whose_parent_has_gone_before_it_could_look_ends() -> None:
    process = start("import time; time.sleep(60)", stdin=subprocess.DEVNULL)
    process.kill()
    process.wait()
    words = [*process.args[:3], str(os.getppid())]  # type: ignore[index]  # a list of str

    with subprocess.Popen(words) as orphan:
        assert orphan.wait(10.0) == 1


def test_arguments_reach_the_code() -> None:
    with start("print(sys.argv[1:])", ["a", "b"], stdout=subprocess.PIPE) as process:
        assert process.communicate()[0] == b"['a', 'b']\n"


def test_results_are_in_order_and_reports_arrive() -> None:
    stages: list[Stage] = []
    with listening(stages.append), part("a study"):
        results = run_in_processes(counted, [(number,) for number in range(5)], 2)

    assert [number for number, _ in results] == [0, 1, 2, 3, 4]
    assert os.getpid() not in {process for _, process in results}
    assert Stage("starting processes", within=("a study",)) in stages
    # Which of the reports arrive depends on how fast they are read.
    assert any(stage.name == "counting" and stage.within == ("a study",) for stage in stages)


def test_an_error_ends_the_other_tasks_and_keeps_its_traceback() -> None:
    begin = time.monotonic()
    with pytest.raises(InputError, match=r"^3 is refused\n") as caught:
        run_in_processes(fail, [(1,), (3,)], 2)

    assert time.monotonic() - begin < 30.0
    assert "in fail" in caught.value.__notes__[0]


def test_an_error_that_cannot_be_sent_is_named() -> None:
    with pytest.raises(RelforestError, match="OddError: 1 is not 2"):
        run_in_processes(fail_oddly, [(1,)], 1)


def test_a_result_that_cannot_be_sent_is_an_error() -> None:
    with pytest.raises(Exception, match=r"lambda"):
        run_in_processes(unsendable, [(1,)], 1)


@pytest.mark.parametrize(
    ("status", "complaint"),
    [(3, "ended with exit status 3 before"), (-signal.SIGKILL, "signal SIGKILL .* use fewer jobs")],
)
def test_a_process_that_is_lost_is_an_error(status: int, complaint: str) -> None:
    with pytest.raises(RelforestError, match=complaint):
        run_in_processes(end, [(status,)], 1)


def test_functions_of_a_script_may_be_run() -> None:
    done = subprocess.run([sys.executable, "-c", SCRIPT], capture_output=True, text=True, check=False)

    assert (done.stderr, done.stdout) == ("", "[2, 4]\n")


def served(*calls: Any) -> list[Any]:
    """Return what a process of the pool answers, from a thread of this one."""
    ours, theirs = Pipe()
    thread = Thread(target=serve, args=(theirs,))
    thread.start()
    messages = []
    for call in calls:
        ours.send(call)
        while ours.poll(1.0):
            messages.append(ours.recv())
    ours.close()
    thread.join()
    theirs.close()
    return messages


def test_a_process_of_the_pool_answers_every_task() -> None:
    report_, result, failure, odd, unsent = served(
        (counted, (4,)), (fail, (3,)), (fail_oddly, (1,)), (unsendable, (1,))
    )

    assert report_.stage == Stage("counting", 4, 9)
    assert result.value[0] == 4
    assert isinstance(failure.error, InputError)
    assert isinstance(odd.error, RelforestError)
    assert "lambda" in str(unsent.error)
