"""Tables from files: CSV and Parquet, told apart by suffix."""

from __future__ import annotations

from os import PathLike
from pathlib import Path

import pyarrow as pa
from pyarrow import csv, parquet

from relforest.scenes.arrow import ArrowTable
from relforest.support.errors import InputError

__all__ = ["read_parquet", "read_table"]


def read_table(path: str | PathLike[str]) -> ArrowTable:
    """Read a CSV or Parquet file as an arrow table, which `Scenes.from_frame` accepts.

    Parameters
    ----------
    path : path
        Ends in ``.csv``, ``.parquet`` or ``.pq``. In a CSV file the first line names the columns, and empty
        fields (and ``NA``, ``NaN``, ``null``) are nulls.

    Raises
    ------
    InputError
        If the file does not exist, has another suffix, or is damaged.
    """
    suffix = Path(path).suffix.lower()
    if suffix in (".parquet", ".pq"):
        return read_parquet(path)
    if suffix != ".csv":
        raise InputError(f"{path} has the suffix {suffix!r}: only .csv, .parquet and .pq files can be read")
    _check_file(path)
    try:
        return csv.read_csv(str(path), convert_options=csv.ConvertOptions(strings_can_be_null=True))
    except (OSError, pa.ArrowException) as error:
        raise InputError(f"{path} is not a readable CSV file: {error}") from error


def read_parquet(path: str | PathLike[str]) -> ArrowTable:
    """Read a Parquet file of any suffix as an arrow table; see `read_table`."""
    _check_file(path)
    try:
        with parquet.ParquetFile(str(path)) as file:
            return file.read()
    except (OSError, pa.ArrowException) as error:
        raise InputError(f"{path} is not a readable Parquet file: {error}") from error


def _check_file(path: str | PathLike[str]) -> None:
    if not Path(path).is_file():
        raise InputError(f"there is no file {path}: check the path")
