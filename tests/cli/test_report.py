from __future__ import annotations

from pathlib import Path

from cli.command_lines import CommandLine
from experiments.run_folders import SMALL
from relforest.experiments.runs import learn_runs


def test_a_page_is_written_once_unless_forced(run: CommandLine, tmp_path: Path) -> None:
    learn_runs(SMALL, tmp_path / "run")
    page = tmp_path / "report.html"
    command = ("report", tmp_path / "run", "--out", page, "--episodes", "1", "--title", "Corridor & co")

    outcome = run(*command)
    assert (outcome.code, outcome.err.splitlines()[-1]) == (0, f"wrote {page}")
    assert "<h1>Corridor &amp; co</h1>" in page.read_text("utf-8")
    assert "exists already" in run(*command).err
    assert run(*command, "--force").code == 0


def test_nothing_is_written_if_one_folder_is_no_result(run: CommandLine, tmp_path: Path) -> None:
    outcome = run("report", tmp_path, "--out", tmp_path / "report.html")
    assert outcome.code == 1
    assert "neither a study nor a run" in outcome.err
    assert not (tmp_path / "report.html").exists()
