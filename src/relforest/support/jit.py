"""The one way to compile a function in relforest.

Numba keeps machine code on disk and renews it when the file of a function changes, but not when a function
that it calls changes in another file. A library whose kernels call each other across files would run old code
after an upgrade, so the cache folder is named after the content of the whole package. If no folder can be
written to, every process compiles its kernels, and warns once.
"""

from __future__ import annotations

import multiprocessing
import os
import sys
import tempfile
import warnings
from collections.abc import Callable, Iterator
from contextlib import suppress
from functools import cache, cached_property
from pathlib import Path
from typing import Any, Final, Literal, TypeVar, cast, final

import numba
from numba.core.caching import FunctionCache, NullCache

from relforest.support.files import content_digest
from relforest.support.progress import COMPILING, is_heard, report

Function = TypeVar("Function", bound=Callable[..., object])

_PACKAGE: Final = Path(__file__).parents[1]


def inlined(function: Function) -> Function:
    """Compile ``function`` into each of its callers, for the steps of inner loops.

    A call between kernels counts references to every array passed, which takes longer than a short step.
    Functions are as for `kernel`, and are called by kernels.
    """
    return _compiled(function, inline="always")


def kernel(function: Function) -> Function:
    """Compile ``function`` with Numba on its first call, and keep the machine code on disk.

    Kernels release the GIL, so threads run them in parallel, and divide like NumPy (x / 0 is inf or NaN, not
    an exception). With ``NUMBA_DISABLE_JIT=1`` the function itself is returned; division by zero then raises
    or warns and unsigned integers no longer wrap silently, so kernels must not rely on either. Only functions
    of modules can be kernels, in the subset of Python that Numba compiles.
    """
    return _compiled(function, inline="never")


def _compiled(function: Function, *, inline: Literal["never", "always"]) -> Function:
    compiled = numba.njit(nogil=True, error_model="numpy", inline=inline)(function)
    if not vars(numba.config)["DISABLE_JIT"]:
        vars(compiled)["_cache"] = _KernelCache(function)  # where `njit(cache=True)` puts its own
    return cast("Function", compiled)


@final
class _KernelCache(NullCache):
    """The machine code of one function on disk, looked up when the function is first called.

    With a damaged file or a full disk, the function is compiled and the call succeeds.
    """

    def __init__(self, function: Callable[..., object]) -> None:
        self._function = function

    @cached_property
    def _disk(self) -> Any:  # noqa: ANN401 - a class of Numba's
        folder, _ = _cache_folder()
        if folder is None:
            return NullCache()
        # Numba takes the folder of a function's cache from this setting.
        settings = vars(numba.config)
        previous = settings["CACHE_DIR"]
        settings["CACHE_DIR"] = folder
        try:
            return FunctionCache(self._function)  # type: ignore[no-untyped-call]
        except (OSError, RuntimeError):
            return NullCache()
        finally:
            settings["CACHE_DIR"] = previous

    @property
    def cache_path(self) -> str | None:
        return cast("str | None", self._disk.cache_path)

    def load_overload(self, sig: object, target_context: object) -> object:
        try:
            loaded: object = self._disk.load_overload(sig, target_context)
        except Exception:  # noqa: BLE001 - a damaged pickle raises anything
            loaded = None
            with suppress(Exception):
                self._disk.flush()
        if loaded is None:
            _announce_compiling()
        return loaded

    def save_overload(self, sig: object, data: object) -> None:
        try:
            self._disk.save_overload(sig, data)
        except OSError as error:
            _warn_of_missing_cache(f"{self.cache_path}: {error.strerror}")

    def flush(self) -> None:
        self._disk.flush()


@cache
def _cache_folder() -> tuple[str | None, str]:
    """Return the folder for machine code of this version of the package; if there is none, None and why."""
    reasons = []
    for folder in _candidates(_PACKAGE):
        try:
            folder.mkdir(parents=True, exist_ok=True)
            with tempfile.TemporaryFile(dir=folder):
                return str(folder), ""
        except OSError as error:
            reasons.append(f"{folder}: {error.strerror}")
    return None, "; ".join(reasons)


def _candidates(package: Path) -> Iterator[Path]:
    """Yield possible cache folders: the one the user has chosen, or else in the package and at home."""
    name = f"relforest-{content_digest(sorted(package.rglob('*.py')))}"
    chosen = vars(numba.config)["CACHE_DIR"]
    if chosen:
        yield Path(chosen) / name
        return
    yield package / "__pycache__" / name
    # A user without an entry in the password database may have no home folder.
    with suppress(RuntimeError):
        yield Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "relforest" / name


@cache
def _announce_compiling() -> None:
    """Report, once in a process, that kernels are being compiled, which may take a minute."""
    folder, reason = _cache_folder()
    text = f"{COMPILING}, the first time only" if folder else f"{COMPILING}, without a cache"
    if folder is None:
        _warn_of_missing_cache(reason)
    if is_heard():
        report(text)
    elif folder and _is_watched():
        sys.stderr.write(f"relforest: {text}\n")


@cache
def _warn_of_missing_cache(reason: str) -> None:
    warnings.warn(
        f"compiled code cannot be kept ({reason}), so every process compiles it again; set NUMBA_CACHE_DIR "
        "to a writable folder",
        RuntimeWarning,
        stacklevel=2,
    )


def _is_watched() -> bool:
    """Return whether someone may be reading standard error; workers leave messages to their parent."""
    if sys.stderr is None or multiprocessing.parent_process() is not None:
        return False
    return sys.stderr.isatty() or hasattr(sys, "ps1")


@inlined
def hold(first: object, second: object) -> None:
    """Do nothing with two arrays, at the end of an inlined function that uses them in branches with loops.

    Numba drops an array after its last use. If every branch has its own last use, or returns by itself, the
    references are counted in every call, which may take longer than the rest of the function.
    """
