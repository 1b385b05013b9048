"""``relforest experiment``: the studies of the library."""

# Heavy imports wait until the command runs, so that --help answers at once.
# ruff: noqa: PLC0415

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Final, final

from tyro.conf import Positional, arg

from relforest.cli.early_checks import unknown
from relforest.cli.progress import note, working

_CHOICE: Final = arg(metavar="NAME[,NAME...]", help_behavior_hint="(default: all)")
_SIZE: Final = arg(metavar="N", help_behavior_hint="(default: as in the README of the study)")


@final
@dataclass(frozen=True, slots=True)
class ExperimentOptions:
    """Run one of the library's studies, or list them.

    A study computes its settings, saves the rows of each, and compares its findings with bounds. Run the same
    command again to resume an interrupted study. The exit code is 1 if a full study misses a bound.

    For example:
      relforest experiment
      relforest experiment mil --smoke
      relforest experiment concepts --jobs 2 --out runs/concepts
      relforest experiment mil --methods covagg,dd --datasets musk1
      relforest experiment corridor --runs 10 --dask tcp://10.0.0.5:8786

    Parameters
    ----------
    name
        Name of the study.
    smoke
        Run a small version that takes seconds; its numbers are meaningless.
    seed
        Random seed; the same seed gives the same rows.
    jobs
        Processes; -1 = all cores. The result does not depend on it.
    out
        Folder for the results.
    methods
        Only these methods or variants, in studies that compare some.
    datasets
        Only these data sets, in studies that use some. The rest may be computed later.
    runs
        Runs of each learner, in studies of learning. Results of another size need another folder.
    iterations
        Iterations of each run, in studies of learning.
    episodes
        Training episodes per iteration, in studies of learning.
    dask
        Address of a Dask scheduler, whose workers compute instead of processes on this machine; they need
        the same versions of relforest and its dependencies. Files are only written here.
    """

    name: Annotated[Positional[str], arg(metavar="[NAME]", help_behavior_hint="(default: list them)")] = ""
    smoke: bool = False
    seed: int = 0
    jobs: int = 1
    out: Annotated[
        Path | None, arg(metavar="FOLDER", help_behavior_hint="(default: runs/NAME or runs/NAME-smoke)")
    ] = None
    methods: Annotated[tuple[str, ...], _CHOICE] = ()
    datasets: Annotated[tuple[str, ...], _CHOICE] = ()
    runs: Annotated[int | None, _SIZE] = None
    iterations: Annotated[int | None, _SIZE] = None
    episodes: Annotated[int | None, _SIZE] = None
    dask: Annotated[str | None, arg(metavar="ADDRESS", help_behavior_hint="(default: this machine)")] = None


def experiment(options: ExperimentOptions) -> int:
    """Run a study; the exit code is 1 if a full study misses a bound, else 0."""
    from relforest.experiments.registry import STUDIES, question_of

    if not options.name:
        width = max(map(len, STUDIES))
        for name in STUDIES:
            print(f"{name:<{width}}  {question_of(name)}")
        return 0
    if options.name not in STUDIES:
        raise unknown("study", options.name, STUDIES)

    from rich.console import Console

    from relforest.experiments.cluster import on_cluster
    from relforest.experiments.runner import run_study
    from relforest.experiments.study import resized

    sizes = {"runs": options.runs, "iterations": options.iterations, "episodes": options.episodes}
    study = resized(
        STUDIES[options.name], {name: number for name, number in sizes.items() if number is not None}
    )
    default = f"{options.name}-smoke" if options.smoke else options.name
    out = Path("runs") / default if options.out is None else options.out
    console = Console(stderr=True)
    note(f"{study.name}: {study.question} Results go to {out}.", console)
    with working(study.name, console), on_cluster(options.dask, options.jobs) as jobs:
        findings = run_study(
            study,
            out,
            seed=options.seed,
            n_jobs=jobs,
            smoke=options.smoke,
            only={"methods": _names(options.methods), "datasets": _names(options.datasets)},
            on_progress=lambda line: note(line, console),
        )
    print(findings)
    if options.smoke or findings.are_met:
        return 0
    missed = sum(claim.is_missed for claim in findings.claims)
    note(f"relforest: {missed} of {len(findings.claims)} claims missed")
    return 1


def _names(texts: tuple[str, ...]) -> tuple[str, ...]:
    """Split names at commas."""
    return tuple(name.strip() for text in texts for name in text.split(",") if name.strip())
