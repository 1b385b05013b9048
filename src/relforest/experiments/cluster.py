"""Tasks of a study on a Dask cluster, instead of in processes of this machine."""

from __future__ import annotations

import asyncio
from collections.abc import Iterator
from contextlib import contextmanager
from importlib.util import find_spec
from typing import Any, Final

import joblib

from relforest.runs.manifest import differences, versions
from relforest.support.errors import InputError, RelforestError

_SECONDS_TO_ANSWER: Final = 5.0


@contextmanager
def on_cluster(address: str | None, n_jobs: int = 1) -> Iterator[int]:
    """Send the tasks of `relforest.support.parallel.run_tasks` to a Dask cluster while the block runs.

    Parameters
    ----------
    address : str or None
        Of its scheduler, such as ``"tcp://10.0.0.5:8786"``; None leaves tasks where they are.
    n_jobs : int
        How many tasks run at the same time without a cluster.

    Yields
    ------
    int
        How many tasks run at the same time.

    Raises
    ------
    InputError
        If Dask is not installed, no scheduler answers at the address, or it has no workers, or some with
        other versions of the software that results depend on.
    RelforestError
        If the cluster is lost.
    """
    if address is None:
        yield n_jobs
        return
    if find_spec("distributed") is None:
        raise InputError("a Dask cluster needs the package 'distributed', which is not installed: install it")
    from distributed import CancelledError, Client, KilledWorker  # noqa: PLC0415 - optional
    from distributed.comm import CommClosedError  # noqa: PLC0415

    if not _threads_at(address):
        raise InputError(f"the Dask cluster at {address!r} has no workers: start some with 'dask worker'")
    with Client(address) as client, joblib.parallel_config("dask"):
        here = versions()
        for worker, there in client.run(versions, on_error="return").items():
            if differing := differences(there, here, "versions"):
                raise InputError(
                    f"the worker {worker} has other software: {'; '.join(differing)}; install the same"
                )
        try:
            # One job means this process, and some tasks can only be split.
            yield max(2, sum(client.ncores().values()))
        except (CancelledError, CommClosedError, KilledWorker) as error:
            raise RelforestError(
                f"the Dask cluster was lost ({type(error).__name__}); what was done is kept, and the same "
                "command resumes it"
            ) from error


def _threads_at(address: str) -> int:
    """Return the number of threads of the workers of a scheduler."""
    from distributed import rpc  # noqa: PLC0415 - optional

    async def identity() -> dict[str, Any]:
        async with rpc(address, timeout=_SECONDS_TO_ANSWER) as remote:
            found: dict[str, Any] = await remote.identity()
            return found

    try:
        found = asyncio.run(asyncio.wait_for(identity(), _SECONDS_TO_ANSWER))
    except (OSError, ValueError, TimeoutError) as error:
        reason = str(error) or f"nothing came within {_SECONDS_TO_ANSWER:.0f} s"
        raise InputError(
            f"no Dask scheduler answers at {address!r}: {reason}; start one with 'dask scheduler', or name "
            "another address"
        ) from error
    if found["type"] != "Scheduler":
        raise InputError(
            f"{address!r} is the address of a Dask {found['type'].lower()}: name its scheduler's"
        )
    return sum(int(worker["nthreads"]) for worker in found["workers"].values())
