"""``relforest learn``: a policy from experience."""

# Heavy imports wait until the command runs, so that --help answers at once.
# ruff: noqa: PLC0415

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from pkgutil import resolve_name
from typing import TYPE_CHECKING, Annotated, Any, Literal, final

from tyro.conf import OmitArgPrefixes, Positional, arg

from relforest.cli.early_checks import UsageError, option_name
from relforest.cli.learner_options import QOptions, RPIOptions, SarsaOptions, given
from relforest.cli.progress import note, working
from relforest.experiments.methods import METHODS
from relforest.experiments.tasks import MethodName
from relforest.rl.fitted.settings import Source
from relforest.support.progress import Stage

if TYPE_CHECKING:
    from relforest.experiments.run_config import RunConfig


@final
@dataclass(frozen=True, slots=True)
class LearnOptions:
    """Learn a policy for a world.

    In every iteration, SMRF-RPI plays episodes, learns trees that explain the Bellman error, and learns a
    policy with the trees as features. smrf-q needs fewer episodes: it learns values as a sum of what
    relational questions add or, where the number of actions is limited, by forests. Sarsa with tile coding,
    the learner of the keepaway benchmark, learns during the episodes. The run folder receives metrics.jsonl
    (a line per iteration, the first one before learning), trees/*.json (SMRF-RPI), policy.json, reward.png,
    and q-function.png (corridor, SMRF-RPI) or policy-map.png (keepaway). Run the same command again to
    resume an interrupted run, with the same result; more iterations extend a finished one.

    For example:
      relforest learn corridor
      relforest learn corridor --episodes 500 --iterations 5 --runs 30 --jobs 2 --seed 0 --out runs/corridor
      relforest learn keepaway --method smrf-q --episodes 100 --iterations 5 --test-episodes 300
      relforest learn keepaway --method cmac-sarsa --episodes 500 --iterations 10

    Parameters
    ----------
    task
        What to learn: corridor, keepaway (3 against 2 on 20 m by 20 m), keepaway-25 (on 25 m by 25 m),
        keepaway-4v3 (on 25 m by 25 m), keepaway-5v4 (on 30 m by 30 m), keepaway-6v5 (on 35 m by 35 m),
        high-towers, color-grouping or color-grouping-rgb (5 blocks; colors differ as people see it, or by
        red, green and blue), or arch (3 blocks; a trainer that errs on purpose shows arches, and a search
        looks for places).
    method
        Learner: smrf-rpi, smrf-q or, for keepaway, cmac-sarsa (each keeper learns alone, as in the
        benchmark), cmac-sarsa-shared (all learn from everyone's experience), rbf-sarsa (radial basis
        functions instead of tiles), sarsa-on-smrf (the trees of a run of smrf-rpi instead), linear-q, lspi,
        trees-q or boosting-q (fitted Q and LSPI on the benchmark's state variables), dqn or deep-sets-q
        (networks; need the extra "bench").
    episodes
        Training episodes per iteration.
    iterations
        Iterations per run.
    runs
        Independent runs; several are written to subfolders of the run folder.
    test_episodes
        Test episodes after each iteration.
    seed
        Random seed; the same seed gives the same result.
    jobs
        Processes for several runs, or threads for a single run of SMRF-RPI; -1 = all cores. The result does
        not depend on it.
    out
        Run folder.
    from_
        With smrf-q, begin with the policy of this run of smrf-q, such as one with fewer players, and learn
        what is different; with sarsa-on-smrf, learn weights for the trees of this run of smrf-rpi.
    rpi
        Only with --method smrf-rpi.
    q
        Only with --method smrf-q.
    sarsa
        Only with --method cmac-sarsa, cmac-sarsa-shared, rbf-sarsa or sarsa-on-smrf.
    """

    task: Annotated[
        Positional[
            Literal[
                "corridor",
                "keepaway",
                "keepaway-25",
                "keepaway-4v3",
                "keepaway-5v4",
                "keepaway-6v5",
                "high-towers",
                "color-grouping",
                "color-grouping-rgb",
                "arch",
                "arch-done",
            ]
        ],
        arg(metavar="TASK"),
    ]
    method: MethodName = "smrf-rpi"
    episodes: int = 500
    iterations: int = 5
    runs: int = 1
    test_episodes: Annotated[
        int | None, arg(metavar="INT", help_behavior_hint="(default: as many as --episodes)")
    ] = None
    seed: int = 0
    jobs: int = 1
    out: Annotated[Path | None, arg(metavar="FOLDER", help_behavior_hint="(default: runs/TASK)")] = None
    from_: Annotated[Path | None, arg(name="from", metavar="RUN", help_behavior_hint="")] = None
    rpi: OmitArgPrefixes[Annotated[RPIOptions, arg(name="smrf-rpi")]] = field(default_factory=RPIOptions)
    q: OmitArgPrefixes[Annotated[QOptions, arg(name="smrf-q")]] = field(default_factory=QOptions)
    sarsa: OmitArgPrefixes[SarsaOptions] = field(default_factory=SarsaOptions)


def learn(options: LearnOptions) -> int:
    """Learn; the exit code is 0."""
    from rich.console import Console

    config = _config(options)
    out = Path("runs") / options.task if options.out is None else options.out
    console = Console(stderr=True)
    with working("loading", console) as show:
        from relforest.experiments.run_pictures import pictures_of
        from relforest.experiments.runs import learn_runs
        from relforest.runs.store import iterations_of

        several = f"{options.runs} runs of " if options.runs > 1 else ""
        plural = "s" if options.iterations > 1 else ""
        note(f"learning {options.task} in {out}: {several}{options.iterations} iteration{plural}", console)
        # Every run has one more row than iterations: the test before learning.
        rows = options.runs * (options.iterations + 1)
        done = sum(iterations_of(folder) + 1 for folder in config.folders(out))
        show(Stage("iterations", done, rows))

        def announce(run: int, row: dict[str, Any], seconds: dict[str, float]) -> None:
            nonlocal done
            done += 1
            note(_iteration_line(config, run, row, seconds), console)
            show(Stage("iterations", done, rows))

        folders = learn_runs(config, out, n_jobs=options.jobs, on_iteration=announce)
    print(_result(config, folders))
    print()
    print(f"run folder: {out}")
    for picture in pictures_of(config, out):
        print(f"picture: {picture}")
    return 0


def _config(options: LearnOptions) -> RunConfig:
    """Check the options, before heavy imports."""
    from relforest.experiments.run_config import RunConfig
    from relforest.experiments.tasks import task_named

    own = METHODS[options.method].settings
    for owner in METHODS.values():
        foreign = given(getattr(options, owner.settings)) if owner.settings not in (None, own) else {}
        for name in map(option_name, foreign):
            raise UsageError(
                f"{name} is an option of {owner.title}: leave it out with --method {options.method}"
            )
    task = task_named(options.task)
    if options.method not in task.pictures:
        raise UsageError(
            f"--method {options.method} is not for {task.name}: use {' or '.join(task.pictures)}"
        )
    values: dict[str, Any] = {} if own is None else getattr(options, own).config(task)
    if options.from_ is None and METHODS[options.method].needs_source:
        raise UsageError(f"--method {options.method} needs the trees of a run of smrf-rpi: give --from")
    if options.from_ is not None:
        if "source" not in METHODS[options.method].options:
            raise UsageError(
                f"--from is for smrf-q and sarsa-on-smrf: leave it out with --method {options.method}"
            )
        if values.get("source") is not None:
            raise UsageError("--from and --questions-from exclude each other: leave one out")
        values["source"] = Source(options.from_)
    return RunConfig(
        options.task,
        episodes=options.episodes,
        iterations=options.iterations,
        runs=options.runs,
        seed=options.seed,
        test_episodes=options.test_episodes,
        method=options.method,
        **values,
    )


def _iteration_line(config: RunConfig, run: int, row: dict[str, Any], seconds: dict[str, float]) -> str:
    name = f"run {run}, " if config.runs > 1 else ""
    time = f", {sum(seconds.values()):.1f} s" if seconds else ""
    has_trees = METHODS[config.method].report is not None
    counts = f", {row['trees']} trees, {row['leaves']} leaves" if has_trees else ""
    return f"{name}iteration {row['iteration']}: test reward {row['test_reward']:.3f}{counts}{time}"


def _result(config: RunConfig, folders: list[Path]) -> str:
    """Describe what was learned: all of a single run; of several, means and the first."""
    from relforest.reports.run_report import averages_table, metrics_table
    from relforest.runs.learner import METRIC_NAMES
    from relforest.runs.store import metrics_of

    report = METHODS[config.method].report
    # Where nothing but rewards can be told, there are no trees and leaves.
    names = METRIC_NAMES if report else METRIC_NAMES[:3]
    first = resolve_name(report)(folders[0]) if report else metrics_table(metrics_of(folders[0]), names)
    if config.runs == 1:
        return first
    averages = averages_table([metrics_of(folder) for folder in folders], names)
    return f"mean (standard deviation) of {config.runs} runs\n{averages}\n\nfirst run\n{first}"
