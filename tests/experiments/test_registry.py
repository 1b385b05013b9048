from __future__ import annotations

from pathlib import Path

import pytest

import relforest.experiments
from relforest.experiments.registry import STUDIES
from relforest.experiments.runner import run_study

FOLDER = Path(relforest.experiments.__file__).parent


def folder_of(name: str) -> Path:
    """One package is a study for each of several tasks."""
    return FOLDER / ("learning" if name.endswith("-learning") else name)


def test_every_folder_with_settings_is_a_study() -> None:
    folders = {path.parent for path in FOLDER.glob("*/settings.py")}

    assert set(map(folder_of, STUDIES)) == folders
    assert [study.name for study in STUDIES.values()] == list(STUDIES)
    assert all(study.question.endswith("?") for study in STUDIES.values())


@pytest.mark.parametrize("name", STUDIES)
def test_a_study_has_four_files_at_least(name: str) -> None:
    files = {path.name for path in folder_of(name).iterdir() if path.is_file()}

    assert files >= {"__init__.py", "settings.py", "run.py", "analysis.py", "README.md"}
    readme = (folder_of(name) / "README.md").read_text("utf-8")
    assert f"relforest experiment {name} " in readme
    for heading in ("## Question", "## Command", "## Result seen"):
        assert heading in readme


@pytest.mark.parametrize("name", STUDIES)
def test_the_small_version_of_every_study_runs(name: str, tmp_path: Path) -> None:
    study = STUDIES[name]
    findings = run_study(study, tmp_path, smoke=True)

    assert findings.claims
    assert (tmp_path / "summary.txt").read_text("utf-8") == f"{findings}\n"
    before = {path: path.read_bytes() for path in tmp_path.glob("*.png")}
    for path in before:
        path.unlink()
    run_study(study, tmp_path, smoke=True)
    assert {path: path.read_bytes() for path in tmp_path.glob("*.png")} == before


@pytest.mark.parametrize("name", STUDIES)
def test_settings_of_a_study_have_distinct_names(name: str) -> None:
    for settings in (STUDIES[name].settings, STUDIES[name].smoke):
        assert len({str(setting) for setting in settings}) == len(settings)
