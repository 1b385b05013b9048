from __future__ import annotations

import inspect
import os

import numpy as np
import pytest

from relforest.support.jit import kernel


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
