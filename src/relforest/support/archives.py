"""Packing and unpacking ``.npz`` archives: plain arrays in a ZIP file, as NumPy writes them.

Only numbers and booleans are read, never pickled objects, and sizes are checked before anything is unpacked.
"""

from __future__ import annotations

import io
import zipfile
from collections.abc import Container, Iterable, Mapping, Sequence
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from relforest.support.errors import InputError, ModelFormatError

MAX_BYTES: Final = 256 * 2**20
MAX_MEMBERS: Final = 10_000

# Fixed, so that equal arrays always give equal bytes.
_ZIP_TIME: Final = (1980, 1, 1, 0, 0, 0)
_PACKING: Final = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)
_ENTRY: Final = b"PK\x01\x02"


def pack_arrays(arrays: Mapping[str, NDArray[Any]], origin: str) -> bytes:
    """Pack named arrays into an archive; equal arrays give equal bytes.

    Raises
    ------
    InputError
        If an array contains anything but booleans, integers and floats; `origin` names the file.
    """
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w") as archive:
        for name, array in arrays.items():
            if not _is_plain(array.dtype):
                held = "Python objects" if array.dtype.hasobject else f"values of type {array.dtype}"
                raise InputError(
                    f"array {name!r} cannot be written to {origin}: it contains {held} instead of numbers"
                )
            entry = zipfile.ZipInfo(f"{name}.npy", _ZIP_TIME)
            entry.compress_type = zipfile.ZIP_DEFLATED
            with archive.open(entry, "w", force_zip64=True) as member:
                np.lib.format.write_array(member, array, allow_pickle=False)
    return buffer.getvalue()


def unpack_arrays(
    data: bytes, names: Iterable[str], *, optional: Container[str], origin: str
) -> dict[str, NDArray[Any]]:
    """Unpack named arrays from an archive, in the order of the names; see `relforest.support.files.read_npz`.

    Raises
    ------
    ModelFormatError
        If the data are not a valid archive, unpack to more than `MAX_BYTES`, or an array is missing, damaged,
        or not of numbers or booleans.
    """
    if data.count(_ENTRY) > MAX_MEMBERS:
        raise ModelFormatError(f"{origin} contains more than {MAX_MEMBERS} arrays, which is the limit")
    # On damaged bytes, the ZIP reader and its decompressors raise errors of many types.
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            _check_entries(archive.infolist(), origin)
            contents = _contents(archive, names, optional, origin)
    except ModelFormatError:
        raise
    except Exception as error:
        raise ModelFormatError(f"{origin} is not a readable archive of arrays: {error}") from error
    return {name: _array(content, f"array {name!r} of {origin}") for name, content in contents.items()}


def _check_entries(entries: Sequence[zipfile.ZipInfo], origin: str) -> None:
    unpacked = sum(entry.file_size for entry in entries)
    if unpacked > MAX_BYTES:
        raise ModelFormatError(f"{origin} unpacks to {unpacked} bytes, more than the {MAX_BYTES} allowed")
    if len({entry.filename for entry in entries}) < len(entries):
        raise ModelFormatError(f"{origin} is damaged: two of its arrays have the same name")
    for entry in entries:
        if entry.compress_type not in _PACKING:
            raise ModelFormatError(f"{origin} uses a compression method that NumPy does not use")


def _contents(
    archive: zipfile.ZipFile, names: Iterable[str], optional: Container[str], origin: str
) -> dict[str, bytes]:
    entries = {entry.filename: entry for entry in archive.infolist()}
    contents = {}
    for name in names:
        entry = entries.get(f"{name}.npy")
        if entry is not None:
            with archive.open(entry) as member:
                # At most its stated size, which was checked, whatever it unpacks to.
                contents[name] = member.read(entry.file_size)
        elif name not in optional:
            raise ModelFormatError(f"array {name!r} is missing from {origin}")
    return contents


def _array(content: bytes, what: str) -> NDArray[Any]:
    stream = io.BytesIO(content)
    # On damaged headers, NumPy raises errors of many types.
    try:
        array: NDArray[Any] = np.lib.format.read_array(stream, allow_pickle=False)
    except Exception as error:
        raise ModelFormatError(f"{what} is damaged, or not of numbers and booleans: {error}") from error
    if not _is_plain(array.dtype):
        raise ModelFormatError(f"{what} has the type {array.dtype}: only numbers and booleans can be read")
    if stream.read(1):
        raise ModelFormatError(f"{what} is damaged: it has more bytes than fill the shape {array.shape}")
    if array.dtype.kind == "b" and array.view(np.uint8).max(initial=0) > 1:
        raise ModelFormatError(f"{what} is damaged: it contains booleans other than 0 and 1")
    return array


def _is_plain(dtype: np.dtype[Any]) -> bool:
    # Larger numbers differ between platforms.
    return dtype.kind in "biuf" and dtype.itemsize <= 8
