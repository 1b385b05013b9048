"""Permission to write into a folder: it must be empty or contain an earlier part of the same work.

The first file that a run or a study writes, its manifest, records what the results depend on. `held` locks
the folder and compares that file with the present request.
"""

from __future__ import annotations

import os
import platform
import shutil
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path
from typing import Any, Final, final

from relforest.support.errors import InputError, ModelFormatError, RunFolderError
from relforest.support.files import is_temporary, read_json, remove_temporary_files, write_json
from relforest.support.locks import LOCK, FolderLock

VERSION: Final = 1

_LEAST_ROOM: Final = 2**20


@final
@dataclass(frozen=True, slots=True, eq=False)
class Manifest:
    """What the content of a folder depends on.

    Parameters
    ----------
    file : str
        Name of the file that stores it, such as ``"run.json"``.
    format : str
        The format that the file names, such as ``"relforest-run"``.
    content : mapping
        Plain JSON values: everything that the results depend on, apart from the versions of the software.
    growing : str, optional
        A number in the content that may be raised later.
    """

    file: str
    format: str
    content: Mapping[str, Any]
    growing: str | None = None


@contextmanager
def held(folder: Path, manifest: Manifest, *, is_finished: Callable[[], bool]) -> Iterator[None]:
    """Lock a folder for one piece of work; its manifest is on disk when the ``with`` block begins.

    The folder is made if it does not exist. Only if everything has been computed may it come from other
    versions of the software, which could compute the rest differently.

    Raises
    ------
    RunFolderError
        If the folder is in use, is of another format, belongs to other work, or cannot be written to although
        work is left. Nothing is changed then.
    """
    # Before the lock too, because taking it makes a file.
    _check_format(folder, manifest)
    if not is_finished():
        _check_writable(folder)
    with FolderLock(folder):
        _check_format(folder, manifest)
        remove_temporary_files(folder)
        there = _read(folder, manifest)
        here = {**manifest.content, "versions": versions()}
        if there is not None:
            _check_same(folder, manifest, there, here, is_finished)
        if there is None or _grows(manifest, there):
            write_json(folder / manifest.file, {"format": manifest.format, "version": VERSION, **here})
        yield


def versions() -> dict[str, str]:
    """Return the versions of the software that results depend on, Python's without its last part."""
    python = ".".join(platform.python_version_tuple()[:2])
    names = ("numpy", "scipy", "numba", "scikit-learn", "relforest")
    return {"python": python} | {name: metadata.version(name) for name in names}


def checked_folder(out: str | os.PathLike[str]) -> Path:
    """Return the path of a folder to write to.

    Raises
    ------
    InputError
        If it is empty or contains a null character.
    """
    name = os.fspath(out)
    if not name or "\0" in name:
        raise InputError(f"the name of a folder must not be empty or contain a null character, got {name!r}")
    return Path(name)


def differences(there: object, here: object, name: str = "") -> list[str]:
    """Return the differences between two configurations, such as ``episodes (500 there, 10 here)``."""
    if isinstance(there, Mapping) and isinstance(here, Mapping):
        found: list[str] = []
        for key in dict.fromkeys([*there, *here]):
            found += differences(there.get(key), here.get(key), f"{name}.{key}" if name else str(key))
        return found
    if isinstance(there, list) and isinstance(here, list):
        # Lists are long, and their first difference tells enough.
        for place, both in enumerate(zip(there, here, strict=False)):
            if found := differences(*both, f"{name}[{place}]"):
                return found
        if len(there) != len(here):
            return [f"{name} ({len(there)} there, {len(here)} here)"]
    return [] if there == here else [f"{name} ({there!r} there, {here!r} here)"]


def _check_writable(folder: Path) -> None:
    """Check before the work, not after hours, that its results can be written."""
    there = next(path for path in (folder.absolute(), *folder.absolute().parents) if path.exists())
    if not there.is_dir():
        raise RunFolderError(f"cannot make the folder {folder}: {there} is not a folder; choose another name")
    if not os.access(there, os.W_OK | os.X_OK):
        raise RunFolderError(f"cannot write to the folder {there}: choose another one")
    if shutil.disk_usage(there).free < _LEAST_ROOM:
        raise RunFolderError(f"no space is left for {folder}: make room, or choose a folder on another disk")


def _check_format(folder: Path, manifest: Manifest) -> None:
    if not folder.exists():
        return
    if not folder.is_dir():
        raise RunFolderError(f"{folder} is not a folder; choose another name")
    if (folder / manifest.file).exists():
        return
    # The manifest is written first, so an interruption before it leaves only these files.
    foreign = [path.name for path in folder.iterdir() if path.name != LOCK and not is_temporary(path)]
    if foreign:
        raise RunFolderError(
            f"{folder} contains {min(foreign)!r} but not {manifest.file}, so it belongs to something else; "
            "choose a new or empty folder"
        )


def _read(folder: Path, manifest: Manifest) -> dict[str, Any] | None:
    path = folder / manifest.file
    if not path.exists():
        return None
    try:
        document = read_json(path, format=manifest.format, version=VERSION)
    except ModelFormatError as error:
        raise RunFolderError(f"{error}; restore that file or choose another folder") from error
    return {name: value for name, value in document.items() if name not in ("format", "version")}


def _check_same(
    folder: Path,
    manifest: Manifest,
    there: dict[str, Any],
    here: dict[str, Any],
    is_finished: Callable[[], bool],
) -> None:
    there, here = dict(there), dict(here)
    software = _other_software(there.pop("versions", None), here.pop("versions"))
    grows = _grows(manifest, there)
    if grows:
        here[str(manifest.growing)] = there[str(manifest.growing)]
    # Entries of only one of them, such as the settings of another method, follow from entries of both.
    both = [name for name in there if name in here]
    differing = differences({name: there[name] for name in both}, {name: here[name] for name in both})
    differing = differing or differences(there, here)
    if differing:
        raise RunFolderError(
            f"{folder} was written with other options: {'; '.join(differing)}; "
            "choose another folder, or use the same options"
        )
    if software and (grows or not is_finished()):
        raise RunFolderError(
            f"{folder} was started with other versions: {'; '.join(software)}; the rest might not match what "
            "it contains, so start again in another folder, or install the same versions"
        )


def _other_software(there: object, here: Mapping[str, str]) -> list[str]:
    if isinstance(there, Mapping):
        # Versions that an older relforest did not record cannot be compared.
        here = {name: version for name, version in here.items() if name in there}
    return differences(there, here, "versions")


def _grows(manifest: Manifest, there: Mapping[str, Any]) -> bool:
    if manifest.growing is None:
        return False
    old, new = there.get(manifest.growing), manifest.content[manifest.growing]
    return isinstance(old, int) and not isinstance(old, bool) and old < new
