"""Runs a study: settings in parallel, the rows of each saved when it is done, then summary and figures.

A study's folder holds ``study.json`` (what it depends on), ``settings/NNNN.json`` (the rows of each setting),
and, derived from them, ``rows.csv``, ``summary.txt`` and the figures.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from dataclasses import fields
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Final, TypeVar

from relforest.experiments.claims import Findings
from relforest.experiments.folders import Identity, claimed
from relforest.experiments.study import Place, Setting, Study
from relforest.experiments.table import Row, Table
from relforest.experiments.watching import watching
from relforest.reports.figure_files import save_figure
from relforest.support.errors import ModelFormatError, RunFolderError
from relforest.support.files import read_json, remove_temporary_files, write_json, write_text
from relforest.support.options import at_least
from relforest.support.parallel import checked_jobs, one_blas_thread, run_tasks

S = TypeVar("S", bound=Setting)

_STUDY: Final = "study.json"
_SETTINGS: Final = "settings"
_STUDY_FORMAT: Final = "relforest-study"
_ROWS_FORMAT: Final = "relforest-study-rows"
_ROWS_VERSION: Final = 1


def run_study(
    study: Study[S],
    out: str | os.PathLike[str],
    *,
    seed: int = 0,
    n_jobs: int = 1,
    smoke: bool = False,
    on_progress: Callable[[str], None] | None = None,
) -> Findings:
    """Run a study, or what is left of it, and write its results.

    Parameters
    ----------
    study : Study
    out : path
        Folder of the results. If it holds a part of the same study and seed, only the rest is computed.
    seed : int
        At least 0; the same seed gives the same rows, whatever `n_jobs`.
    n_jobs : int
        Settings computed at the same time, in processes; -1 = all cores.
    smoke : bool
        Run the small version.
    on_progress : callable, optional
        Called with a line of text whenever settings have been completed.

    Returns
    -------
    Findings

    Raises
    ------
    InputError
        If an option is out of its range.
    RunFolderError
        If the folder is in use, is not empty, belongs to other work, or is damaged.
    """
    folder, settings = Path(out), study.smoke if smoke else study.settings
    seed = at_least("seed", seed, 0)
    checked_jobs(n_jobs)
    plain = [_plain(setting) for setting in settings]
    identity = Identity(
        _STUDY, _STUDY_FORMAT, {"study": study.name, "seed": seed, "smoke": smoke, "settings": plain}
    )
    files = [folder / _SETTINGS / f"{index:04d}.json" for index in range(len(settings))]
    with claimed(folder, identity, is_finished=lambda: all(file.exists() for file in files)):
        tasks = [
            (study.compute, setting, Place(seed, index, folder), file)
            for index, (setting, file) in enumerate(zip(settings, files, strict=True))
            if not file.exists()
        ]
        if (folder / _SETTINGS).is_dir():
            remove_temporary_files(folder / _SETTINGS)
        if study.compiles and n_jobs != 1 and len(tasks) > 1:
            _warm_up(study)
        with watching(_announcer(study.name, files, settings, on_progress)):
            run_tasks(_run_setting, tasks, n_jobs=n_jobs, prefer="processes")
        table = Table.of(
            {"id": f"{study.name}/{index}/{seed}", **row}
            for index, file in enumerate(files)
            for row in _read_rows(file, plain[index])
        )
        return _report(study, table, folder)


def _report(study: Study[S], table: Table, folder: Path) -> Findings:
    """Write everything that is derived from the rows."""
    write_text(folder / "rows.csv", table.to_csv())
    findings = study.summarize(table)
    write_text(folder / "summary.txt", f"{findings}\n")
    for name, figure in study.figures(table).items():
        save_figure(figure, folder / name)
    return findings


def _warm_up(study: Study[S]) -> None:
    with TemporaryDirectory() as folder, one_blas_thread():
        study.compute(study.smoke[0], Place(0, 0, Path(folder)))


def _run_setting(compute: Callable[[S, Place], list[Row]], setting: S, place: Place, file: Path) -> None:
    rows = compute(setting, place)
    header = {"format": _ROWS_FORMAT, "version": _ROWS_VERSION}
    write_json(file, {**header, "setting": _plain(setting), "rows": rows})


def _read_rows(file: Path, setting: Mapping[str, Any]) -> list[Row]:
    try:
        document = read_json(file, format=_ROWS_FORMAT, version=_ROWS_VERSION)
    except ModelFormatError as error:
        raise RunFolderError(f"{error}; delete the file, and it is computed again") from error
    rows = document.get("rows")
    if (
        document.get("setting") != setting
        or not isinstance(rows, list)
        or not all(isinstance(r, dict) for r in rows)
    ):
        raise RunFolderError(f"{file} is damaged or of another setting; delete it, and it is computed again")
    return rows


def _plain(setting: Setting) -> dict[str, Any]:
    return {entry.name: getattr(setting, entry.name) for entry in fields(setting)}


def _announcer(
    name: str, files: list[Path], settings: tuple[S, ...], on_progress: Callable[[str], None] | None
) -> Callable[[], None]:
    """Return a function that tells of the settings completed since it was called last."""
    pending = {index for index, file in enumerate(files) if not file.exists()}

    def announce() -> None:
        for index in sorted(pending):
            if on_progress is not None and files[index].exists():
                pending.remove(index)
                on_progress(f"{name}: {len(files) - len(pending)} of {len(files)} done ({settings[index]})")

    return announce
