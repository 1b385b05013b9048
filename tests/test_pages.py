"""The documentation is true: code prints what is shown, commands exist, every public name has a page.

A comment ``<!-- setup ... -->`` in a page holds code that readers need not see, such as the table they have.
"""

from __future__ import annotations

import doctest
import os
import re
import runpy
import shlex
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow.parquet as pq
import pytest

from relforest import cli, datasets
from relforest.cli.app import Command, command_named, main
from relforest.datasets import BagSet, covariant2

ROOT = Path(__file__).parents[1]
PAGES = [
    ROOT / "README.md",
    *sorted((ROOT / "docs").rglob("*.md")),
    *sorted((ROOT / "src").rglob("README.md")),
]
TEXTS = {page.relative_to(ROOT).as_posix(): page.read_text("utf-8") for page in PAGES}
OUTPUT = r"(?:\n\n```\n(?!relforest |\$ )(.*?)```)?"
CODE = re.compile(rf"(?:<!-- setup\n(.*?)-->|```python\n(.*?)```){OUTPUT}", re.DOTALL)
CONSOLE = re.compile(r"```\n(\$ relforest (?:fit|predict) .*?)```", re.DOTALL)
BLOCK = re.compile(r"^```\n(.*?)^```|^ {4}(relforest [^\n]*)$", re.DOTALL | re.MULTILINE)
PLACEHOLDER = re.compile(r"\b[A-Z]{3,}\b")

compiled = pytest.mark.skipif(
    os.environ.get("NUMBA_DISABLE_JIT") == "1", reason="full-size examples take minutes without compilation"
)


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(str(ROOT / "examples"))
    # Published data sets are not at hand; what their scores are is not checked.
    drawn = covariant2(np.random.default_rng(0))
    few = BagSet(drawn.bags[::4], drawn.labels[::4], about=datasets.CATALOGUE["musk1"])
    monkeypatch.setattr(datasets, "fetch_musk1", lambda: few, raising=False)
    return tmp_path


@compiled
@pytest.mark.parametrize("page", [page for page, text in TEXTS.items() if "```python" in text])
@pytest.mark.usefixtures("folder")
def test_code_prints_what_is_shown(page: str, capsys: pytest.CaptureFixture[str]) -> None:
    variables: dict[str, Any] = {}
    for setup, code, shown in CODE.findall(TEXTS[page]):
        if "import dask" in code and find_spec("dask") is None:
            continue
        exec(compile(setup or code, page, "exec"), variables)  # noqa: S102 - our own documentation
        printed = capsys.readouterr().out
        if shown and "fetch_" not in code:
            assert printed == shown


@compiled
@pytest.mark.parametrize("page", ["README.md", "docs/forests.md"])
def test_commands_print_what_is_shown(page: str, folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    passes = runpy.run_path(str(ROOT / "examples" / "make_passes.py"))["passes"]
    pq.write_table(passes(600, seed=0), folder / "passes.parquet")
    consoles = CONSOLE.findall(TEXTS[page])
    assert consoles
    for console in consoles:
        for part in re.split(r"^\$ ", console, flags=re.MULTILINE)[1:]:
            command, _, shown = part.replace("\\\n", " ").partition("\n")
            assert main(shlex.split(command)[1:]) == 0
            printed = capsys.readouterr().out
            flags = doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE
            assert doctest.OutputChecker().check_output(shown, printed, flags), printed


@pytest.mark.parametrize("page", [page for page, text in TEXTS.items() if BLOCK.search(text)])
def test_commands_exist(page: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(
        cli.app, "command_named", lambda name: Command(command_named(name).options, lambda _: 0)
    )
    # The files and run folders that commands read are not there.
    monkeypatch.setattr(cli.app, "check_options", lambda *_: None)
    for parts in BLOCK.findall(TEXTS[page].replace("\\\n", " ")):
        lines = "".join(parts).splitlines()
        prompt = "" if all(line.startswith("relforest ") for line in lines) else "$ "
        for line in lines:
            if line.startswith(f"{prompt}relforest "):
                words = PLACEHOLDER.sub("mil", line.removeprefix(prompt))
                assert main(shlex.split(words, comments=True)[1:]) == 0, line


def test_every_public_name_has_a_place_in_the_reference() -> None:
    reference = runpy.run_path(str(ROOT / "docs" / "site" / "reference.py"))
    stubs = {
        ".".join(stub.relative_to(ROOT / "src").parts[:-1]) for stub in (ROOT / "src").rglob("__init__.pyi")
    }
    modules = set(reference["modules"]())
    assert modules >= stubs
    texts = {module: reference["page"](module) for module in modules}
    for module in stubs:
        for name in reference["exports"](module):
            documented = f"::: {module}.{name}\n" in texts[module]
            link = re.search(rf"\[`{name}`\]\((\S+?)\.md(?:#(\S+))?\)", texts[module])
            assert documented != bool(link), f"{module}.{name}"
            if link and link[2]:
                home = link[2].rpartition(".")[0]
                assert any(f"::: {place}\n" in texts[home] for place in (link[2], home))
