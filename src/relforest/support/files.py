"""Reading and writing relforest's own files: atomic writes, versioned JSON and plain arrays.

A file is written under a temporary name in its folder, flushed to disk and renamed, so that a reader or a
resumed run sees either the old content or the new, never a part. Nothing is pickled, and everything read is
checked before use.
"""

from __future__ import annotations

import errno
import json
import os
import re
import reprlib
import secrets
import stat
from collections.abc import Container, Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from hashlib import blake2b
from pathlib import Path
from types import MappingProxyType
from typing import Any, Final

from numpy.typing import NDArray

from relforest.support.archives import MAX_BYTES, pack_arrays, unpack_arrays
from relforest.support.documents import MAX_DEPTH, check_extent, check_values, is_clean, without_duplicates
from relforest.support.errors import InputError, ModelFormatError

MAX_DOCUMENT_BYTES: Final = 64 * 2**20
MAX_INPUT_BYTES: Final = 2**31

_TEMPORARY: Final = re.compile(r"\..+\.[0-9a-f]{16}\.tmp")
# File systems allow names of 255 bytes; a temporary name is 22 bytes longer than the name of its file.
_LONGEST_STEM: Final = 200


def content_digest(paths: Iterable[Path]) -> str:
    """Return 16 hexadecimal digits that change when the content of any file changes."""
    digest = blake2b(digest_size=8)
    for path in paths:
        digest.update(path.read_bytes())
    return digest.hexdigest()


def write_bytes(path: str | os.PathLike[str], data: bytes) -> None:
    """Write a file atomically: it appears whole or not at all.

    Missing parent folders are created, an existing file is replaced.

    Raises
    ------
    OSError
        If the file cannot be written; ``filename`` is set, and an existing file is left unchanged.
    InputError
        If ``path`` is empty or not a valid path, or names a pipe or a device.
    """
    with replacing(path) as temporary, temporary.open("xb") as file:
        file.write(data)


@contextmanager
def replacing(path: str | os.PathLike[str]) -> Iterator[Path]:
    """Write a file in pieces: it appears whole when the ``with`` block ends, or not at all after an error.

    Yields
    ------
    Path
        The temporary name to write under. No file has it yet; it must exist and be closed at the end.

    Raises
    ------
    OSError, InputError
        As for `write_bytes`.
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
    with _naming(path):
        try:
            yield temporary
            with temporary.open("rb+") as file:
                os.fsync(file.fileno())
            temporary.replace(target)
        except BaseException:
            with suppress(OSError):
                temporary.unlink()
            raise
        _sync_folder(target.parent)


def make_folder(path: str | os.PathLike[str]) -> None:
    """Create a folder and its parents where they are missing.

    Raises
    ------
    OSError
        If the folder cannot be created; ``filename`` names the obstacle.
    InputError
        If ``path`` is empty or not a valid path.
    """
    with _writing(path):
        try:
            Path(path).mkdir(parents=True, exist_ok=True)
        except FileExistsError as error:
            raise NotADirectoryError(errno.ENOTDIR, os.strerror(errno.ENOTDIR), error.filename) from None


def is_temporary(path: Path) -> bool:
    """Return whether an interrupted `write_bytes` left this file behind, judging by its name."""
    return _TEMPORARY.fullmatch(path.name) is not None


def remove_temporary_files(folder: Path) -> None:
    """Delete the leftovers of interrupted writes from a folder, if it exists; the caller holds its lock."""
    for path in folder.iterdir() if folder.is_dir() else ():
        if is_temporary(path) and path.is_file():
            path.unlink()


def write_text(path: str | os.PathLike[str], text: str) -> None:
    """Write a text file as UTF-8, atomically; see `write_bytes`.

    Raises
    ------
    InputError
        If the text contains lone surrogates, which UTF-8 cannot encode.
    """
    try:
        data = text.encode("utf-8")
    except UnicodeEncodeError as error:
        raise InputError(f"{path} cannot be written as UTF-8: {error}") from error
    write_bytes(path, data)


def write_json(path: str | os.PathLike[str], document: Mapping[str, Any]) -> None:
    """Write a JSON file atomically: indented by 1, keys in the order given, newline at the end.

    Raises
    ------
    InputError
        If `read_json` would reject the document.
    """
    try:
        check_values(document, "the document")
    except ModelFormatError as error:
        raise InputError(f"{path} cannot be written as JSON: {error}") from error
    write_text(path, json.dumps(document, indent=1, allow_nan=False, ensure_ascii=False) + "\n")


def read_json(
    path: str | os.PathLike[str],
    *,
    format: str,
    version: int,
    others: Mapping[str, int] = MappingProxyType({}),
) -> dict[str, Any]:
    """Read one of the library's JSON documents and check it; see `check_document`.

    The caller may accept `others` too: formats and their newest versions.

    Raises
    ------
    ModelFormatError
        If the file is missing, not a regular file, too large, not UTF-8, not JSON, or fails `check_document`.
    """
    data = _read_regular_file(path, MAX_DOCUMENT_BYTES)
    check_extent(data, str(path))
    document = _parse_json(data, f"{path} is not a {format} file")
    found = document.get("format") if isinstance(document, dict) else None
    if isinstance(found, str) and found in others:
        format, version = found, others[found]
    return check_document(document, format=format, version=version, origin=str(path))


def check_document(document: object, *, format: str, version: int, origin: str) -> dict[str, Any]:
    """Return a parsed JSON document after checks of its values and its keys "format" and "version".

    The version may be from 1 to `version`, the newest that the caller can read.

    Raises
    ------
    ModelFormatError
        If it is not an object with that format and a known version, or contains a value that
        `relforest.support.documents.check_values` rejects.
    """
    if not isinstance(document, dict):
        raise ModelFormatError(
            f"{origin} is not a {format} document: expected an object, got {type(document).__name__}"
        )
    check_values(document, origin)
    found = document.get("format")
    if found != format:
        said = "the key 'format' is missing" if found is None else f"its format is {reprlib.repr(found)}"
        raise ModelFormatError(f"{origin} is not a {format} document: {said}")
    written = document.get("version")
    if isinstance(written, bool) or not isinstance(written, int) or written < 1:
        raise ModelFormatError(
            f"{origin} has an invalid version: expected an integer from 1 to {version}, "
            f"got {reprlib.repr(written)}"
        )
    if written > version:
        raise ModelFormatError(
            f"{origin} was written by a newer relforest: {format} version {written}, and this one reads up "
            f"to {version}; upgrade relforest"
        )
    return document


def write_npz(path: str | os.PathLike[str], arrays: Mapping[str, NDArray[Any]]) -> None:
    """Write named arrays as one ``.npz`` archive, atomically; equal arrays give equal bytes.

    Raises
    ------
    InputError
        If an array is not of booleans, integers or floats.
    """
    write_bytes(path, pack_arrays(arrays, str(path)))


def read_npz(
    path: str | os.PathLike[str], names: Iterable[str], *, optional: Container[str] = ()
) -> dict[str, NDArray[Any]]:
    """Read the named arrays of a ``.npz`` archive, in that order, without ever unpickling.

    Those that are `optional` may be missing, and are then missing from the result.

    Raises
    ------
    ModelFormatError
        If the file is missing, not an archive or too large, or an array is missing, damaged, or not of
        booleans, integers or floats.
    """
    data = _read_regular_file(path, MAX_BYTES)
    return unpack_arrays(data, names, optional=optional, origin=str(path))


def read_input(path: str | os.PathLike[str], *, max_bytes: int = MAX_INPUT_BYTES) -> bytes:
    """Return the content of a user's file, whatever its format.

    Raises
    ------
    InputError
        If the file is missing, not a regular file or too large.
    """
    try:
        return _read_regular_file(path, max_bytes)
    except ModelFormatError as error:
        raise InputError(f"{error}; check the path") from error


def append_line(path: str | os.PathLike[str], text: str) -> None:
    """Append a line to a log; for files where losing the last line does no harm.

    The log and its parent folders are created if they do not exist. If an interrupted process left an
    incomplete line, it is terminated first.

    Raises
    ------
    InputError
        If ``text`` is not a single line of text.
    OSError
        If the line cannot be written; ``filename`` is set, and the log is left unchanged.
    """
    if "\n" in text or not is_clean(text):
        raise InputError(f"only single lines of text can be appended to {path}, got {text!r:.200}")
    make_folder(Path(path).parent)
    with _writing(path), Path(path).open("a+b", buffering=0) as file:
        size = file.seek(0, os.SEEK_END)
        file.seek(max(size - 1, 0))
        torn = file.read(1) not in {b"", b"\n"}
        line = (b"\n" if torn else b"") + text.encode("utf-8") + b"\n"
        # A disk that is almost full accepts part of the line.
        if file.write(line) != len(line):
            file.truncate(size)
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


@contextmanager
def _writing(path: str | os.PathLike[str]) -> Iterator[None]:
    """Name the file in every error raised in the ``with`` block, where the operating system may not."""
    name = os.fspath(path)
    if not name:
        raise InputError("the output path is empty: name a file or folder")
    try:
        with _naming(name):
            yield
    except InputError:
        raise
    except ValueError as error:
        raise InputError(f"{name!r} is not a valid path: {error}") from error


@contextmanager
def _naming(path: str | os.PathLike[str]) -> Iterator[None]:
    """Name the file in every `OSError` raised in the ``with`` block."""
    try:
        yield
    except OSError as error:
        if error.filename is None or is_temporary(Path(error.filename)):
            raise OSError(error.errno, error.strerror, os.fspath(path)) from error
        raise


def _read_regular_file(path: str | os.PathLike[str], max_bytes: int) -> bytes:
    try:
        # Checked before opening, because opening a pipe would wait for a writer.
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
    # Without this, a power cut may undo the rename. Not all file systems allow it.
    with suppress(OSError):
        descriptor = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)
