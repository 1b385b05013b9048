"""``relforest explain``: why a model predicts what it predicts for one scene, and what would turn it."""

# Heavy imports wait until the command runs, so that --help answers at once.
# ruff: noqa: PLC0415

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, final

from tyro.conf import OmitArgPrefixes, Positional, arg

from relforest.cli.csv_options import CsvOptions
from relforest.cli.one_scene import chosen_scene, find_scene
from relforest.cli.outputs import check_free
from relforest.cli.progress import note, working
from relforest.support.errors import InputError


@final
@dataclass(frozen=True, slots=True)
class ExplainOptions:
    """Explain what a learned model predicts for a scene, and what would turn it.

    Printed are the prediction; the questions whose answers decided, the strongest first, with the objects
    that they are about; and the smallest move of one object that would turn the predicted class. With --out,
    a page shows the scene with all this: colors tell what would be predicted if one object were elsewhere,
    and whoever points at a question sees its objects. The page opens from disk, without a network.

    For example:
      relforest explain outcomes.json --scene 17 of passes.parquet
      relforest explain outcomes.json --scene 17 of passes.parquet --out why.html
      relforest explain tree.json --scene 17 of passes.csv --object p4 --within 0 0 105 68

    Parameters
    ----------
    model
        Model file written by relforest fit.
    scene
        Id of the scene, written as in the table, and its Parquet or CSV file: "--scene K of FILE", or
        "--scene K --of FILE".
    of
        The file of the scene, if --scene does not name it.
    object
        Id of the object that colors are about, or the name of an argument. Default: the one whose move turns
        the prediction.
    within
        Where objects may go: the least coordinates, then the largest ones, such as LEFT LOW RIGHT HIGH.
        Default: where the objects of the scene are, and a fifth more on every side.
    csv
        How a CSV file is written.
    jobs
        Threads; the result does not depend on it.
    out
        Page to write (.html), for scenes in the plane.
    force
        Replace the page if it exists.
    """

    model: Annotated[Positional[Path], arg(metavar="MODEL")]
    scene: Annotated[tuple[str, ...], arg(metavar="K [of FILE]", help_behavior_hint="")] = ()
    of: Annotated[Path | None, arg(metavar="FILE", help_behavior_hint="")] = None
    object: Annotated[str | None, arg(metavar="ID", help_behavior_hint="")] = None
    within: Annotated[tuple[float, ...], arg(metavar="NUMBER...", help_behavior_hint="")] = ()
    csv: OmitArgPrefixes[CsvOptions] = field(default_factory=CsvOptions)
    jobs: int = 1
    out: Annotated[Path | None, arg(metavar="PAGE", help_behavior_hint="(default: no page)")] = None
    force: bool = False


def explain(options: ExplainOptions) -> int:
    """Explain a prediction with the given options; the exit code is 0."""
    chosen = chosen_scene(options.scene, options.of)
    if chosen is None:
        raise InputError("a prediction is about a scene: add --scene K of FILE")
    if options.out is not None:
        if options.out.suffix.lower() != ".html":
            raise InputError(f"{options.out} is no .html file: explanations are written as pages")
        check_free(options.out, force=options.force)

    from relforest.explaining import explain_prediction, explanation_page, row_named
    from relforest.models import read_model
    from relforest.support.files import write_text

    model = read_model(options.model)
    key, path = chosen
    scene = find_scene(key, path, model, options.csv.dialect)
    scene = scene.compact()
    half = len(options.within) // 2
    with working(f"explaining scene {key}"):
        explanation = explain_prediction(
            model,
            scene,
            row=None if options.object is None else row_named(scene, options.object),
            within=(options.within[:half], options.within[half:]) if options.within else None,
            n_jobs=options.jobs,
        )
    print(explanation)
    if options.out is not None:
        write_text(options.out, explanation_page(explanation, title=f"Scene {key} of {path.name}"))
        note(f"wrote {options.out}")
    return 0
