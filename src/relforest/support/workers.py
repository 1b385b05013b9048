"""Processes that end with their parent, and a pool of them for independent tasks.

Before a child imports anything else, it starts a thread that checks several times a second whether its parent
is still there. So it ends soon after the parent, even if that was killed by SIGKILL.
"""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import traceback
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass, replace
from multiprocessing.connection import Connection, Pipe, wait
from multiprocessing.reduction import ForkingPickler
from select import select
from threading import Lock
from time import monotonic
from typing import Any, Final, final

from joblib import wrap_non_picklable_objects

from relforest.support.errors import RelforestError
from relforest.support.progress import Stage, listening, report, report_stage

PATIENCE: Final = 0.2
"""Seconds between two checks of the parent."""

_FOLLOW: Final = f"""
import os, sys, threading, time
def follow(parent):
    while os.getppid() == parent:
        time.sleep({PATIENCE})
    os._exit(1)
threading.Thread(target=follow, args=(int(sys.argv.pop(1)),), daemon=True).start()
"""
_SERVE: Final = """
from multiprocessing.connection import Connection
connection = Connection(int(sys.argv[1]))
sys.path[:] = connection.recv()
from relforest.support.workers import serve
serve(connection)
"""
_SECONDS_BETWEEN_REPORTS: Final = 0.1
_SECONDS_TO_END: Final = 2.0


def start(
    code: str,
    arguments: Sequence[str] = (),
    **options: Any,  # noqa: ANN401 - as `subprocess.Popen` takes them
) -> subprocess.Popen[bytes]:
    """Start Python in a child process that ends with this one.

    The modules ``os`` and ``sys`` are imported already; the arguments are ``sys.argv[1:]``, and the options
    those of `subprocess.Popen`.
    """
    words = [sys.executable, "-c", _FOLLOW + code, str(os.getpid()), *arguments]
    return subprocess.Popen(words, **options)  # noqa: S603 - our own interpreter


def run_in_processes(
    function: Callable[..., Any],
    tasks: Sequence[tuple[Any, ...]],
    n_workers: int,
    then: Callable[[int, Any], tuple[Any, ...] | None] = lambda _number, _result: None,
) -> list[Any]:
    """Call ``function(*task)`` for every task in `n_workers` processes, and return the results in order.

    Whatever ``then(number, result)`` returns in this process continues the task in the same worker.
    Reports of the tasks (`relforest.support.progress`) are passed on. The first error of a task is raised at
    once and ends the other tasks.

    Raises
    ------
    RelforestError
        If a process dies.
    """
    results: list[Any] = [None] * len(tasks)
    waiting = iter(enumerate(tasks))
    report("starting processes")
    with _pool(n_workers) as workers:
        busy: dict[Any, tuple[Worker, int]] = {}

        def give(worker: Worker, task: tuple[Any, ...]) -> None:
            worker.give(wrap_non_picklable_objects((function, task), keep_wrapper=False))

        def occupy(worker: Worker) -> None:
            number, task = next(waiting, (-1, ()))
            if number < 0:
                report_stage(Stage("waiting for the others", source=worker.number))
                return
            busy[worker.connection] = worker, number
            give(worker, task)

        for worker in workers:
            occupy(worker)
        while busy:
            for connection in wait(list(busy)):
                worker, number = busy[connection]
                message = worker.take()
                if isinstance(message, _Report):
                    report_stage(replace(message.stage, source=worker.number))
                elif isinstance(message, _Failure):
                    raise message.error
                else:
                    results[number] = message.value
                    more = then(number, message.value)
                    if more is None:
                        del busy[connection]
                        occupy(worker)
                    else:
                        give(worker, more)
    return results


def serve(connection: Connection) -> None:
    """Run the tasks that arrive until the other end is closed, in a process of the pool."""
    lock, latest, before = Lock(), 0.0, Stage("")

    def send_report(stage: Stage) -> None:
        nonlocal latest, before
        now, is_news = monotonic(), (stage.within, stage.name) != (before.within, before.name)
        with lock:
            # Reports may be lost, but must not block the work if the parent does not read them.
            if is_news or now - latest >= _SECONDS_BETWEEN_REPORTS:
                latest, before = now, stage
                if select([], [connection], [], 0)[1]:
                    connection.send(_Report(stage))

    while True:
        try:
            function, task = connection.recv()
        except EOFError:
            return
        try:
            with listening(send_report):
                value = function(*task)
            message: _Result | _Failure = _Result(value)
            ForkingPickler.dumps(message)
        except Exception as error:  # noqa: BLE001 - the caller handles them
            message = _Failure(_portable(error))
        with lock:
            connection.send(message)


@final
@dataclass(frozen=True, slots=True)
class _Report:
    stage: Stage


@final
@dataclass(frozen=True, slots=True)
class _Result:
    value: Any


@final
@dataclass(frozen=True, slots=True)
class _Failure:
    error: Exception


@final
@dataclass(frozen=True, slots=True, eq=False)
class Worker:
    """A process that runs tasks, its number in a pool, counted from 1, and the connection to it."""

    number: int
    process: subprocess.Popen[bytes]
    connection: Connection

    def call(self, function: Callable[..., Any], task: tuple[Any, ...], look: Callable[[], object]) -> Any:  # noqa: ANN401
        """Return ``function(*task)``, and call `look` several times a second until then.

        Raises
        ------
        RelforestError
            If the process dies.
        """
        self.give(wrap_non_picklable_objects((function, task), keep_wrapper=False))
        while True:
            while not self.connection.poll(_SECONDS_BETWEEN_REPORTS):
                look()
            message = self.take()
            if isinstance(message, _Report):
                report_stage(message.stage)
            elif isinstance(message, _Failure):
                raise message.error
            else:
                return message.value

    def give(self, message: object) -> None:
        """Send a function with its arguments."""
        try:
            self.connection.send(message)
        except ConnectionError:
            raise self._lost() from None

    def take(self) -> _Report | _Result | _Failure:
        """Wait for what the process sends next."""
        try:
            message: _Report | _Result | _Failure = self.connection.recv()
        except (EOFError, ConnectionError):
            raise self._lost() from None
        return message

    def _lost(self) -> RelforestError:
        status = self.process.wait()
        how = f"signal {signal.Signals(-status).name}" if status < 0 else f"exit status {status}"
        remedy = "; if memory is short, use fewer jobs" if status == -signal.SIGKILL else ""
        return RelforestError(f"a worker process ended with {how} before its task was done{remedy}")


@contextmanager
def _pool(count: int) -> Iterator[list[Worker]]:
    with ExitStack() as stack:
        workers = [stack.enter_context(new_worker(number)) for number in range(1, count + 1)]
        yield workers
        # Closing the connections ends all processes at the same time.
        for worker in workers:
            worker.connection.close()
        for worker in workers:
            with suppress(subprocess.TimeoutExpired):
                worker.process.wait(_SECONDS_TO_END)


@contextmanager
def new_worker(number: int = 1, environment: Mapping[str, str] | None = None) -> Iterator[Worker]:
    """Start a process that runs tasks until the ``with`` block ends.

    By default it has the environment variables of this process; in a pool, it has a number.
    """
    ours, theirs = Pipe()
    with ours, theirs:
        process = start(
            _SERVE,
            [str(theirs.fileno())],
            pass_fds=[theirs.fileno()],
            stdin=subprocess.DEVNULL,
            env=environment,
        )
        theirs.close()
        try:
            worker = Worker(number, process, ours)
            worker.give(sys.path)
            yield worker
        finally:
            process.kill()
            process.wait()


def _portable(error: Exception) -> Exception:
    """Return an error that can be pickled, with its traceback as a note."""
    try:
        ForkingPickler.loads(ForkingPickler.dumps(error))
    except Exception:  # noqa: BLE001 - errors may contain any object
        error = RelforestError(f"{type(error).__name__}: {error}")
    error.add_note(f"In a worker process:\n{''.join(traceback.format_exception(error))}")
    return error
