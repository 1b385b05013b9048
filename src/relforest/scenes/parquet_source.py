"""One or many Parquet files as one long table, which can be read in pieces and need not be held in memory."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from glob import glob
from os import PathLike, fspath
from pathlib import Path
from typing import Final, NamedTuple, final

import pyarrow as pa

from relforest.scenes.arrow import ArrowTable, ArrowType
from relforest.scenes.columns import check_named
from relforest.scenes.digests import BLOCK_ROWS
from relforest.scenes.parquet import check_unchanged, is_own
from relforest.scenes.parquet_files import ParquetFile, data_files, parquet_at
from relforest.scenes.sources import checked_path
from relforest.scenes.table_file import TableFile
from relforest.support.errors import InputError

_WILD: Final = frozenset("*?[")


class Piece(NamedTuple):
    """Some successive rows of one file."""

    file: int  # number of the file
    row: int  # number of the first row in that file
    table: ArrowTable


@final
@dataclass(frozen=True, slots=True, eq=False)
class ParquetSource(TableFile):
    """Parquet files with the same columns, in the order in which they are read."""

    files: tuple[ParquetFile, ...]

    @property
    def n_rows(self) -> int:
        """Number of rows in all files."""
        return sum(file.n_rows for file in self.files)

    @property
    def is_own(self) -> bool:
        """Whether `Scenes.to_parquet` wrote all of them."""
        return all(is_own(file) for file in self.files)

    def load(self, chosen: Sequence[str]) -> ArrowTable:
        """Return columns of all files."""
        schema = pa.schema(list(self.common_types(chosen).items()))
        tables = [file.load(chosen).replace_schema_metadata() for file in self.files]
        return pa.concat_tables([table.cast(schema) for table in tables])

    def common_types(self, columns: Iterable[str]) -> dict[str, ArrowType]:
        """Return the types of columns.

        Raises
        ------
        InputError
            If a column is missing, ambiguous, or has another type in another file.
        """
        chosen = list(dict.fromkeys(columns))
        for file in self.files:
            check_named(chosen, file.names, file.origin)
        return {name: self._common_type(name) for name in chosen}

    def _common_type(self, name: str) -> ArrowType:
        """Return the type of a column in all files, except where it has only nulls."""
        stored = [(file.origin, file.types[name]) for file in self.files]
        known = [(origin, datatype) for origin, datatype in stored if not pa.types.is_null(datatype)]
        odd = [(origin, datatype) for origin, datatype in known if datatype != known[0][1]]
        if odd:
            raise InputError(
                f"column {name!r} contains {odd[0][1]} in {odd[0][0]}, but {known[0][1]} in {known[0][0]}: "
                "all files of a folder must have the same types"
            )
        return known[0][1] if known else pa.null()

    def pieces(self, types: Mapping[str, ArrowType], n_rows: int) -> Iterator[Piece]:
        """Yield columns, converted to the given types, of all files in order, `n_rows` rows at a time.

        Raises
        ------
        InputError
            If a file is damaged.
        ModelFormatError
            If a file of `Scenes.to_parquet` was changed since; a piece is checked before it is yielded.
        """
        schema = pa.schema(list(types.items()))
        for number, file in enumerate(self.files):
            row = 0
            for table in _tables(file, list(types), n_rows):
                yield Piece(number, row, table.replace_schema_metadata().cast(schema))
                row += len(table)


def is_pattern(path: str | PathLike[str]) -> bool:
    """Return whether a path that does not exist is a pattern such as ``data/*.parquet``."""
    return not _WILD.isdisjoint(fspath(path)) and not Path(path).exists()


def open_source(source: str | PathLike[str]) -> ParquetSource:
    """Open a Parquet file, a folder of them, or those that match a pattern, in the order of their paths.

    Raises
    ------
    InputError
        If there are none, one of them is damaged, or they have different columns.
    """
    files = tuple(map(parquet_at, _paths(source)))
    for file in files:
        differing = sorted(set(file.names) ^ set(files[0].names))
        if differing:
            raise InputError(
                f"{file.origin} and {files[0].origin} differ in the column {differing[0]!r}: all files of a "
                "folder must have the same columns"
            )
    return ParquetSource(str(source), files[0].names, {}, files)


def open_parquet(path: str | PathLike[str]) -> TableFile:
    """Open a Parquet file, or a folder of them as written by Spark and others, to be read as a whole.

    Raises
    ------
    InputError
        As for `open_source`, or if the path does not exist, or files of a folder have their own numbering.
    """
    source = open_source(checked_path(path))
    if not Path(path).is_dir():
        return source.files[0]
    for file in source.files:
        if is_own(file):
            raise InputError(f"{file.origin} was written by Scenes.to_parquet: read such files one at a time")
    return source


def _paths(source: str | PathLike[str]) -> list[Path]:
    if isinstance(source, (str, PathLike)) and isinstance(fspath(source), str) and is_pattern(source):
        return data_files(map(Path, glob(fspath(source), recursive=True)), f"the pattern {source}")  # noqa: PTH207
    path = checked_path(source)
    if not path.is_dir():
        return [path]
    try:
        return data_files(path.iterdir(), f"folder {path}")
    except OSError as error:
        raise InputError(f"{path} cannot be read: {error.strerror}; check the path") from error


def _tables(file: ParquetFile, columns: Sequence[str], n_rows: int) -> Iterator[ArrowTable]:
    if is_own(file):
        tables = _unchanged(file, _in_blocks(file.blocks(columns, BLOCK_ROWS), BLOCK_ROWS))
    else:
        tables = file.blocks(columns, n_rows)
    # What pyarrow returns ends with every row group.
    return _in_blocks(tables, n_rows)


def _unchanged(file: TableFile, blocks: Iterable[ArrowTable]) -> Iterator[ArrowTable]:
    """Yield blocks after a check of their digests."""
    number, block = 0, None
    for number, block in enumerate(blocks, start=1):
        check_unchanged(file, block, number - 1)
        yield block
    if block is not None:
        check_unchanged(file, block.slice(0, 0), number)


def _in_blocks(tables: Iterable[ArrowTable], n_rows: int) -> Iterator[ArrowTable]:
    """Yield the same rows in tables of exactly `n_rows` rows, except for the last."""
    held: list[ArrowTable] = []
    missing = n_rows
    for table in tables:
        rest = table
        while len(rest) >= missing:
            yield pa.concat_tables([*held, rest.slice(0, missing)])
            rest = rest.slice(missing)
            held, missing = [], n_rows
        if len(rest):
            held.append(rest)
            missing -= len(rest)
    if held:
        yield pa.concat_tables(held)
