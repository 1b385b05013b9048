from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path
from typing import Any

import pytest

from cli.command_lines import CommandLine
from relforest.experiments import runner
from relforest.experiments.claims import Claim, Findings
from relforest.experiments.registry import STUDIES


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch) -> dict[str, Any]:
    """Replace the work of every study; returns what it was asked for."""
    options: dict[str, Any] = {}

    def run_study(study: Any, out: Path, **others: Any) -> Findings:
        options.update(others, study=study.name, out=out)
        others["on_progress"](f"{study.name}: 1 of 1 done")
        return Findings("a table", (Claim("a score", 0.5, low=0.9), Claim("another", 0.5)))

    monkeypatch.setattr(runner, "run_study", run_study)
    return options


def test_studies_are_listed_where_none_is_named(run: CommandLine) -> None:
    outcome = run("experiment")

    assert (outcome.code, outcome.err) == (0, "")
    assert [line.split()[0] for line in outcome.out.splitlines()] == list(STUDIES)
    assert all(study.question in outcome.out for study in STUDIES.values())


def test_unknown_studies_are_refused_with_those_there_are(run: CommandLine) -> None:
    outcome = run("experiment", "corridr")

    assert (outcome.code, outcome.err) == (2, "relforest: unknown study 'corridr': did you mean corridor?\n")


def test_a_missed_bound_is_a_failure(run: CommandLine, asked: dict[str, Any], tmp_path: Path) -> None:
    outcome = run("experiment", "corridor", "--seed", "3", "--jobs", "2", "--out", tmp_path)

    assert outcome.code == 1
    assert outcome.out.startswith("a table\n\nClaims\nMISSED a score: 0.5")
    assert "corridor: 1 of 1 done" in outcome.err
    assert outcome.err.endswith("relforest: 1 of 2 claims missed\n")
    del asked["on_progress"]
    assert asked == {
        "study": "corridor",
        "out": tmp_path,
        "seed": 3,
        "n_jobs": 2,
        "smoke": False,
        "only": {"methods": (), "datasets": ()},
    }


def test_methods_and_data_sets_are_named_with_commas_or_spaces(
    run: CommandLine, asked: dict[str, Any]
) -> None:
    run("experiment", "mil", "--methods", "covagg,dd", "apr", "--datasets", "musk1,")

    assert asked["only"] == {"methods": ("covagg", "dd", "apr"), "datasets": ("musk1",)}


def test_choices_of_other_studies_are_refused(run: CommandLine, tmp_path: Path) -> None:
    outcome = run("experiment", "corridor", "--datasets", "musk1", "--out", tmp_path / "out")

    assert outcome.code == 1
    assert "the study corridor does not offer a choice of datasets: omit it" in outcome.err
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("arguments", "folder"), [((), "runs/concepts"), (("--smoke",), "runs/concepts-smoke")]
)
def test_results_go_to_a_folder_of_their_study(
    run: CommandLine, asked: dict[str, Any], arguments: tuple[str, ...], folder: str
) -> None:
    outcome = run("experiment", "concepts", *arguments)

    assert asked["out"] == Path(folder)
    # The numbers of a smoke run mean nothing, so it cannot fail by them.
    assert outcome.code == (0 if arguments else 1)


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        (("--seed", "-1"), "seed must be an integer of at least 0, got -1"),
        (("--jobs", "0"), "--jobs must be a positive integer, or -1 for all cores, got 0"),
    ],
)
def test_bad_options_are_one_clear_line(
    run: CommandLine, asked: dict[str, Any], arguments: tuple[str, ...], complaint: str
) -> None:
    outcome = run("experiment", "corridor", *arguments)

    assert outcome.code == 2
    assert complaint in outcome.err
    assert asked == {}


def test_sizes_reach_the_study(run: CommandLine, monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[Any] = []

    def run_study(study: Any, _out: Path, **_others: Any) -> Findings:
        asked.extend(study.settings)
        return Findings("")

    monkeypatch.setattr(runner, "run_study", run_study)
    assert run("experiment", "corridor", "--runs", "2", "--iterations", "3", "--episodes", "7").code == 0
    assert {(setting.runs, setting.iterations, setting.episodes) for setting in asked} == {(2, 3, 7)}
    assert len(asked) == 8


def test_a_study_without_runs_refuses_to_change_them(run: CommandLine, asked: dict[str, Any]) -> None:
    outcome = run("experiment", "concepts", "--runs", "3")

    assert outcome.code == 1
    assert "the number of runs of the study concepts cannot be chosen: omit it" in outcome.err
    assert not asked


def test_an_address_where_nobody_answers_is_an_error(run: CommandLine, asked: dict[str, Any]) -> None:
    missing, silent = "'distributed', which is not installed", "no Dask scheduler answers at 'nowhere'"
    outcome = run("experiment", "corridor", "--dask", "nowhere")

    assert outcome.code == 1
    assert (silent if find_spec("distributed") else missing) in outcome.err
    assert not asked
