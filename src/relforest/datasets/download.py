"""The files of published data sets: from a folder of the user's, this package, the cache, or a web address.

The origin of a file does not matter: its SHA-256 hash is checked.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Final

import pooch

from relforest.support.errors import DataError, InputError, MissingDataError
from relforest.support.files import read_input

DATA_VARIABLE: Final = "RELFOREST_DATA"
URL_VARIABLE: Final = "RELFOREST_DATA_URL"
_SUBFOLDER: Final = "mil"
_TIMEOUT_S: Final = 30
_INCLUDED: Final = Path(__file__).with_name("included")


def data_file(
    name: str,
    registry: Mapping[str, str],
    *,
    data_home: str | os.PathLike[str] | None = None,
    base_url: str | None = None,
    source: str,
) -> tuple[Path, bytes]:
    """Find a file of the registry, or download it into the cache.

    The registry maps files to SHA-256 hashes, in hexadecimal digits. The cache is by default a folder
    ``relforest`` among the user's caches. The address of the folder that holds the file, http or https, is by
    default that of the environment variable ``RELFOREST_DATA_URL``, if it is set. Messages name the source of
    the data.

    Returns
    -------
    path : Path
        Where the file is: ``mil/NAME`` or ``NAME`` in the folder of the environment variable
        ``RELFOREST_DATA``, if that is set and has it, or else in this package or the cache.
    content : bytes
        The content of the file, with the right hash.

    Raises
    ------
    DataError
        If the file is not found and no address is given (a `MissingDataError`), the download fails, or the
        hash is wrong.
    """
    expected = registry[name]
    local = _local_folders()
    for path in (folder / name for folder in local):
        if path.is_file():
            return path, _checked(path, expected, f"replace it with the right file, or unset {DATA_VARIABLE}")
    cache = Path(pooch.os_cache("relforest") if data_home is None else data_home).expanduser()
    url = base_url or os.environ.get(URL_VARIABLE)
    path = cache / name
    if url:
        _download(name, registry, cache, url)
    elif not path.is_file():
        looked = ", ".join(str(folder) for folder in (*local, cache) if folder != _INCLUDED)
        raise MissingDataError(
            f"{name} was not found (looked in {looked}) and is not available on the web yet. If you have the "
            f"file, set the environment variable {DATA_VARIABLE} to a folder with {_SUBFOLDER}/{name}, "
            f"or give an address to download from as base_url or in {URL_VARIABLE}; if you have another copy "
            f"of the data, read it with read_csv, read_c45 or read_arff. Source of the data: {source}"
        )
    return path, _checked(path, expected, f"delete it and fetch it again with base_url or {URL_VARIABLE}")


def _local_folders() -> tuple[Path, ...]:
    named = os.environ.get(DATA_VARIABLE)
    given = (Path(named).expanduser() / _SUBFOLDER, Path(named).expanduser()) if named else ()
    return (*given, _INCLUDED)


def _download(name: str, registry: Mapping[str, str], cache: Path, url: str) -> None:
    """Download a file into the cache unless the right one is already there."""
    if not url.startswith(("http://", "https://")):
        raise DataError(f"the address {url!r} must begin with http:// or https://")
    fetcher = pooch.create(cache, f"{url.rstrip('/')}/", registry=dict(registry))
    try:
        fetcher.fetch(name, downloader=pooch.HTTPDownloader(timeout=_TIMEOUT_S))
    # What requests raises is an OSError; a wrong hash is a ValueError.
    except (OSError, ValueError) as error:
        raise DataError(
            f"{name} could not be downloaded from {url} into {cache}: {error} Check the address "
            f"({URL_VARIABLE} or base_url), the connection and the folder, or set {DATA_VARIABLE} to a "
            f"folder with {_SUBFOLDER}/{name}."
        ) from error


def _checked(path: Path, expected: str, remedy: str) -> bytes:
    try:
        content = read_input(path)
    except InputError as error:
        raise DataError(str(error)) from error
    found = hashlib.sha256(content).hexdigest()
    if found != expected:
        raise DataError(
            f"{path} is not the published file: its SHA-256 hash is {found}, expected is {expected}; {remedy}"
        )
    return content
