"""The scripts in `examples/` and the examples in docstrings run as shown; for pages see `test_pages.py`."""

from __future__ import annotations

import doctest
import importlib
import os
import pkgutil
import runpy
from pathlib import Path

import pytest

import relforest

ROOT = Path(__file__).parents[1]
EXAMPLES = sorted((ROOT / "examples").glob("*.py"))
SHORT = {"moving_worlds": ["1.0"]}
"""Arguments with which a script does less."""
MODULES = sorted(module.name for module in pkgutil.walk_packages(relforest.__path__, "relforest."))

pytestmark = pytest.mark.skipif(
    os.environ.get("NUMBA_DISABLE_JIT") == "1", reason="full-size examples take minutes without compilation"
)


@pytest.mark.parametrize("script", EXAMPLES, ids=lambda script: script.stem)
def test_example_scripts_print_something(
    script: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(str(script.parent))
    monkeypatch.setattr("sys.argv", [str(script), *SHORT.get(script.stem, [])])
    runpy.run_path(str(script), run_name="__main__")
    assert capsys.readouterr().out.strip()


@pytest.mark.parametrize("name", MODULES)
def test_docstring_examples_hold(name: str) -> None:
    results = doctest.testmod(
        importlib.import_module(name), optionflags=doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE
    )
    assert results.failed == 0
