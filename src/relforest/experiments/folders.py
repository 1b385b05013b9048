"""The right to write into a folder: it must be empty, or hold an earlier part of exactly the same work.

Runs and studies store what their results depend on in one file, the first that they write. `claimed` compares
it with what is asked for now, and holds the folder's lock meanwhile.
"""

from __future__ import annotations

import os
import platform
import shutil
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from importlib import metadata
from pathlib import Path
from typing import Any, Final

from relforest import __version__
from relforest.experiments.identity import Identity
from relforest.rl.configuration import differences
from relforest.support.errors import InputError, ModelFormatError, RunFolderError
from relforest.support.files import is_temporary, read_json, remove_temporary_files, write_json
from relforest.support.locks import FolderLock

VERSION: Final = 1

_LOCK: Final = ".lock"
_LEAST_ROOM: Final = 2**20


@contextmanager
def claimed(folder: Path, identity: Identity, *, is_finished: Callable[[], bool]) -> Iterator[None]:
    """Hold a folder for one piece of work; its identity is on disk when the ``with`` block begins.

    Parameters
    ----------
    folder : path
        Made if it does not exist.
    identity : Identity
        The work.
    is_finished : callable
        Tells whether nothing is left to compute. Only then may the folder come from other versions of the
        software, because what they computed need not go on as it began.

    Raises
    ------
    RunFolderError
        If the folder is in use, is no folder of this kind, or belongs to other work, or if work is left but
        nothing can be written. Nothing is changed then.
    """
    # Before the lock too, because taking it makes a file.
    _check_kind(folder, identity)
    if not is_finished():
        _check_writable(folder)
    with FolderLock(folder):
        _check_kind(folder, identity)
        remove_temporary_files(folder)
        there = _read(folder, identity)
        here = {**identity.content, "versions": versions()}
        if there is not None:
            _check_same(folder, identity, there, here, is_finished)
        if there is None or _grows(identity, there):
            write_json(folder / identity.file, {"format": identity.format, "version": VERSION, **here})
        yield


def versions() -> dict[str, str]:
    """Return the versions of the software that results depend on, Python's without its last part."""
    python = ".".join(platform.python_version_tuple()[:2])
    others = {name: metadata.version(name) for name in ("numpy", "scipy", "numba", "scikit-learn")}
    return {"python": python, **others, "relforest": __version__}


def checked_folder(out: str | os.PathLike[str]) -> Path:
    """Return a folder that was asked for.

    Raises
    ------
    InputError
        If its name is empty or holds a null character.
    """
    name = os.fspath(out)
    if not name or "\0" in name:
        raise InputError(f"the name of a folder must not be empty or hold a null character, got {name!r}")
    return Path(name)


def _check_writable(folder: Path) -> None:
    """Find out before the work, not after hours of it, that its results cannot be written."""
    there = next(path for path in (folder.absolute(), *folder.absolute().parents) if path.exists())
    if not there.is_dir():
        raise RunFolderError(f"cannot make the folder {folder}: {there} is not a folder; choose another name")
    if not os.access(there, os.W_OK | os.X_OK):
        raise RunFolderError(f"cannot write to the folder {there}: choose another one")
    if shutil.disk_usage(there).free < _LEAST_ROOM:
        raise RunFolderError(f"no space is left for {folder}: make room, or choose a folder on another disk")


def _check_kind(folder: Path, identity: Identity) -> None:
    if not folder.exists():
        return
    if not folder.is_dir():
        raise RunFolderError(f"{folder} is no folder; choose another name")
    if (folder / identity.file).exists():
        return
    # The identity is the first file to be written, so without it only these can be traces of an interruption.
    foreign = [path.name for path in folder.iterdir() if path.name != _LOCK and not is_temporary(path)]
    if foreign:
        raise RunFolderError(
            f"{folder} is not empty and holds no {identity.file}, so it is not ours to write to "
            f"(it holds {min(foreign)!r}); choose a new or empty folder"
        )


def _read(folder: Path, identity: Identity) -> dict[str, Any] | None:
    path = folder / identity.file
    if not path.exists():
        return None
    try:
        document = read_json(path, format=identity.format, version=VERSION)
    except ModelFormatError as error:
        raise RunFolderError(f"{error}; restore that file or choose another folder") from error
    return {name: value for name, value in document.items() if name not in ("format", "version")}


def _check_same(
    folder: Path,
    identity: Identity,
    there: dict[str, Any],
    here: dict[str, Any],
    is_finished: Callable[[], bool],
) -> None:
    there, here = dict(there), dict(here)
    software = _other_software(there.pop("versions", None), here.pop("versions"))
    grows = _grows(identity, there)
    if grows:
        here[str(identity.growing)] = there[str(identity.growing)]
    # What only one of them has, such as the settings of another method, goes with an entry that both have.
    both = [name for name in there if name in here]
    differing = differences({name: there[name] for name in both}, {name: here[name] for name in both})
    differing = differing or differences(there, here)
    if differing:
        raise RunFolderError(
            f"{folder} holds other work: {'; '.join(differing)}; "
            "choose another folder, or ask for what it holds"
        )
    if software and (grows or not is_finished()):
        raise RunFolderError(
            f"{folder} was begun with other software: {'; '.join(software)}; the rest might not fit what it "
            "holds, so start again in another folder, or go on with the same versions"
        )


def _other_software(there: object, here: Mapping[str, str]) -> list[str]:
    if isinstance(there, Mapping):
        # What an older version of this library did not write down yet cannot be compared.
        here = {name: version for name, version in here.items() if name in there}
    return differences(there, here, "versions")


def _grows(identity: Identity, there: Mapping[str, Any]) -> bool:
    if identity.growing is None:
        return False
    old, new = there.get(identity.growing), identity.content[identity.growing]
    return isinstance(old, int) and not isinstance(old, bool) and old < new
