"""Every file that relforest writes or reads as its own: atomic writes, versioned JSON and plain arrays.

A file is written under a temporary name in its own folder, flushed to disk and renamed, so a reader or a
resumed run sees the old content or the new one, never a part. Nothing is pickled; what is read is checked
before it is used.
"""

from __future__ import annotations

import errno
import gzip
import io
import json
import os
import re
import reprlib
import secrets
import stat
import zlib
from collections.abc import Container, Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from hashlib import blake2b
from pathlib import Path
from typing import Any, Final

from numpy.typing import NDArray

from relforest.support.archives import pack_arrays, unpack_arrays
from relforest.support.documents import (
    MAX_DEPTH,
    check_extent,
    check_values,
    is_clean,
    without_duplicates,
)
from relforest.support.errors import InputError, ModelFormatError

MAX_BYTES: Final = 256 * 2**20
MAX_DOCUMENT_BYTES: Final = 64 * 2**20
MAX_INPUT_BYTES: Final = 2**31

_TEMPORARY: Final = re.compile(r"\..+\.[0-9a-f]{16}\.tmp")
# File systems allow names of 255 bytes; a temporary name adds 22 to that of its file.
_LONGEST_STEM: Final = 200


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
        If the file cannot be written; ``filename`` is set, and what was at ``path`` before is still there.
    InputError
        If ``path`` is empty, cannot be a path, or is a pipe or a device.
    """
    with _writing(path):
        target = Path(os.path.realpath(path))
        if target.is_dir():
            raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), os.fspath(path))
        if target.exists() and not target.is_file():
            raise InputError(f"{path} cannot be replaced: it is not a regular file")
        make_folder(target.parent)
        stem = os.fsdecode(os.fsencode(target.name)[:_LONGEST_STEM])
        temporary = target.with_name(f".{stem}.{secrets.token_hex(8)}.tmp")
        try:
            with temporary.open("xb") as file:
                file.write(data)
                file.flush()
                os.fsync(file.fileno())
            temporary.replace(target)
        except BaseException:
            with suppress(OSError):
                temporary.unlink()
            raise
        _sync_folder(target.parent)


def make_folder(path: str | os.PathLike[str]) -> None:
    """Make a folder and those around it, unless it is there.

    Raises
    ------
    OSError
        If it cannot be made; ``filename`` says what is in the way.
    InputError
        If ``path`` is empty or cannot be a path.
    """
    with _writing(path):
        try:
            Path(path).mkdir(parents=True, exist_ok=True)
        except FileExistsError as error:
            raise NotADirectoryError(errno.ENOTDIR, os.strerror(errno.ENOTDIR), error.filename) from None


def is_temporary(path: Path) -> bool:
    """Whether a name is one that an interrupted `write_bytes` leaves behind."""
    return _TEMPORARY.fullmatch(path.name) is not None


def remove_temporary_files(folder: Path) -> None:
    """Delete what interrupted writes left in a folder, if it exists; whoever calls this holds its lock."""
    for path in folder.iterdir() if folder.is_dir() else ():
        if is_temporary(path) and path.is_file():
            path.unlink()


def write_text(path: str | os.PathLike[str], text: str) -> None:
    """Write a text file as UTF-8, whole or not at all; see `write_bytes`.

    Raises
    ------
    InputError
        If the text holds lone surrogates, which UTF-8 cannot express.
    """
    try:
        data = text.encode("utf-8")
    except UnicodeEncodeError as error:
        raise InputError(f"{path} cannot be written as UTF-8: {error}") from error
    write_bytes(path, data)


def write_json(path: str | os.PathLike[str], document: Mapping[str, Any]) -> None:
    """Write a JSON file, whole or not at all: indented by 1, keys in the order given, newline at the end.

    Parameters
    ----------
    path : path
        Where to write; see `write_bytes`.
    document : mapping
        Built of dict, list, tuple, str, int, float, bool and None.

    Raises
    ------
    InputError
        If the document holds anything that `read_json` would refuse.
    """
    try:
        check_values(document, "the document")
    except ModelFormatError as error:
        raise InputError(f"{path} cannot be written as JSON: {error}") from error
    write_text(path, json.dumps(document, indent=1, allow_nan=False, ensure_ascii=False) + "\n")


def read_json(
    path: str | os.PathLike[str], *, format: str, version: int, max_bytes: int = MAX_DOCUMENT_BYTES
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
    data = _read_regular_file(path, max_bytes)
    check_extent(data, str(path))
    document = _parse_json(data, f"{path} is not a {format} file")
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
        If it is not an object with that format and a known version, or holds a value that
        `relforest.support.documents.check_values` refuses.
    """
    if not isinstance(document, dict):
        raise ModelFormatError(
            f"{origin} is not a {format} document: it holds {type(document).__name__}, not an object"
        )
    check_values(document, origin)
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
        Of booleans, integers or floats.

    Raises
    ------
    InputError
        If an array is of another type.
    """
    write_bytes(path, pack_arrays(arrays, str(path)))


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
        If the file is missing or not such an archive, or an array is missing, damaged or of another type than
        booleans, integers and floats.
    """
    data = _read_regular_file(path, max_bytes)
    return unpack_arrays(data, names, optional=optional, max_bytes=max_bytes, origin=str(path))


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
        If ``text`` is not a single line of text.
    OSError
        If the line cannot be written; ``filename`` is set, and the log is as it was.
    """
    if "\n" in text or not is_clean(text):
        raise InputError(f"only single lines of text can be appended to {path}, got {text!r:.200}")
    make_folder(Path(path).parent)
    with _writing(path), Path(path).open("a+b", buffering=0) as file:
        size = file.seek(0, os.SEEK_END)
        file.seek(max(size - 1, 0))
        torn = file.read(1) not in {b"", b"\n"}
        line = (b"\n" if torn else b"") + text.encode("utf-8") + b"\n"
        # A disk that is almost full takes a part of the line.
        if file.write(line) != len(line):
            file.truncate(size)
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


@contextmanager
def _writing(path: str | os.PathLike[str]) -> Iterator[None]:
    """Name the file in every error of the ``with`` block, which the operating system does for some only."""
    name = os.fspath(path)
    if not name:
        raise InputError("the path to write to is empty: name a file or folder")
    try:
        yield
    except OSError as error:
        if error.filename is None or is_temporary(Path(error.filename)):
            raise OSError(error.errno, error.strerror, name) from error
        raise
    except InputError:
        raise
    except ValueError as error:
        raise InputError(f"{name!r} cannot be a path: {error}") from error


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
        document: object = json.loads(data.decode("utf-8"), object_pairs_hook=without_duplicates)
    except UnicodeDecodeError as error:
        raise ModelFormatError(f"{complaint}: it is not UTF-8 text") from error
    except RecursionError as error:
        raise ModelFormatError(f"{complaint}: it is nested more than {MAX_DEPTH} levels deep") from error
    except ValueError as error:
        raise ModelFormatError(f"{complaint}: it is not valid JSON ({error})") from error
    return document


def _sync_folder(folder: Path) -> None:
    # Without this a power cut may undo the rename itself. Where a file system refuses, only that is lost.
    with suppress(OSError):
        descriptor = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)
