"""The one way to compile a function in relforest.

Numba keeps machine code on disk and renews it when the file of a function changes, but not when a function
that it calls does, in another file. A library whose kernels call each other across files would run old code
after an upgrade. So the cache is kept in a folder named for the content of the whole package.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import Literal, TypeVar, cast

import numba

from relforest.support.files import content_digest

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
    return _compiled(function, inline="always")


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
    return _compiled(function, inline="never")


def _compiled(function: Function, *, inline: Literal["never", "always"]) -> Function:
    # Numba fixes a function's cache when it is decorated, from this setting.
    settings = vars(numba.config)
    previous = settings["CACHE_DIR"]
    settings["CACHE_DIR"] = _CACHE
    try:
        compiled = numba.njit(cache=True, nogil=True, error_model="numpy", inline=inline)(function)
    finally:
        settings["CACHE_DIR"] = previous
    return cast("Function", compiled)


def _cache_folder(package: Path) -> str:
    """Where machine code of this very version of the package is kept."""
    name = f"relforest-{content_digest(sorted(package.rglob('*.py')))}"
    chosen = vars(numba.config)["CACHE_DIR"]
    if chosen:
        return str(Path(chosen) / name)
    if os.access(package, os.W_OK):
        return str(package / "__pycache__" / name)
    home = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    return str(Path(home) / "relforest" / name)


_CACHE = _cache_folder(Path(__file__).parents[1])
