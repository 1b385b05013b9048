"""Files that commands write because they were told to."""

from __future__ import annotations

from pathlib import Path

from relforest.support.errors import InputError


def check_free(path: Path, *, force: bool) -> None:
    """Check that an output file may be written, before any work is done for it.

    Raises
    ------
    InputError
        If the path is a folder, or a file that is there already and ``force`` was not given.
    """
    if path.is_dir():
        raise InputError(f"{path} is a folder: give the name of a file")
    if path.exists() and not force:
        raise InputError(f"{path} exists already: choose another name, or pass --force to replace it")
