"""The scripts in `examples/`, the examples in docstrings and the code in the documentation run as shown."""

from __future__ import annotations

import doctest
import importlib
import os
import pkgutil
import re
import runpy
from pathlib import Path

import pytest

import relforest

ROOT = Path(__file__).parents[1]
EXAMPLES = sorted((ROOT / "examples").glob("*.py"))
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
    monkeypatch.setattr("sys.argv", [str(script)])
    runpy.run_path(str(script), run_name="__main__")
    assert capsys.readouterr().out.strip()


@pytest.mark.parametrize("name", MODULES)
def test_docstring_examples_hold(name: str) -> None:
    results = doctest.testmod(
        importlib.import_module(name), optionflags=doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE
    )
    assert results.failed == 0


def test_the_recipes_for_extensions_give_what_they_say(capsys: pytest.CaptureFixture[str]) -> None:
    text = (ROOT / "docs" / "extending.md").read_text(encoding="utf-8")
    blocks = re.findall(r"```python\n(.*?)```", text, re.DOTALL)
    for code in blocks:
        exec(compile(code, "extending.md", "exec"), {})  # noqa: S102 - our own documentation
    shown = re.findall(r"#\s+(\[.*\])", blocks[0])
    assert capsys.readouterr().out.split() == shown[0].split()


@pytest.mark.parametrize(("page", "count"), [("multiple-instance-learning", 2), ("q-learning", 1)])
def test_pages_show_what_their_code_prints(page: str, count: int, capsys: pytest.CaptureFixture[str]) -> None:
    text = (ROOT / "docs" / f"{page}.md").read_text(encoding="utf-8")
    pairs = re.findall(r"```python\n([^`]*)```\n\n```\n([^`]*)```", text)
    # Published data sets may not be at hand.
    own = [(code, output) for code, output in pairs if "fetch_" not in code]
    variables: dict[str, object] = {}
    for code, output in own:
        exec(compile(code, f"{page}.md", "exec"), variables)  # noqa: S102 - our own
        assert capsys.readouterr().out == output
    assert len(own) == count
