"""Files that commands write because they were told to."""

from __future__ import annotations

import os
from pathlib import Path

from relforest.support.errors import InputError


def check_free(path: Path, *, force: bool) -> None:
    """Check that an output file may be written, before any work is done for it.

    Raises
    ------
    InputError
        If the path is a folder, a file that is there already and ``force`` was not given, or in a folder that
        cannot be written to.
    """
    if path.is_dir():
        raise InputError(f"{path} is a folder: give the name of a file")
    if path.exists() and not force:
        raise InputError(f"{path} exists already: choose another name, or pass --force to replace it")
    folder = next(parent for parent in path.absolute().parents if parent.exists())
    if not folder.is_dir() or not os.access(folder, os.W_OK):
        raise InputError(f"{path} cannot be written: {folder} is no folder that allows it")
