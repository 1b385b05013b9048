"""Tables from files: CSV and Parquet, distinguished by suffix."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Final

from relforest.scenes.arrow import ArrowTable
from relforest.scenes.csv_files import open_csv
from relforest.scenes.dialect import Dialect
from relforest.scenes.parquet_files import PARQUET_SUFFIXES, parquet_from_bytes
from relforest.scenes.parquet_source import open_parquet
from relforest.scenes.sources import Source, checked_path, is_stream, name_of, read_bytes
from relforest.scenes.table_file import TableFile
from relforest.support.errors import InputError

_CSV_SUFFIXES: Final = (".csv", ".tsv")
_COMPRESSED_SUFFIXES: Final = (".gz", ".bz2", ".zst")


def read_table(
    source: Source,
    *,
    columns: Sequence[str] | None = None,
    separator: str | None = None,
    decimal: str | None = None,
    encoding: str | None = None,
) -> ArrowTable:
    r"""Read a CSV or Parquet file as an arrow table, which `Scenes.from_frame` accepts.

    Parameters
    ----------
    source : path or open file
        A path ends in ``.csv``, ``.tsv``, ``.parquet`` or ``.pq``, perhaps followed by ``.gz``, ``.bz2`` or
        ``.zst``, or is a folder of Parquet files. The first line of a CSV file names the columns. All fields
        are read as text, exactly as written, and empty ones are nulls; `Scenes.from_frame` converts text to
        numbers where it needs them, with ``NA``, ``NaN``, ``null`` and the like as undefined values.
    columns : sequence of str, optional
        The columns to read. Default: all with a unique name.
    separator, decimal, encoding : str, optional
        How a CSV file is written. By default the separator is detected from the first line (comma,
        semicolon, tab or bar), the decimal mark is a point, or a comma if the values allow no other reading,
        and the encoding is UTF-8, or UTF-16 if the first bytes show it.

    Raises
    ------
    InputError
        If the file does not exist, has another suffix, lacks a column or is damaged, or an option is invalid.
    """
    if isinstance(columns, str):
        raise InputError(f"columns must be a sequence of names, got a string: write [{columns!r}]")
    file = open_table(source, Dialect(separator, decimal, encoding))
    if columns is None:
        columns = [name for name in file.names if file.names.count(name) == 1]
    return file.read(columns)


def open_table(source: Source, dialect: Dialect) -> TableFile:
    """Open a CSV or Parquet file; see `read_table`."""
    if is_stream(source):
        content = read_bytes(source)
        is_parquet = content.startswith(b"PAR1")
        origin = name_of(source)
        return parquet_from_bytes(content, origin) if is_parquet else open_csv(content, origin, dialect)
    path = checked_path(source)
    if path.is_dir():
        return open_parquet(path)
    suffix, *rest = [each.lower() for each in reversed(path.suffixes)] or [""]
    is_packed = suffix in _COMPRESSED_SUFFIXES
    ending = (rest or [""])[0] if is_packed else suffix
    if ending not in (*_CSV_SUFFIXES, *PARQUET_SUFFIXES):
        known = ", ".join((*_CSV_SUFFIXES, *PARQUET_SUFFIXES))
        raise InputError(
            f"{source} has the suffix {suffix!r}: only {known} files can be read (also with "
            f"{', '.join(_COMPRESSED_SUFFIXES)}), and folders of Parquet files"
        )
    if ending in PARQUET_SUFFIXES:
        return parquet_from_bytes(read_bytes(path), str(path)) if is_packed else open_parquet(path)
    if ending == ".tsv" and dialect.separator is None:
        dialect = replace(dialect, separator="\t")
    return open_csv(read_bytes(path), str(path), dialect)
