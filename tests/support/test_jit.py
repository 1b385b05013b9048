from __future__ import annotations

import inspect
import io
import multiprocessing
import os
import subprocess
import sys
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import final

import numba
import numpy as np
import pytest
from numba.core.registry import cpu_target

from relforest.support import jit
from relforest.support.jit import _candidates, _KernelCache, kernel
from relforest.support.progress import Stage, listening


@kernel
def ratio(numerator: float, denominator: float) -> float:
    """Divide."""
    return numerator / denominator


def test_a_kernel_computes_what_its_python_says() -> None:
    assert ratio(np.float64(3.0), np.float64(4.0)) == 0.75


def test_a_kernel_keeps_its_name_and_documentation() -> None:
    assert ratio.__name__ == "ratio"
    assert inspect.getdoc(ratio) == "Divide."


@pytest.mark.skipif(
    os.environ.get("NUMBA_DISABLE_JIT") == "1", reason="only compiled kernels divide like this"
)
def test_a_compiled_kernel_divides_by_zero_like_numpy() -> None:
    assert ratio(1.0, 0.0) == np.inf


def test_a_change_anywhere_in_the_package_starts_a_new_cache(tmp_path: Path) -> None:
    (tmp_path / "caller.py").write_text("from callee import f", encoding="utf-8")
    (tmp_path / "callee.py").write_text("f = 1", encoding="utf-8")
    before = list(_candidates(tmp_path))

    assert list(_candidates(tmp_path)) == before
    (tmp_path / "callee.py").write_text("f = 2", encoding="utf-8")
    assert not set(_candidates(tmp_path)) & set(before)


def test_the_cache_is_in_the_package_or_else_at_home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(numba.config, "CACHE_DIR", "")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    folders = list(_candidates(tmp_path / "package"))
    monkeypatch.setattr(Path, "home", homeless)

    assert [folder.parent for folder in folders] == [
        tmp_path / "package" / "__pycache__",
        tmp_path / "cache" / "relforest",
    ]
    monkeypatch.delenv("XDG_CACHE_HOME")
    assert list(_candidates(tmp_path / "package")) == folders[:1]


def test_the_cache_goes_where_numba_is_told_to_keep_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(numba.config, "CACHE_DIR", str(tmp_path / "elsewhere"))

    assert [folder.parent for folder in _candidates(tmp_path)] == [tmp_path / "elsewhere"]


def homeless() -> Path:
    raise RuntimeError("Could not determine home directory.")


SCRIPT = """
import sys, warnings
from kernels_of_a_test import double
from relforest.support.progress import listening
heard = []
with listening(heard.append):
    assert double(2.0) == 4.0 and double(2) == 4 and double(2 + 0j) == 4
print([str(stage) for stage in heard])
"""
KERNELS = """
from relforest.support.jit import inlined, kernel
@inlined
def twice(x): return 2 * x
@kernel
def double(x): return twice(x)
"""


@pytest.fixture
def compiling(tmp_path: Path) -> Callable[[Path], tuple[str, str]]:
    """Return a function that runs a kernel in a new process with a cache folder of its own."""
    (tmp_path / "kernels_of_a_test.py").write_text(KERNELS)
    path = os.pathsep.join([str(tmp_path), os.environ.get("PYTHONPATH", "")])

    def run(cache: Path) -> tuple[str, str]:
        environment = os.environ | {
            "NUMBA_CACHE_DIR": str(cache),
            "PYTHONPATH": path,
            "NUMBA_DISABLE_JIT": "0",
        }
        done = subprocess.run(
            [sys.executable, "-c", SCRIPT], env=environment, capture_output=True, text=True, check=True
        )
        return done.stdout, done.stderr

    return run


def test_compiling_is_reported_once_and_loading_is_not(
    compiling: Callable[[Path], tuple[str, str]], tmp_path: Path
) -> None:
    cache = tmp_path / "cache"

    assert compiling(cache) == ("['compiling, the first time only']\n", "")
    assert compiling(cache) == ("[]\n", "")

    for file in cache.rglob("*.nbi"):
        file.write_bytes(b"damaged")
    assert compiling(cache) == ("['compiling, the first time only']\n", "")
    assert compiling(cache) == ("[]\n", "")


def test_without_a_writable_folder_kernels_are_compiled_with_one_warning(
    compiling: Callable[[Path], tuple[str, str]], tmp_path: Path
) -> None:
    (tmp_path / "file").write_text("not a folder")
    heard, warned = compiling(tmp_path / "file")

    assert heard == "['compiling, without a cache']\n"
    assert warned.count("RuntimeWarning: compiled code cannot be kept") == 1
    assert "Not a directory), so every process compiles it again; set NUMBA_CACHE_DIR to" in warned


@pytest.fixture(autouse=True)
def fresh(monkeypatch: pytest.MonkeyPatch) -> None:
    """Forget what this process knows of the cache, and what it has said."""
    for name in ("_announce_compiling", "_cache_folder", "_warn_of_missing_cache"):
        monkeypatch.setattr(jit, name, cache(getattr(jit, name).__wrapped__))


@final
class BadDisk:
    """A cache that cannot be read or written."""

    cache_path = "somewhere"

    def __init__(self) -> None:
        self.is_flushed = False

    def load_overload(self, *_: object) -> None:
        raise EOFError("Ran out of input")

    def save_overload(self, *_: object) -> None:
        raise OSError(28, "No space left on device")

    def flush(self) -> None:
        self.is_flushed = True


def plain() -> None:
    """Do nothing."""


def test_code_is_looked_for_in_the_folder_of_the_cache(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(numba.config, "CACHE_DIR", str(tmp_path))
    heard: list[Stage] = []
    code = _KernelCache(plain)
    with listening(heard.append):
        assert code.load_overload((), cpu_target.target_context) is None
        assert code.load_overload((), cpu_target.target_context) is None
    code.flush()

    assert str(code.cache_path).startswith(str(tmp_path / "relforest-"))
    assert vars(numba.config)["CACHE_DIR"] == str(tmp_path)
    assert [str(stage) for stage in heard] == ["compiling, the first time only"]


def test_damaged_code_is_compiled_anew() -> None:
    code, disk = _KernelCache(plain), BadDisk()
    vars(code)["_disk"] = disk
    with listening(lambda _: None):
        assert code.load_overload((), None) is None

    assert disk.is_flushed


def test_a_full_disk_is_a_warning() -> None:
    code = _KernelCache(plain)
    vars(code)["_disk"] = BadDisk()

    with pytest.warns(
        RuntimeWarning, match=r"cannot be kept \(somewhere: No space left on device\), so every"
    ):
        code.save_overload((), None)


def test_code_without_a_file_or_a_folder_is_not_kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(numba.config, "CACHE_DIR", str(tmp_path))
    assert _KernelCache(eval("lambda: 0")).cache_path is None  # noqa: S307

    (tmp_path / "file").touch()
    monkeypatch.setattr(numba.config, "CACHE_DIR", str(tmp_path / "file"))
    jit._cache_folder.cache_clear()
    code = _KernelCache(plain)
    assert code.cache_path is None
    with pytest.warns(RuntimeWarning, match="set NUMBA_CACHE_DIR to a writable folder"):
        assert code.load_overload((), None) is None
    code.save_overload((), None)


@pytest.mark.parametrize(
    ("is_terminal", "text"), [(True, "relforest: compiling, the first time only\n"), (False, "")]
)
def test_compiling_is_announced_on_a_terminal_that_nobody_else_writes_to(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, *, is_terminal: bool, text: str
) -> None:
    monkeypatch.setattr(numba.config, "CACHE_DIR", str(tmp_path))
    stream = io.StringIO()
    monkeypatch.setattr(stream, "isatty", lambda: is_terminal)
    monkeypatch.setattr(sys, "stderr", stream)
    jit._announce_compiling()

    assert stream.getvalue() == text


def test_workers_and_processes_without_standard_error_are_silent(monkeypatch: pytest.MonkeyPatch) -> None:
    with monkeypatch.context() as context:
        context.setattr(sys, "stderr", None)
        assert not jit._is_watched()
    monkeypatch.setattr(multiprocessing, "parent_process", object)
    assert not jit._is_watched()
