"""The folder of a study -> a section of a report."""

from __future__ import annotations

from pathlib import Path

from relforest.experiments.registry import STUDIES
from relforest.experiments.report.section import Picture, Section
from relforest.experiments.runner import saved_rows
from relforest.experiments.sheets import Passage, Sheet
from relforest.support.errors import InputError


def study_section(folder: Path) -> Section:
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
    findings = study.summarize(saved.table)
    lead = [study.question, f"Seed {saved.seed}, {saved.n_done} of {saved.n_settings} settings."]
    if saved.n_done < saved.n_settings:
        lead[-1] += " The others have not been computed: whatever is said here leaves them out."
    if saved.is_smoke:
        lead.append(
            "This is the small version that only shows that the study runs: its numbers mean nothing."
        )
    lead += filter(None, [findings.text])
    pictures = [
        Picture(Path(name).stem.replace("-", " "), figure)
        for name, figure in study.figures(saved.table).items()
    ]
    # Numbers first, long texts last.
    sheets = [part for part in findings.parts if isinstance(part, Sheet)]
    texts = [part for part in findings.parts if isinstance(part, Passage)]
    return Section(study.name, tuple(lead), findings.claims, (*pictures, *sheets, *texts))
