"""Tests that are too slow where kernels run as plain Python, as they do to measure coverage."""

from __future__ import annotations

import os
from typing import Final

import pytest

INTERPRETED: Final = os.environ.get("NUMBA_DISABLE_JIT") == "1"

compiled_only = pytest.mark.skipif(INTERPRETED, reason="takes too long without compilation")
"""For tests of what is built on kernels that have tests of their own: whole programs, estimators, worlds."""
