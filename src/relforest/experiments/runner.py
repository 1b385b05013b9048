"""Runs a study: settings in parallel, saving the rows of each as soon as it is done, then the summary.

Settings are computed by worker processes, here or elsewhere, which return rows; only this process writes. A
study's folder holds ``study.json`` (what it depends on), ``settings/NNNN.json`` (the rows of each setting),
and, derived from them, ``rows.csv`` (of all that are saved), ``summary.txt``, other documents and the figures
(of those that were chosen last). It belongs to the whole study: other settings may be computed later in the
same folder.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Collection, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import asdict, dataclass, replace
from itertools import count
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Final, TypeVar, final

from relforest.experiments.claims import Findings
from relforest.experiments.runs import learn_in_folders
from relforest.experiments.study import Context, Setting, Study, Unavailable, chosen_settings
from relforest.experiments.table import Row, Table
from relforest.reports.figure_files import save_figure
from relforest.runs.manifest import VERSION, Manifest, checked_folder, held
from relforest.support.documents import well_formed
from relforest.support.errors import InputError, ModelFormatError, RunFolderError
from relforest.support.files import (
    read_input,
    read_json,
    remove_temporary_files,
    write_bytes,
    write_json,
    write_text,
)
from relforest.support.options import at_least
from relforest.support.parallel import checked_jobs, may_leave_machine, one_blas_thread, run_tasks
from relforest.support.progress import part, report

S = TypeVar("S", bound=Setting)

STUDY: Final = "study.json"
ROWS: Final = "rows.csv"
_SETTINGS: Final = "settings"
# Of the files of a run, these are large, and no policy needs them.
_EXPERIENCE: Final = "experience"
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
    only: Mapping[str, Sequence[str]] | None = None,
    on_progress: Callable[[str], None] | None = None,
) -> Findings:
    """Run a study, or what is left of it, and write its results.

    Parameters
    ----------
    study : Study
    out : path
        Folder of the results. If it contains a part of the same study and seed, only the rest is computed.
    seed : int
        At least 0; the same seed gives the same rows, whatever `n_jobs`.
    n_jobs : int
        Settings computed at the same time, in processes; -1 = all cores.
    smoke : bool
        Run the small version.
    only : mapping of str to sequence of str, optional
        Compute and report only these settings: values by choice of the study, such as
        ``{"methods": ["covagg"]}``. Their rows are those of the whole study.
    on_progress : callable, optional
        Called with a line of text when settings are done, and at the start for those that cannot be computed
        here and are left out.

    Returns
    -------
    Findings

    Raises
    ------
    InputError
        If an option is out of its range, `out` cannot be the name of a folder, no setting is chosen, or none
        of those can be computed here.
    RunFolderError
        If the folder cannot be written to, is in use, is not empty, belongs to other work, or is damaged.
    """
    folder, settings = checked_folder(out), study.smoke if smoke else study.settings
    seed = at_least("seed", seed, 0)
    checked_jobs(n_jobs)
    chosen = chosen_settings(study, settings, only or {})
    plain = [asdict(setting) for setting in settings]
    manifest = Manifest(
        STUDY, _STUDY_FORMAT, {"study": study.name, "seed": seed, "smoke": smoke, "settings": plain}
    )
    files = {index: _file(Context(seed, index, folder)) for index in chosen}
    unsaved = [settings[index] for index, file in files.items() if not file.exists()]
    unavailable = {} if study.unavailable is None else study.unavailable(unsaved)
    files = {index: file for index, file in files.items() if settings[index] not in unavailable}
    notes = _notes(unavailable.values())
    if not files:
        raise InputError(" ".join(notes))
    announce = on_progress or (lambda _line: None)
    for line in notes:
        announce(line)
    with held(folder, manifest, is_finished=lambda: all(file.exists() for file in files.values())):
        _compute(study, {Context(seed, index, folder): settings[index] for index in files}, n_jobs, announce)
        table = _table_of(study.name, seed, {index: (file, plain[index]) for index, file in files.items()})
        write_text(folder / ROWS, _rows_in_folder(folder).table.to_csv())
        return _report(study, table, folder, notes)


@final
@dataclass(frozen=True, slots=True)
class SavedRows:
    """What is saved of a study so far."""

    study: str
    seed: int
    table: Table
    n_done: int
    n_settings: int  # as many as done in a file of rows, which does not say what the whole study was
    is_smoke: bool = False


def saved_rows(path: Path) -> SavedRows:
    """Return the rows of what is done, in a folder of `run_study`, or a copy of its ``rows.csv``.

    Raises
    ------
    InputError
        If no setting is done yet, or a file is not of rows.
    RunFolderError
        If a file of a folder is missing or damaged.
    """
    return _rows_in_folder(path) if path.is_dir() else _rows_in_file(path)


def _rows_in_file(file: Path) -> SavedRows:
    try:
        table = Table.from_csv(read_input(file).decode("utf-8"))
        settings = [str(cell).split("/") for cell in table.distinct("id")]
        (name,), (seed, *_) = {study for study, _, _ in settings}, {int(seed) for _, _, seed in settings}
    except (ValueError, InputError) as error:
        raise InputError(f"{file} does not hold the rows of a study: {error}") from error
    return SavedRows(name, seed, table, len(settings), len(settings))


def _rows_in_folder(folder: Path) -> SavedRows:
    try:
        document = read_json(folder / STUDY, format=_STUDY_FORMAT, version=VERSION)
        with well_formed(f"{folder / STUDY} is damaged", "restore it, or run the study in another folder"):
            name, seed, is_smoke = str(document["study"]), int(document["seed"]), bool(document["smoke"])
            settings = list(document["settings"])
    except ModelFormatError as error:
        raise RunFolderError(str(error)) from error
    files = {index: (_file(Context(seed, index, folder)), each) for index, each in enumerate(settings)}
    done = {index: each for index, each in files.items() if each[0].exists()}
    if not done:
        raise InputError(f"{folder} has no results yet: run 'relforest experiment {name}' to its end")
    return SavedRows(name, seed, _table_of(name, seed, done), len(done), len(settings), is_smoke)


def _compute(
    study: Study[S], chosen: Mapping[Context, S], n_jobs: int, announce: Callable[[str], None]
) -> None:
    """Compute the settings that have no file yet, and write their rows as soon as they are there."""
    files = {context: _file(context) for context in chosen}
    left = [context for context, file in files.items() if not file.exists()]
    for parent in {file.parent for file in files.values()}:
        remove_temporary_files(parent)
    if study.learned is not None:
        found = (study.learned(chosen[context], context) for context in left)
        runs = [run for run in found if run is not None]
        with ExitStack() as locks:
            for run in runs:
                locks.enter_context(run.held())
            # Some begin with what others have learned.
            folders = {run.folder for run in runs}
            for is_later in (False, True):
                wave = [run for run in runs if (run.source in folders) == is_later]
                learn_in_folders(wave, n_jobs=n_jobs)
    elif study.compiles and n_jobs != 1 and len(left) > 1 and not may_leave_machine():
        _warm_up(study)

    done = count(len(files) - len(left) + 1)

    def save(task: int, rows: list[Row]) -> None:
        context = left[task]
        header = {"format": _ROWS_FORMAT, "version": _ROWS_VERSION}
        write_json(files[context], {**header, "setting": asdict(chosen[context]), "rows": rows})
        announce(f"{study.name}: {next(done)} of {len(files)} done ({chosen[context]})")

    run_tasks(
        _rows_of,
        [
            (study.compute, chosen[context], context, _sent(study, chosen[context], context))
            for context in left
        ],
        n_jobs=n_jobs,
        prefer="processes",
        then=save,
    )


def _table_of(study: str, seed: int, files: Mapping[int, tuple[Path, Mapping[str, Any]]]) -> Table:
    """Return all rows of some settings: the number of each -> its file, and what it is."""
    return Table.of(
        {"id": f"{study}/{index}/{seed}", **row}
        for index, (file, setting) in files.items()
        for row in _read_rows(file, setting)
    )


def _file(context: Context) -> Path:
    return context.folder / _SETTINGS / f"{context.index:04d}.json"


def _report(study: Study[S], table: Table, folder: Path, notes: Sequence[str]) -> Findings:
    """Write what is found in some rows."""
    report("summarizing")
    findings = study.summarize(table)
    if notes:
        findings = replace(findings, text="\n".join([*notes, "", findings.text]))
    write_text(folder / "summary.txt", f"{findings}\n")
    for name, text in findings.documents.items():
        write_text(folder / name, text)
    report("drawing the figures")
    for name, figure in study.figures(table).items():
        save_figure(figure, folder / name)
    return findings


def _warm_up(study: Study[S]) -> None:
    with TemporaryDirectory() as folder, one_blas_thread(), part("first a small setting"):
        study.compute(study.smoke[0], Context(0, 0, Path(folder)))


def _sent(study: Study[S], setting: S, context: Context) -> Mapping[str, bytes] | None:
    """Return the files of the run of a setting, for a worker that may not have them; None where all do."""
    run = None if study.learned is None or not may_leave_machine() else study.learned(setting, context)
    if run is None:
        return None
    files = (path for path in run.folder.rglob("*") if path.is_file() and path.parent.name != _EXPERIENCE)
    return {path.relative_to(context.folder).as_posix(): read_input(path) for path in files}


def _rows_of(
    compute: Callable[[S, Context], list[Row]], setting: S, context: Context, sent: Mapping[str, bytes] | None
) -> list[Row]:
    with part(str(setting)), TemporaryDirectory() as folder:
        if sent is not None:
            context = replace(context, folder=Path(folder))
            for name, data in sent.items():
                write_bytes(context.folder / name, data)
        return compute(setting, context)


def _read_rows(file: Path, setting: Mapping[str, Any]) -> list[Row]:
    try:
        document = read_json(file, format=_ROWS_FORMAT, version=_ROWS_VERSION)
    except ModelFormatError as error:
        raise RunFolderError(f"{error}; delete the file to compute it again") from error
    rows = document.get("rows")
    if (
        document.get("setting") != setting
        or not isinstance(rows, list)
        or not all(isinstance(row, dict) and all(map(_is_cell, row.values())) for row in rows)
    ):
        raise RunFolderError(f"{file} is damaged or from another setting; delete it to compute it again")
    return rows


def _is_cell(value: object) -> bool:
    return value is None or isinstance(value, (str, int, float))


def _notes(unavailable: Collection[Unavailable]) -> list[str]:
    """Return a line per reason for which settings are left out."""
    lines = []
    for reason in dict.fromkeys(absence.reason for absence in unavailable):
        concerned = [absence.missing for absence in unavailable if absence.reason == reason]
        lines.append(f"Left out ({len(concerned)} settings): {', '.join(dict.fromkeys(concerned))}. {reason}")
    return lines
