from __future__ import annotations

import inspect
import os
from pathlib import Path

import numba
import numpy as np
import pytest

from relforest.support.jit import _cache_folder, kernel


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
    before = _cache_folder(tmp_path)

    assert _cache_folder(tmp_path) == before
    (tmp_path / "callee.py").write_text("f = 2", encoding="utf-8")
    assert _cache_folder(tmp_path) != before


def test_the_cache_goes_where_numba_is_told_to_keep_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(numba.config, "CACHE_DIR", str(tmp_path / "elsewhere"))

    assert Path(_cache_folder(tmp_path)).parent == tmp_path / "elsewhere"


def test_a_package_that_cannot_be_written_to_has_its_cache_at_home(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(numba.config, "CACHE_DIR", "")
    monkeypatch.setattr(os, "access", lambda *_: False)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))

    assert Path(_cache_folder(tmp_path)).parent == tmp_path / "cache" / "relforest"
