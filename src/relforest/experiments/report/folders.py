"""Any folder of results -> a section of a report."""

from __future__ import annotations

from pathlib import Path

from relforest.experiments.report.of_run import run_section
from relforest.experiments.report.of_study import study_section
from relforest.experiments.report.section import Section
from relforest.experiments.run_config import RUN
from relforest.experiments.runner import STUDY
from relforest.support.errors import InputError


def section_of(folder: Path, *, episodes: int = 2, seed: int = 0) -> Section:
    """Return what was found in a folder.

    Parameters
    ----------
    folder : path
        Of ``relforest experiment`` or ``relforest learn``.
    episodes : int
        How many are played with a learned policy.
    seed : int
        Of these episodes.

    Raises
    ------
    InputError
        If it is no such folder, or holds no results yet.
    RunFolderError, ModelFormatError
        If a file is damaged.
    """
    if (folder / STUDY).exists():
        return study_section(folder)
    if (folder / RUN).exists():
        return run_section(folder, episodes=episodes, seed=seed)
    if not folder.is_dir():
        raise InputError(f"there is no folder {folder}: check its name")
    raise InputError(
        f"{folder} is neither a study nor a run: give a folder of 'relforest experiment' or 'relforest learn'"
    )
