"""``relforest show``: print a model or what a run has learned, draw it, or write it as a page or code."""

# Heavy imports wait until the command runs, so that --help answers at once.
# ruff: noqa: PLC0415

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Final, final

from tyro.conf import OmitArgPrefixes, Positional, arg

from relforest.cli.csv_options import CsvOptions
from relforest.cli.one_scene import chosen_scene, find_scene
from relforest.cli.outputs import check_free
from relforest.cli.progress import note
from relforest.support.errors import InputError

if TYPE_CHECKING:
    from relforest.models import Model
    from relforest.scenes import Scenes

_SHARED: Final = (".html", ".py", ".sql")
_NEEDS_SCENE: Final = "a page shows a scene that can be changed: add --scene K of FILE"


@final
@dataclass(frozen=True, slots=True)
class ShowOptions:
    """Show a learned model in words and, with --out, a tree as a drawing.

    The drawing shows each question with its decision volume: mean, scaled eigenvectors and, in two
    dimensions, the ellipse over the training points. With --scene, the path of that scene through the tree
    is printed (and marked in the drawing): its answers, the leaf that decided, and the objects that led to
    it.

    With --scene and a file .html, a page is written in which the objects of the scene can be moved, while the
    model says what it predicts and why; it works offline. A file .py is a Python module that predicts without
    relforest, and a file .sql a script for DuckDB. All models can be written like this, not only trees.

    Of the folder of a run, what it has learned is printed. The drawing of a run of smrf-q shows what matters
    most to its policy: conditions over scenes of its experience, and what they add to the values of actions.

    For example:
      relforest show tree.json
      relforest show tree.json --out tree.svg
      relforest show tree.json --scene 17 of passes.parquet --out scene-17.png
      relforest show tree.json --scene 17 of passes.parquet --out play.html
      relforest show tree.json --out model.py
      relforest show runs/corridor/trees/0001-left-1.json
      relforest show runs/keepaway --out keepaway.png

    Parameters
    ----------
    model
        Model file written by relforest fit, a tree from a run folder, or the folder of a run of smrf-q or
        smrf-rpi.
    scene
        Id of a scene, written as in the table, and its Parquet or CSV file: "--scene K of FILE", or
        "--scene K --of FILE".
    of
        The file of the scene, if --scene does not name it.
    csv
        How a CSV file is written.
    out
        Picture (.svg or .png), page (.html) or code (.py or .sql) to write.
    force
        Replace the file if it exists.
    """

    model: Annotated[Positional[Path], arg(metavar="MODEL")]
    scene: Annotated[tuple[str, ...], arg(metavar="K [of FILE]", help_behavior_hint="")] = ()
    of: Annotated[Path | None, arg(metavar="FILE", help_behavior_hint="")] = None
    csv: OmitArgPrefixes[CsvOptions] = field(default_factory=CsvOptions)
    out: Annotated[Path | None, arg(metavar="FILE", help_behavior_hint="(default: none)")] = None
    force: bool = False


def show(options: ShowOptions) -> int:
    """Show a model with the given options; the exit code is 0."""
    chosen = chosen_scene(options.scene, options.of)

    from relforest.models import read_model
    from relforest.reports.figure_files import check_suffix
    from relforest.reports.tree_path import path_in_words, tree_path
    from relforest.trees import Tree

    suffix = "" if options.out is None else options.out.suffix.lower()
    if options.out is not None:
        if suffix not in _SHARED:
            check_suffix(options.out, others=_SHARED)
        elif (suffix == ".html") != (chosen is not None):
            raise InputError(
                _NEEDS_SCENE if suffix == ".html" else f"{options.out} is for all scenes: omit --scene"
            )
        check_free(options.out, force=options.force)
    if options.model.is_dir():
        if suffix in _SHARED:
            raise InputError(
                f"{options.model} is a folder, but only models and trees can be written as {suffix}"
            )
        if chosen is not None:
            raise InputError(f"--scene belongs to models and trees, and {options.model} is a folder: omit it")
        return _show_run(options)
    model = read_model(options.model)
    is_shared = suffix in _SHARED
    if not is_shared and (options.out is not None or chosen is not None):
        _ = model.tree  # an ensemble has neither a drawing nor a path
    scene = None if chosen is None else find_scene(*chosen, model, options.csv.dialect)
    print(model.text)
    if scene is not None and isinstance(model.learned, Tree):
        print()
        print(path_in_words(model.tree, tree_path(model.tree, scene)))
    if options.out is not None:
        (_share if is_shared else _draw)(options.out, model, scene)
        note(f"wrote {options.out}")
    return 0


def _draw(out: Path, model: Model, scene: Scenes | None) -> None:
    from relforest.reports import save_figure, tree_figure

    title = f"{'Mean' if model.classes is None else 'Probability'} of {model.outcome}"
    save_figure(tree_figure(model.tree, points=model.points, highlight=scene, title=title), out)


def _share(out: Path, model: Model, scene: Scenes | None) -> None:
    """Write a model as a page about a scene, or as code."""
    from relforest.sharing import play_page, program_of, python_code, sql_code
    from relforest.support.files import write_text

    program = program_of(model)
    if scene is not None:
        write_text(out, play_page(program, scene))
    else:
        write_text(out, python_code(program) if out.suffix.lower() == ".py" else sql_code(program))


def _show_run(options: ShowOptions) -> int:
    """Print what a run has learned and draw what matters most to its policy."""
    from relforest.experiments.learned_policies import method_of
    from relforest.reports import policy_figure, run_report, save_figure
    from relforest.rl.experience_files import read_experience
    from relforest.rl.fitted.value import QValue
    from relforest.rl.saved_policy import read_policy
    from relforest.runs import read_checkpoint

    folder, method = options.model, method_of(options.model)
    if method.report is None:
        raise InputError(
            f"{folder} was learned by {method.title}, which asks no questions: see relforest play"
        )
    print(run_report(folder))
    if options.out is not None:
        value, iteration = read_policy(folder), read_checkpoint(folder).iteration
        if not isinstance(value, QValue):
            raise InputError(f"{folder} consists of trees: draw one of those in {folder / 'trees'}")
        batches = read_experience(folder, iteration, value.schema, value.action_types)
        title = (
            f"What matters most in {folder.name} after {iteration} iteration{'' if iteration == 1 else 's'}"
        )
        save_figure(policy_figure(value, batches[-1], title=title), options.out)
        note(f"wrote {options.out}")
    return 0
