"""Sources of data: paths and open files, compressed or not, and text in any encoding."""

from __future__ import annotations

import bz2
import codecs
import gzip
import io
import os
import re
import zlib
from collections.abc import Callable, Iterable
from os import PathLike
from pathlib import Path
from typing import IO, Any, Final, TypeGuard

import pyarrow as pa

from relforest.support.errors import InputError
from relforest.support.files import MAX_INPUT_BYTES, read_input

Source = str | PathLike[str] | IO[Any]
"""A path, or a file that is open for reading."""

_ENCODINGS: Final = "name one such as utf-8, utf-16, latin-1 or cp1252"
# `Path` merges the two slashes.
_ADDRESS: Final = re.compile(r"[A-Za-z][A-Za-z0-9+.-]+:/")
_COMPRESSED: Final[dict[bytes, tuple[str, Callable[[io.BytesIO], Any]]]] = {
    b"\x1f\x8b": ("gzip", lambda packed: gzip.GzipFile(fileobj=packed)),
    b"BZh": ("bz2", bz2.BZ2File),
    b"\x28\xb5\x2f\xfd": ("zstd", lambda packed: pa.CompressedInputStream(packed, "zstd")),
}
_MARKS: Final = (
    (b"\xef\xbb\xbf", "utf-8"),
    (b"\xff\xfe\x00\x00", "utf-32-le"),
    (b"\x00\x00\xfe\xff", "utf-32-be"),
    (b"\xff\xfe", "utf-16-le"),
    (b"\xfe\xff", "utf-16-be"),
)


def name_of(source: Source) -> str:
    """Return the name of a source in messages."""
    if is_stream(source):
        name = getattr(source, "name", None)
        return name if isinstance(name, str) else f"the open {type(source).__name__}"
    return str(source)


def checked_path(path: object) -> Path:
    """Return an existing path.

    Raises
    ------
    InputError
        If it is not a path, is empty or a web address, or does not exist.
    """
    if not isinstance(path, (str, PathLike)) or not isinstance(os.fspath(path), str):
        raise InputError(f"expected a path or an open file, got {type(path).__name__}")
    text = os.fspath(path)
    if not text or "\0" in text:
        raise InputError(f"{text!r} is not a path: give the name of a file")
    if _ADDRESS.match(text):
        raise InputError(f"{text} is a web address: download the file and give its path")
    try:
        Path(text).stat()
    except FileNotFoundError as error:
        raise InputError(f"file {text} does not exist: check the path") from error
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) else "it is not a valid path"
        raise InputError(f"{text} cannot be read: {reason}; check the path") from error
    return Path(text)


def read_bytes(source: Source) -> bytes:
    """Return the content of a source, unpacked if it is compressed with gzip, bzip2 or Zstandard.

    Raises
    ------
    InputError
        If it cannot be read or unpacked, or is too large.
    """
    origin = name_of(source)
    data = _drained(source, origin) if is_stream(source) else _file_content(source)
    if isinstance(data, str):
        return _encoded(data, origin)
    return unpacked(data, origin)


def unpacked(data: bytes, origin: str) -> bytes:
    """Return the content of a file, unpacked if its first bytes, not its name, show that it is compressed.

    Raises
    ------
    InputError
        If unpacking fails or the result is too large.
    """
    codec, opened = next((how for magic, how in _COMPRESSED.items() if data.startswith(magic)), (None, None))
    if opened is None:
        return data
    try:
        with opened(io.BytesIO(data)) as stream:
            content: bytes = stream.read(MAX_INPUT_BYTES + 1)
    except (OSError, EOFError, MemoryError, zlib.error) as error:
        raise InputError(f"{origin} is damaged: it cannot be unpacked with {codec} ({error})") from error
    if len(content) > MAX_INPUT_BYTES:
        raise InputError(f"{origin} unpacks to more than the {MAX_INPUT_BYTES} bytes allowed")
    return content


def read_text(source: Source, encoding: str | None = None) -> str:
    """Return the text of a source without a byte order mark.

    Raises
    ------
    InputError
        As for `read_bytes` and `utf8`; or if the text is not valid in its encoding.
    """
    origin = name_of(source)
    return decoded(utf8(read_bytes(source), encoding, origin), "utf-8", origin)


def utf8(data: bytes, encoding: str | None, origin: str) -> bytes:
    """Return text as UTF-8 without a byte order mark.

    Without an `encoding` it is UTF-8, which is not checked here, or UTF-16 or UTF-32 if the first bytes show
    it.

    Raises
    ------
    InputError
        If the encoding is unknown, or the text is not valid in it.
    """
    mark, found = next(((mark, name) for mark, name in _MARKS if data.startswith(mark)), (b"", None))
    if found is None and b"\0" in data[:2]:
        # Plain text does not begin like this, but in UTF-16 every other byte of Latin letters is NUL.
        found = "utf-16-be" if data[:1] == b"\0" else "utf-16-le"
    chosen = (found or "utf-8") if encoding is None else _codec(encoding, origin)
    if chosen not in {"utf-8", "utf-8-sig"}:
        if mark and found == "utf-8":
            raise InputError(f"{origin} is marked as UTF-8: leave out the encoding {encoding!r}")
        return decoded(data, chosen, origin).removeprefix("\ufeff").encode()
    return data[len(mark) :] if found == "utf-8" else data


def decoded(data: bytes, encoding: str, origin: str) -> str:
    """Return decoded text.

    Raises
    ------
    InputError
        If it is not valid in the encoding; the message names line and byte.
    """
    try:
        text = data.decode(encoding)
        text.encode()
    except UnicodeDecodeError as error:
        line = data[: error.start].decode(encoding, "ignore").count("\n") + 1
        raise InputError(
            f"{origin} is not {encoding.upper()} text (byte 0x{data[error.start]:02x} in line {line}): pass "
            "its encoding, such as encoding='latin-1' (--encoding latin-1)"
        ) from error
    except (LookupError, TypeError, ValueError) as error:
        raise InputError(f"{origin} cannot be read with the encoding {encoding!r}: {_ENCODINGS}") from error
    return text


def is_broken(text: str) -> bool:
    """Return whether text contains bytes that were not UTF-8."""
    return any("\udc80" <= character <= "\udcff" for character in text)


def encoding_hint(names: Iterable[str]) -> str:
    """Return advice to append to a message that lists names, if some of them were not UTF-8."""
    return "" if not any(map(is_broken, names)) else " (pass the encoding, which is not UTF-8)"


def _codec(encoding: str, origin: str) -> str:
    try:
        return codecs.lookup(encoding).name
    except (LookupError, ValueError) as error:
        raise InputError(f"{origin} cannot be read with the encoding {encoding!r}: {_ENCODINGS}") from error


def is_stream(source: object) -> TypeGuard[IO[Any]]:
    """Return whether a source is an open file."""
    return callable(getattr(source, "read", None))


def _drained(stream: IO[Any], origin: str) -> str | bytes:
    try:
        data = stream.read()
    except UnicodeDecodeError as error:
        raise InputError(f"{origin} is not {error.encoding} text: open the file in its encoding") from error
    except (OSError, ValueError) as error:
        raise InputError(f"{origin} cannot be read: {error}") from error
    if not isinstance(data, (str, bytes)):
        raise InputError(f"{origin} returns {type(data).__name__} instead of text or bytes")
    return data


def _file_content(source: Source) -> bytes:
    path = checked_path(source)
    if path.is_dir():
        raise InputError(f"{path} is a folder: give the name of a file")
    return read_input(path, max_bytes=max(MAX_INPUT_BYTES, path.stat().st_size))


def _encoded(text: str, origin: str) -> bytes:
    try:
        # The mark prevents decoding a second time.
        return b"\xef\xbb\xbf" + text.encode()
    except UnicodeEncodeError as error:
        raise InputError(f"{origin} contains {text[error.start]!r}, which is not a character") from error
