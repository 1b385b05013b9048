"""Parquet files as tables, with damaged and hostile files in mind."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, final

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
from pyarrow import parquet

from relforest.scenes.arrow import ArrowArray, ArrowTable, ArrowType, is_text
from relforest.scenes.table_file import TableFile
from relforest.support.errors import InputError, RelforestError

PARQUET_SUFFIXES: Final = (".parquet", ".pq")

_ALLOWED_BYTES: Final = 2**28
_ALLOWED_RATIO: Final = 1000
_BUFFER_BYTES: Final = 2**16
_BUFFERED_FROM: Final = 2**25
# Whatever pyarrow may raise for a damaged file.
_BROKEN: Final = (
    ArithmeticError,
    AttributeError,
    LookupError,
    MemoryError,
    OSError,
    RuntimeError,
    TypeError,
    ValueError,
    pa.ArrowException,
)


@final
@dataclass(frozen=True, slots=True, eq=False)
class ParquetFile(TableFile):
    """A Parquet file, reopened for every read."""

    content: str | bytes  # the path, or the bytes themselves
    size: int
    types: Mapping[str, ArrowType]  # of the columns as they are read
    n_rows: int

    def load(self, chosen: Sequence[str]) -> ArrowTable:
        """Return columns with their stored types, but categories as their values."""
        # Categories stay small even if a long string is repeated often.
        with _opened(self.content, self.origin, self._texts(chosen)) as file:
            return self._plain(file.read(columns=list(chosen)).select(list(chosen)))

    def blocks(self, chosen: Sequence[str], n_rows: int) -> Iterator[ArrowTable]:
        """Yield columns as `load` returns them, at most `n_rows` rows at a time, with no more in memory."""
        # pyarrow reads a row group, which may be the whole file, but with these options page by page. It then
        # believes a damaged page that claims to have gigabytes, so small files are better read without.
        options = {"pre_buffer": False, "buffer_size": _BUFFER_BYTES} if self.size >= _BUFFERED_FROM else {}
        with _opened(self.content, self.origin, self._texts(chosen), **options) as file:
            for batch in file.iter_batches(n_rows, columns=list(chosen)):
                yield self._plain(pa.Table.from_batches([batch]).select(list(chosen)))

    def _texts(self, chosen: Sequence[str]) -> list[str]:
        """Return those of the columns that hold text, after a check of the sizes that the file claims."""
        with _opened(self.content, self.origin) as file:
            self._check_size(_claimed_size(file.metadata, len(chosen)))
            return [name for name in chosen if _is_text(file.schema_arrow.field(name).type)]

    def _plain(self, table: ArrowTable) -> ArrowTable:
        """Return a table with categories replaced by their values, after checks of its size and content."""
        self._check_size(sum(_text_size(chunk) for column in table.columns for chunk in column.chunks))
        plain = pa.schema([pa.field(field.name, _plain_type(field.type)) for field in table.schema])
        table = table.cast(plain.with_metadata(table.schema.metadata))
        table.validate(full=True)
        return table

    def _check_size(self, n_bytes: int) -> None:
        if n_bytes > max(_ALLOWED_BYTES, _ALLOWED_RATIO * self.size):
            raise InputError(
                f"{self.origin} unpacks to {n_bytes} bytes, more than {_ALLOWED_RATIO} times its size: it is "
                "damaged or hostile"
            )


def parquet_at(path: Path) -> ParquetFile:
    """Open the Parquet file with a path that exists.

    Raises
    ------
    InputError
        If it is not a regular file, or is damaged.
    """
    if not path.is_file():
        raise InputError(f"{path} cannot be read: it is not a regular file")
    return _with_footer(str(path), str(path), path.stat().st_size)


def parquet_from_bytes(content: bytes, origin: str) -> ParquetFile:
    """Open a Parquet file of which this is the content; see `parquet_at`."""
    return _with_footer(content, origin, len(content))


def _with_footer(content: str | bytes, origin: str, size: int) -> ParquetFile:
    with _opened(content, origin) as file:
        schema = file.schema_arrow
        types = {field.name: _plain_type(field.type) for field in schema}
        metadata, n_rows = dict(schema.metadata or {}), int(file.metadata.num_rows)
        return ParquetFile(origin, tuple(schema.names), metadata, content, size, types, n_rows)


@contextmanager
def _opened(
    content: str | bytes, origin: str, categories: Sequence[str] = (), **options: object
) -> Iterator[Any]:
    """Open a file; any error while it is open becomes an `InputError`."""
    try:
        raw = pa.OSFile(content) if isinstance(content, str) else pa.BufferReader(content)
        checked: dict[str, Any] = {"read_dictionary": list(categories), "page_checksum_verification": True}
        with raw, parquet.ParquetFile(raw, **checked, **options) as file:
            yield file
    except RelforestError:
        raise
    except _BROKEN as error:
        raise InputError(
            f"{origin} is not a readable Parquet file: it is damaged, truncated or in another format"
        ) from error


def data_files(paths: Iterable[Path], origin: str) -> list[Path]:
    """Return the Parquet files among paths, by name; hidden files and names like _SUCCESS are not data.

    Raises
    ------
    InputError
        If there are none, or other files.
    """
    found = sorted(path for path in paths if path.name[:1] not in {".", "_"})
    odd = next((path for path in found if path.suffix.lower() not in PARQUET_SUFFIXES), None)
    if odd is not None:
        raise InputError(f"{origin} contains {odd.name!r}: only folders of Parquet files can be read")
    if not found:
        raise InputError(f"{origin} contains no Parquet files")
    return found


def _is_text(datatype: ArrowType) -> bool:
    return is_text(datatype) or pa.types.is_binary(datatype) or pa.types.is_large_binary(datatype)


def _claimed_size(metadata: Any, n_columns: int) -> int:  # noqa: ANN401 - pyarrow has no type annotations
    """Return the largest size in bytes of some columns that the file's metadata imply."""
    # Metadata of single columns are not read: if those are damaged, pyarrow aborts the process.
    groups = [metadata.row_group(number) for number in range(metadata.num_row_groups)]
    n_rows = max(metadata.num_rows, sum(group.num_rows for group in groups))
    return int(max(8 * n_rows * n_columns, sum(group.total_byte_size for group in groups)))


def _text_size(chunk: ArrowArray) -> int:
    """Return the size of categories as text, in bytes."""
    if not pa.types.is_dictionary(chunk.type) or not _is_text(chunk.type.value_type):
        return 0
    lengths = pc.fill_null(pc.binary_length(chunk.dictionary), 0).to_numpy(zero_copy_only=False)
    chunk.validate(full=True)
    codes = chunk.indices.drop_null().to_numpy(zero_copy_only=False)
    return int(lengths[codes].sum(dtype=np.int64)) if len(lengths) else 0


def _plain_type(datatype: ArrowType) -> ArrowType:
    if pa.types.is_dictionary(datatype):
        datatype = datatype.value_type
    if is_text(datatype):
        return pa.large_string()
    return pa.large_binary() if pa.types.is_binary(datatype) else datatype
