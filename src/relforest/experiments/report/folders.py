"""Any folder of results, or rows of a study -> a section of a report."""

from __future__ import annotations

from pathlib import Path

from relforest.experiments.registry import STUDIES
from relforest.experiments.report.of_run import run_section
from relforest.experiments.report.section import Picture, Section
from relforest.experiments.run_config import RUN
from relforest.experiments.runner import STUDY, saved_rows
from relforest.experiments.sheets import Passage, Sheet
from relforest.support.documents import well_formed
from relforest.support.errors import InputError


def section_of(folder: Path, *, episodes: int = 2, seed: int = 0) -> Section:
    """Return what was found in a folder of ``relforest experiment``, a copy of its ``rows.csv``, or in a run.

    With a policy in a folder of ``relforest learn``, some episodes are played.

    Raises
    ------
    InputError
        If it is none of these, or holds no results yet.
    RunFolderError, ModelFormatError
        If a file is damaged.
    """
    if folder.is_file() or (folder / STUDY).exists():
        return _study_section(folder)
    if (folder / RUN).exists():
        return run_section(folder, episodes=episodes, seed=seed)
    if not folder.is_dir():
        raise InputError(f"there is no folder {folder}: check its name")
    raise InputError(
        f"{folder} is neither a study nor a run: give a folder of 'relforest experiment' or 'relforest learn'"
    )


def _study_section(folder: Path) -> Section:
    """Return claims, figures, tables and texts, computed from the rows that are saved so far.

    Raises
    ------
    InputError
        If there are no rows yet, or the study is unknown here.
    RunFolderError
        If a file is damaged.
    """
    saved = saved_rows(folder)
    if saved.study not in STUDIES:
        raise InputError(
            f"{folder} is of the study {saved.study!r}, which this version of relforest does not have"
        )
    study = STUDIES[saved.study]
    with well_formed(f"the rows in {folder} are damaged", "restore them, or run the study again"):
        findings, figures = study.summarize(saved.table), study.figures(saved.table)
    lead = [study.question, f"Seed {saved.seed}, {saved.n_done} of {saved.n_settings} settings."]
    if saved.n_done < saved.n_settings:
        lead[-1] += " The others have not been computed: whatever is said here leaves them out."
    if saved.is_smoke:
        lead.append(
            "This is the small version that only shows that the study runs: its numbers mean nothing."
        )
    lead += filter(None, [findings.text])
    pictures = [Picture(Path(name).stem.replace("-", " "), figure) for name, figure in figures.items()]
    # Numbers first, long texts last.
    sheets = [part for part in findings.parts if isinstance(part, Sheet)]
    texts = [part for part in findings.parts if isinstance(part, Passage)]
    return Section(study.name, tuple(lead), findings.claims, (*pictures, *sheets, *texts))
