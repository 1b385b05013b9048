"""Compiling the twin of the keepaway players, which is too slow to compare many cycles otherwise."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TypeVar, cast

import numba

from relforest.support.files import content_digest

Function = TypeVar("Function", bound=Callable[..., object])

# Numba does not see changes of a called function in another file, so machine code is kept in a folder that is
# named for the content of all files of the twin.
_HERE = Path(__file__).resolve().parent
_CACHE = _HERE / "__pycache__" / f"keepaway-{content_digest(sorted(_HERE.glob('keepaway*.py')))}"


def kernel(function: Function) -> Function:
    """Compile ``function`` on its first call; with ``NUMBA_DISABLE_JIT=1`` it is returned as it is."""
    settings = vars(numba.config)
    previous = settings["CACHE_DIR"]
    settings["CACHE_DIR"] = str(_CACHE)
    try:
        compiled = numba.njit(cache=True, nogil=True, error_model="numpy")(function)
    finally:
        settings["CACHE_DIR"] = previous
    return cast("Function", compiled)
