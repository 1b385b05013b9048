"""What a command writes: data on standard output, and files, checked before any work is done for them."""

from __future__ import annotations

import os
import stat
import sys
from pathlib import Path

from relforest.support.errors import InputError


def check_free(path: Path, *, force: bool) -> None:
    """Check that an output file can be written.

    Raises
    ------
    InputError
        If the path is a folder or a device, is a file that exists and ``force`` is False, or lies in a folder
        that cannot be written to.
    """
    try:
        mode = path.stat().st_mode
    except FileNotFoundError:
        _check_writable(next(parent for parent in path.absolute().parents if parent.exists()))
        return
    except OSError as error:
        raise InputError(f"cannot write {path}: {error.strerror}") from error
    if stat.S_ISDIR(mode):
        raise InputError(f"{path} is a folder: give the name of a file")
    if not stat.S_ISREG(mode):
        raise InputError(f"{path} is not a regular file: give another name")
    if not force:
        raise InputError(f"{path} exists already: choose another name, or pass --force to replace it")
    _check_writable(path.absolute().parent)


def print_data(text: str) -> None:
    """Write data to standard output, unaltered.

    Raises
    ------
    InputError
        If the encoding of standard output lacks a character.
    """
    try:
        text.encode(sys.stdout.encoding or "utf-8")
    except UnicodeEncodeError as error:
        raise InputError(
            f"standard output cannot express {text[error.start]!a} in its encoding {error.encoding}: write "
            "to a file with --out, or set PYTHONIOENCODING=utf-8"
        ) from error
    print(text, end="")


def _check_writable(folder: Path) -> None:
    # Permissions do not tell everything (read-only file systems, quotas, /proc), so something is written.
    probe = folder / f".relforest-{os.getpid()}"
    try:
        probe.mkdir()
        probe.rmdir()
    except OSError as error:
        raise InputError(f"cannot write to folder {folder}: {error.strerror}") from error
