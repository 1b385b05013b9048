from __future__ import annotations

from pathlib import Path

import pytest

from cli.command_lines import COLUMNS, CommandLine, passes, write
from relforest.cli.app import main


@pytest.fixture
def run(capsys: pytest.CaptureFixture[str]) -> CommandLine:
    return CommandLine(capsys)


@pytest.fixture(scope="session")
def table(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Passes as a Parquet file."""
    return write(passes(), tmp_path_factory.mktemp("table") / "passes.parquet")


@pytest.fixture(scope="session")
def model(table: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Model file learned from `table`."""
    out = tmp_path_factory.mktemp("model") / "tree.json"
    assert main(["fit", str(table), *COLUMNS, "--label", "completed", "--out", str(out)]) == 0
    return out
