"""``relforest predict``: apply a model to the scenes of a table."""

# Heavy imports wait until the command runs, so that --help answers at once.
# ruff: noqa: PLC0415

from __future__ import annotations

import csv
import io
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, final

from tyro.conf import OmitArgPrefixes, Positional, arg

from relforest.cli.csv_options import CsvOptions
from relforest.cli.outputs import check_free, print_data
from relforest.cli.progress import note, working

if TYPE_CHECKING:
    from relforest.scenes.arrow import ArrowTable


@final
@dataclass(frozen=True, slots=True)
class PredictOptions:
    """Apply a learned model to the scenes of a table.

    The result is one row per scene: its id, the probability of the positive class and the more probable class
    (of several classes the most probable one and the probability of each, or the predicted number), and for a
    tree the number of the leaf that decided and the ids of the objects that led to it, one column per
    variable. The table needs the columns that the model was learned from, except the labels; its scenes may
    have different numbers of objects.

    Predictions are CSV, or Parquet if the table is. Parquet files of any size are read and written in pieces;
    the rows of a scene must then be together. A folder gets a file for each one read, under the same name.

    For example:
      relforest predict tree.json other.parquet --out predictions.csv
      relforest predict tree.json "parts/*.parquet" --out predictions

    Parameters
    ----------
    model
        Model file written by relforest fit.
    table
        Parquet or CSV file, a folder of Parquet files, or a quoted pattern of them. A CSV file may be
        compressed (.csv.gz).
    out
        CSV or .parquet file to write, or a folder.
    csv
        How a CSV file is written.
    jobs
        Threads; the result does not depend on it.
    force
        Replace output files that exist.
    """

    model: Annotated[Positional[Path], arg(metavar="MODEL")]
    table: Annotated[Positional[Path], arg(metavar="TABLE")]
    out: Annotated[Path | None, arg(metavar="FILE", help_behavior_hint="(default: standard output)")] = None
    csv: OmitArgPrefixes[CsvOptions] = field(default_factory=CsvOptions)
    jobs: int = 1
    force: bool = False


def predict(options: PredictOptions) -> int:
    """Predict with the given options; the exit code is 0."""
    from relforest.cli.predict_stream import parquet_output, predict_files
    from relforest.models import prediction_table, read_model
    from relforest.support.files import write_text

    out = parquet_output(options.table, options.out)
    if out is not None:
        model = read_model(options.model)
        with working(f"predicting {options.table}"):
            n_scenes = predict_files(model, options.table, out, n_jobs=options.jobs, force=options.force)
        note(f"wrote {n_scenes} predictions of {model.outcome} to {out}")
        return 0
    if options.out is not None:
        check_free(options.out, force=options.force)
    model = read_model(options.model)
    scenes = model.read_scenes(options.table, dialect=options.csv.dialect)
    text = _as_csv(prediction_table(model, scenes, n_jobs=options.jobs))
    if options.out is None:
        print_data(text)
    else:
        write_text(options.out, text)
        note(f"wrote {len(scenes)} predictions of {model.outcome} to {options.out}")
    return 0


def _as_csv(table: ArrowTable) -> str:
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(table.column_names)
    columns = [
        [f"{value:.6g}" if isinstance(value, float) else value for value in column.to_pylist()]
        for column in table.columns
    ]
    writer.writerows(zip(*columns, strict=True))
    return stream.getvalue()
