"""A few damaged files of every format; ``tests/fuzz_files.py`` reads as many as one likes."""

from __future__ import annotations

import pytest

from fuzz_files import run_cases
from fuzz_formats import FORMATS

CASES = 12


@pytest.mark.parametrize("name", FORMATS)
def test_damaged_files_are_read_or_refused_in_our_words(name: str) -> None:
    found = run_cases(name, 0, range(CASES))

    assert found.findings == ()
    assert found.fine + found.refused == CASES
