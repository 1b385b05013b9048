"""Every estimator learns in several threads what it learns alone, and leaves the process as it was."""

from __future__ import annotations

import pytest

from interpreted import compiled_only
from thread_check import LEARNERS, differences


@compiled_only
@pytest.mark.parametrize("name", LEARNERS)
def test_fits_in_threads_equal_fits_alone(name: str) -> None:
    assert differences(LEARNERS[name], 2) == []
