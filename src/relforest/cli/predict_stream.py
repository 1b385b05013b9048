"""Predictions from Parquet files of any size to Parquet files, batch by batch."""

from __future__ import annotations

from contextlib import ExitStack
from pathlib import Path

from pyarrow import parquet

from relforest.cli.outputs import check_free
from relforest.models import Model, prediction_table
from relforest.scenes.parquet_files import PARQUET_SUFFIXES
from relforest.scenes.parquet_source import ParquetSource, is_pattern, open_source
from relforest.scenes.scene_stream import SceneBatch
from relforest.support.errors import InputError
from relforest.support.files import replacing


def parquet_output(table: Path, out: Path | None) -> Path | None:
    """Return where predictions for a table are written as Parquet, or None if they are CSV.

    Raises
    ------
    InputError
        If the output is a folder or Parquet, but the table is not; or the other way round for a pattern.
    """
    is_several = table.is_dir() or is_pattern(table)
    if out is not None and (out.is_dir() or _is_parquet(out) or (is_several and not out.suffix)):
        if not is_several and not _is_parquet(table):
            raise InputError(
                f"{table} is not a Parquet file, so its predictions cannot be written to {out}: give the "
                "name of a file that ends in .csv"
            )
        return out
    if is_pattern(table):
        raise InputError(
            f"{table} is a pattern: write its predictions to a .parquet file, or to a folder whose name has "
            "no suffix, with --out"
        )
    return None


def predict_files(model: Model, table: Path, out: Path, *, n_jobs: int, force: bool) -> int:
    """Write the predictions for all scenes of Parquet files, all of them or none.

    The output is a file that ends in .parquet; or a folder, which gets a file for each one that is read, with
    the same name and the scenes that begin in it. The number of scenes is returned.

    Raises
    ------
    InputError
        If a file cannot be written, would replace the table, or would get the name of another; and as for
        `relforest.iter_scene_batches`.
    """
    source = open_source(table)
    targets = _targets(source, out)
    for target in targets:
        check_free(target, force=force)
    batches = model.open_scenes(source).batches()
    first = next(batches)
    schema = prediction_table(model, first.scenes.take([])).schema
    batch: SceneBatch | None = first
    n_scenes = 0
    # The files get their names when all of them are complete.
    with ExitStack() as complete:
        for number, target in enumerate(targets):
            temporary = complete.enter_context(replacing(target))
            with parquet.ParquetWriter(temporary, schema, compression="zstd") as writer:
                while batch is not None and (len(targets) == 1 or batch.file == number):
                    writer.write_table(prediction_table(model, batch.scenes, n_jobs=n_jobs))
                    n_scenes += len(batch.scenes)
                    batch = next(batches, None)
    return n_scenes


def _is_parquet(path: Path) -> bool:
    return path.suffix.lower() in PARQUET_SUFFIXES


def _targets(source: ParquetSource, out: Path) -> list[Path]:
    """Return the files to write: one, or one for each file of the source."""
    read = [Path(file.origin) for file in source.files]
    targets = [out]
    if out.is_dir() or not _is_parquet(out):
        targets = [out / path.name for path in read]
    if len(set(targets)) < len(targets):
        twice = next(path.name for path in targets if targets.count(path) > 1)
        raise InputError(
            f"{source.origin} has several files named {twice}: write to one file (--out x.parquet)"
        )
    replaced = {path.resolve() for path in read}
    clash = next((path for path in targets if path.resolve() in replaced), None)
    if clash is not None:
        raise InputError(f"{clash} is part of the table and is not replaced: choose another --out")
    return targets
