"""The one way to compile a function in relforest."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar, cast

import numba

Function = TypeVar("Function", bound=Callable[..., object])


def inlined(function: Function) -> Function:
    """Compile ``function`` into each of its callers: for the steps of an inner loop.

    A call between kernels counts the references of every array passed, which takes longer than a short step.

    Parameters
    ----------
    function : callable
        As for `kernel`, called by kernels.

    Returns
    -------
    callable
        A drop-in replacement.
    """
    compiled = numba.njit(cache=True, nogil=True, error_model="numpy", inline="always")(function)
    return cast("Function", compiled)


def kernel(function: Function) -> Function:
    """Compile ``function`` with Numba on its first call, and keep the machine code on disk.

    Kernels release the GIL, so threads run them side by side, and divide like NumPy (x / 0 is inf or NaN,
    not an exception). With ``NUMBA_DISABLE_JIT=1`` the function itself is returned: a division by zero then
    raises or warns, and unsigned integers no longer wrap silently, so a kernel must not rely on either.

    Parameters
    ----------
    function : callable
        A module-level function in the subset of Python that Numba compiles.

    Returns
    -------
    callable
        A drop-in replacement; type checkers see the type of ``function``.
    """
    return cast("Function", numba.njit(cache=True, nogil=True, error_model="numpy")(function))
