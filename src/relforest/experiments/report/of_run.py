"""The folder of a run, or of several alike -> a section of a report."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from pkgutil import resolve_name
from typing import TYPE_CHECKING, Any

import numpy as np

from relforest.experiments.learned_policies import learned_policy
from relforest.experiments.methods import METHODS
from relforest.experiments.report.section import Part, Picture, Player, Section
from relforest.experiments.run_config import FORMAT, RUN
from relforest.experiments.sheets import Entry, Estimate, Passage, Sheet
from relforest.experiments.tasks import TASKS, MethodName, Task
from relforest.playing import page, record_episodes
from relforest.reports.learning_figure import reward_figure
from relforest.reports.policy_figure import policy_figure
from relforest.rl.experience_files import read_experience
from relforest.rl.fitted.value import QValue
from relforest.rl.saved_policy import read_policy
from relforest.runs.learner import Row
from relforest.runs.manifest import VERSION
from relforest.runs.store import metrics_of
from relforest.support.errors import InputError
from relforest.support.files import read_json

if TYPE_CHECKING:
    import gymnasium


def run_section(folder: Path, *, episodes: int, seed: int) -> Section:
    """Return rewards, and what the first run has learned: in words, drawn, and played.

    Raises
    ------
    InputError
        If no run has learned anything yet, or task or method are unknown here.
    ModelFormatError
        If a file is damaged.
    """
    document = read_json(folder / RUN, format=FORMAT, version=VERSION)
    task = TASKS.get(str(document.get("task")))
    name = next((name for name in METHODS if name == document.get("method")), None)
    if task is None or name is None:
        raise InputError(f"{folder} is of a task or by a method that this version of relforest does not have")
    folders = sorted(folder.glob("run-[0-9]*")) or [folder]
    metrics = [rows for rows in map(metrics_of, folders) if len(rows) > 1]
    if not metrics:
        raise InputError(f"{folder} has not finished an iteration yet: report it later")
    first = next(each for each in folders if len(metrics_of(each)) > 1)
    wanted = int(document["iterations"])
    work = f"iterations: {wanted}, of {document['episodes']} episodes each; seed: {document['seed']}"
    lead = [f"{METHODS[name].title} learns {task.name}; {work}."]
    if behind := [each.name for each in folders if len(metrics_of(each)) <= wanted]:
        lead.append(f"Not finished yet: {', '.join(behind)}.")
    curve = reward_figure({task.name: metrics}, optimum=task.optimum)
    env = task.make()
    parts = (
        Picture("rewards of test episodes", curve),
        _table(metrics),
        *_learned(first, task, name, env),
        _player(first, task, env, episodes, seed),
    )
    return Section(f"{task.name}, {METHODS[name].title}", tuple(lead), (), parts)


def _table(metrics: Sequence[Sequence[Row]]) -> Sheet:
    columns = {
        "iteration": "",
        "test reward": ".3f",
        "training reward": ".3f",
        "trees": ".0f",
        "leaves": ".0f",
    }
    names = ("test_reward", "train_reward", "trees", "leaves")
    rows: list[tuple[Entry, ...]] = []
    for iteration in range(max(map(len, metrics))):
        reached = [rows[iteration] for rows in metrics if len(rows) > iteration]
        found = ([row[name] for row in reached if row.get(name) is not None] for name in names)
        rows.append((iteration, *(Estimate.of(np.array(each, dtype=np.float64)) for each in found)))
    several = f", means of {len(metrics)} runs with 95 % intervals" if len(metrics) > 1 else ""
    return Sheet(f"After each iteration{several}", columns, tuple(rows))


def _learned(folder: Path, task: Task, name: MethodName, env: gymnasium.Env[Any, Any]) -> Iterator[Part]:
    """Yield what the policy of a run asks, drawn and in words, as far as its method can tell."""
    if (drawn := task.pictures[name]) is not None:
        yield Picture(f"what {folder.name} has learned", drawn.draw(folder, env))
    if (told := METHODS[name].report) is None:
        return
    value = read_policy(folder)
    if isinstance(value, QValue):
        iteration = len(metrics_of(folder)) - 1
        batches = read_experience(folder, iteration, value.schema, value.action_types)
        yield Picture("what matters most", policy_figure(value, batches[-1]))
    yield Passage(f"What {folder.name} asks", str(resolve_name(told)(folder)))


def _player(folder: Path, task: Task, env: gymnasium.Env[Any, Any], episodes: int, seed: int) -> Player:
    recordings = record_episodes(env, learned_policy(folder, env), episodes, seed, explain=True)
    title = f"{task.name}, played by {folder.name}"
    return Player(f"Episodes of {folder.name}, and why it decides so", page(recordings, title=title))
