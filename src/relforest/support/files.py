"""Every file that relforest writes or reads as its own: atomic writes, versioned JSON and plain arrays.

A file is written under a temporary name in its own folder, flushed to disk and renamed, so a reader or a
resumed run sees the old content or the new one, never a part. Nothing is pickled; what is read is checked
before it is used.
"""

from __future__ import annotations

import gzip
import io
import json
import math
import os
import re
import reprlib
import secrets
import stat
import zipfile
import zlib
from collections import Counter
from collections.abc import Container, Iterable, Mapping
from contextlib import suppress
from hashlib import blake2b
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from relforest.support.errors import InputError, ModelFormatError

MAX_BYTES = 256 * 2**20
MAX_INPUT_BYTES = 2**31
MAX_DEPTH = 64

# Fixed, so that equal arrays give equal bytes whenever they are written.
_ZIP_TIME = (1980, 1, 1, 0, 0, 0)
_BROKEN_ARCHIVE = (
    OSError,
    ValueError,
    EOFError,
    KeyError,
    MemoryError,
    NotImplementedError,
    RuntimeError,
    zipfile.BadZipFile,
    zlib.error,
)


_TEMPORARY = re.compile(r"\..+\.[0-9a-f]{16}\.tmp")


def content_digest(paths: Iterable[Path]) -> str:
    """Return 16 hexadecimal digits that change with the content of any of the files."""
    digest = blake2b(digest_size=8)
    for path in paths:
        digest.update(path.read_bytes())
    return digest.hexdigest()


def write_bytes(path: str | os.PathLike[str], data: bytes) -> None:
    """Write a file so that it appears whole or not at all.

    Parameters
    ----------
    path : path
        Where to write; missing parent folders are made, an existing file is replaced.
    data : bytes
        The content.

    Raises
    ------
    OSError
        If the file cannot be written; what was at ``path`` before is still there.
    """
    target = Path(os.path.realpath(path))
    target.parent.mkdir(parents=True, exist_ok=True)
    temporary = target.with_name(f".{target.name}.{secrets.token_hex(8)}.tmp")
    try:
        with temporary.open("xb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        temporary.replace(target)
    except BaseException:
        with suppress(FileNotFoundError):
            temporary.unlink()
        raise
    _sync_folder(target.parent)


def is_temporary(path: Path) -> bool:
    """Whether a name is one that an interrupted `write_bytes` leaves behind."""
    return _TEMPORARY.fullmatch(path.name) is not None


def remove_temporary_files(folder: Path) -> None:
    """Delete what interrupted writes left in a folder, if it exists; whoever calls this holds its lock."""
    for path in folder.iterdir() if folder.is_dir() else ():
        if is_temporary(path) and path.is_file():
            path.unlink()


def write_text(path: str | os.PathLike[str], text: str) -> None:
    """Write a text file as UTF-8, whole or not at all; see `write_bytes`."""
    write_bytes(path, text.encode("utf-8"))


def write_json(path: str | os.PathLike[str], document: Mapping[str, Any]) -> None:
    """Write a JSON file, whole or not at all: indented by 1, keys in the order given, newline at the end.

    Parameters
    ----------
    path : path
        Where to write; see `write_bytes`.
    document : mapping
        Built of dict, list, str, int, float, bool and None.

    Raises
    ------
    InputError
        If the document holds NaN, an infinite number or another value that JSON cannot say.
    """
    try:
        text = json.dumps(document, indent=1, allow_nan=False, ensure_ascii=False)
    except (TypeError, ValueError) as error:
        raise InputError(f"{path} cannot be written as JSON: {error}") from error
    write_text(path, text + "\n")


def read_json(
    path: str | os.PathLike[str], *, format: str, version: int, max_bytes: int = MAX_BYTES
) -> dict[str, Any]:
    """Read a JSON document of this library and check that it is one.

    Parameters
    ----------
    path : path
        The file.
    format : str
        The required value of the key "format".
    version : int
        The newest value of the key "version" that the caller understands.
    max_bytes : int
        Larger files are refused unread.

    Returns
    -------
    dict
        The document, "format" and "version" included; only its frame is checked (see `check_document`).

    Raises
    ------
    ModelFormatError
        If the file is missing, not a regular file, too large, not UTF-8, not JSON, or fails `check_document`.
    """
    document = _parse_json(_read_regular_file(path, max_bytes), f"{path} is not a {format} file")
    return check_document(document, format=format, version=version, origin=str(path))


def check_document(document: object, *, format: str, version: int, origin: str) -> dict[str, Any]:
    """Check that a parsed JSON document says that it is what the caller expects.

    Parameters
    ----------
    document : object
        What a JSON parser returned.
    format : str
        The required value of the key "format".
    version : int
        The newest value of the key "version" that the caller understands; older ones, from 1, pass.
    origin : str
        Where the document came from, for messages.

    Returns
    -------
    dict
        ``document``.

    Raises
    ------
    ModelFormatError
        If it is not an object with that format and a known version, is nested more than 64 levels deep, or
        holds anything that is not JSON (NaN and infinite numbers included).
    """
    if not isinstance(document, dict):
        raise ModelFormatError(
            f"{origin} is not a {format} document: it holds {type(document).__name__}, not an object"
        )
    _check_values(document, origin)
    found = document.get("format")
    if found != format:
        said = "it names no format" if found is None else f"its format is {reprlib.repr(found)}"
        raise ModelFormatError(f"{origin} is not a {format} document: {said}")
    written = document.get("version")
    if isinstance(written, bool) or not isinstance(written, int) or written < 1:
        raise ModelFormatError(
            f"{origin} has no valid version: expected an integer from 1 to {version}, "
            f"got {reprlib.repr(written)}"
        )
    if written > version:
        raise ModelFormatError(
            f"{origin} was written by a newer relforest: {format} version {written}, and this one reads up "
            f"to {version}; upgrade relforest"
        )
    return document


def write_npz(path: str | os.PathLike[str], arrays: Mapping[str, NDArray[Any]]) -> None:
    """Write named arrays as one ``.npz`` archive, whole or not at all; equal arrays give equal bytes.

    Parameters
    ----------
    path : path
        Where to write, used as it is; see `write_bytes`.
    arrays : mapping of str to ndarray
        Any types but object.

    Raises
    ------
    InputError
        If an array holds Python objects, which only pickle could store.
    """
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_STORED) as archive:
        for name, array in arrays.items():
            if array.dtype.hasobject:
                raise InputError(
                    f"array {name!r} cannot be written to {path}: it holds Python objects; convert it first"
                )
            entry = zipfile.ZipInfo(f"{name}.npy", _ZIP_TIME)
            with archive.open(entry, "w", force_zip64=True) as member:
                np.lib.format.write_array(member, array, allow_pickle=False)
    write_bytes(path, buffer.getvalue())


def read_npz(
    path: str | os.PathLike[str],
    names: Iterable[str],
    *,
    optional: Container[str] = (),
    max_bytes: int = MAX_BYTES,
) -> dict[str, NDArray[Any]]:
    """Read arrays from a ``.npz`` archive without ever unpickling.

    Parameters
    ----------
    path : path
        The archive.
    names : iterable of str
        The arrays to read; others are left unread.
    optional : container of str
        Those of them that are left out if the archive lacks them.
    max_bytes : int
        Archives that are larger, or would be when unpacked, are refused.

    Returns
    -------
    dict of str to ndarray
        In the order of ``names``.

    Raises
    ------
    ModelFormatError
        If the file is missing, is no such archive, lacks an array, or holds a damaged or a pickled one.
    """
    data = _read_regular_file(path, max_bytes)
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            _check_unpacked_size(archive, path, max_bytes)
            there = set(archive.namelist())
            return {
                name: _read_array(archive, name, path)
                for name in names
                if name not in optional or f"{name}.npy" in there
            }
    except ModelFormatError:
        raise
    except _BROKEN_ARCHIVE as error:
        raise ModelFormatError(f"{path} is not a readable archive of arrays: {error}") from error


def read_input(path: str | os.PathLike[str], *, max_bytes: int = MAX_INPUT_BYTES) -> bytes:
    """Return what a file of the user's holds, in whatever format; see also `unpacked`.

    Raises
    ------
    InputError
        If the file is missing, not a regular file or too large.
    """
    try:
        return _read_regular_file(path, max_bytes)
    except ModelFormatError as error:
        raise InputError(f"{error}; check the path") from error


def unpacked(data: bytes, origin: str, *, max_bytes: int = MAX_INPUT_BYTES) -> bytes:
    """Return the content of a file, unpacked if it is compressed with gzip.

    Parameters
    ----------
    data : bytes
        What the file holds; whether it is compressed is told from this, not from a name.
    origin : str
        Where the data came from, for messages.
    max_bytes : int
        Data that are larger when unpacked are refused.

    Raises
    ------
    InputError
        If unpacking fails or gives too much.
    """
    if not data.startswith(b"\x1f\x8b"):
        return data
    try:
        with gzip.GzipFile(fileobj=io.BytesIO(data)) as file:
            content = file.read(max_bytes + 1)
    except (OSError, EOFError, zlib.error) as error:
        raise InputError(f"{origin} is damaged: it cannot be unpacked with gzip ({error})") from error
    if len(content) > max_bytes:
        raise InputError(f"{origin} unpacks to more than the {max_bytes} bytes allowed")
    return content


def append_line(path: str | os.PathLike[str], text: str) -> None:
    """Append one line to a log; only for files in which a lost last line does no harm.

    A line that an interrupted process left without its end is ended first.

    Parameters
    ----------
    path : path
        The log; it and its missing parent folders are made.
    text : str
        The line, without its newline.

    Raises
    ------
    InputError
        If ``text`` holds a line break.
    """
    if "\n" in text or "\r" in text:
        raise InputError(f"only single lines can be appended to {path}, got {text!r}")
    target = Path(path)
    target.parent.mkdir(parents=True, exist_ok=True)
    with target.open("a+b") as file:
        file.seek(max(file.tell() - 1, 0))
        torn = file.read(1) not in {b"", b"\n"}
        file.write((b"\n" if torn else b"") + text.encode("utf-8") + b"\n")


def _read_regular_file(path: str | os.PathLike[str], max_bytes: int) -> bytes:
    try:
        # Asked before opening: opening a pipe would wait for a writer.
        is_regular = stat.S_ISREG(Path(path).stat().st_mode)
        data = _first_bytes(path, max_bytes + 1) if is_regular else b""
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) else error
        raise ModelFormatError(f"{path} cannot be read: {reason}") from error
    if not is_regular:
        raise ModelFormatError(f"{path} cannot be read: it is not a regular file")
    if len(data) > max_bytes:
        raise ModelFormatError(f"{path} is larger than the {max_bytes} bytes allowed")
    return data


def _first_bytes(path: str | os.PathLike[str], count: int) -> bytes:
    with Path(path).open("rb") as file:
        return file.read(count)


def _parse_json(data: bytes, complaint: str) -> object:
    try:
        document: object = json.loads(data.decode("utf-8"), object_pairs_hook=_without_duplicates)
    except UnicodeDecodeError as error:
        raise ModelFormatError(f"{complaint}: it is not UTF-8 text") from error
    except RecursionError as error:
        raise ModelFormatError(f"{complaint}: it is nested more than {MAX_DEPTH} levels deep") from error
    except ValueError as error:
        raise ModelFormatError(f"{complaint}: it is not valid JSON ({error})") from error
    return document


def _check_unpacked_size(archive: zipfile.ZipFile, path: str | os.PathLike[str], max_bytes: int) -> None:
    unpacked = sum(entry.file_size for entry in archive.infolist())
    if unpacked > max_bytes:
        raise ModelFormatError(f"{path} unpacks to {unpacked} bytes, more than the {max_bytes} allowed")


def _read_array(archive: zipfile.ZipFile, name: str, path: str | os.PathLike[str]) -> NDArray[Any]:
    if f"{name}.npy" not in archive.namelist():
        raise ModelFormatError(f"{path} holds no array {name!r}")
    with archive.open(f"{name}.npy") as member:
        array: NDArray[Any] = np.lib.format.read_array(member, allow_pickle=False)
        if member.read(1):
            raise ModelFormatError(f"array {name!r} of {path} is damaged: bytes follow its end")
    return array


def _without_duplicates(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    result = dict(pairs)
    if len(result) < len(pairs):
        (repeated, _), *_ = Counter(key for key, _ in pairs).most_common(1)
        raise ValueError(f"the key {reprlib.repr(repeated)} appears twice in one object")
    return result


def _check_values(document: object, origin: str) -> None:
    pending: list[tuple[object, int]] = [(document, 1)]
    while pending:
        value, depth = pending.pop()
        if isinstance(value, (dict, list, tuple)):
            if depth > MAX_DEPTH:
                raise ModelFormatError(f"{origin} is nested more than {MAX_DEPTH} levels deep")
            if isinstance(value, dict):
                _check_keys(value, origin)
            members = value.values() if isinstance(value, dict) else value
            pending.extend((member, depth + 1) for member in members)
        elif isinstance(value, float) and not math.isfinite(value):
            raise ModelFormatError(f"{origin} holds a number that is not finite ({value})")
        elif not isinstance(value, (str, int, float, bool, type(None))):
            raise ModelFormatError(f"{origin} holds a {type(value).__name__}, which is not JSON")


def _check_keys(members: Mapping[Any, object], origin: str) -> None:
    for key in members:
        if not isinstance(key, str):
            raise ModelFormatError(f"{origin} has the key {reprlib.repr(key)}, which is not a string")


def _sync_folder(folder: Path) -> None:
    # Without this a power cut may undo the rename itself. Where a file system refuses, only that is lost.
    with suppress(OSError):
        descriptor = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)
