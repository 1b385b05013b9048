"""Small runs, and how their folders are compared."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Final

import numpy as np

from relforest.experiments.keepaway_team import Team
from relforest.experiments.run_config import RunConfig
from relforest.experiments.sarsa import SarsaLearner, Trained
from relforest.experiments.tasks import task_named
from relforest.forests import Condition
from relforest.forests.statements import Bound, Statement
from relforest.mappings import Mapping
from relforest.rl.baselines import SarsaSettings
from relforest.rl.fitted import QLearner, QSettings, QValue
from relforest.rl.fitted.learner import QKnowledge
from relforest.rl.fitted.questions import Question
from relforest.rl.fitted.sum import Sum
from relforest.rl.fitted.view import View
from relforest.rl.learner import Knowledge, RPILearner
from relforest.rl.policy import RandomPolicy
from relforest.rl.rollout import rollout, world_of
from relforest.rl.settings import RPISettings
from relforest.rl.value import ValueFunction
from relforest.runs import METRIC_NAMES, Run, RunStore
from relforest.scenes import Schema
from relforest.support.rng import seed_sequence
from relforest.trees import Instantiation, Leaf, Tree
from relforest.trees import Question as TreeQuestion
from relforest.volumes import Ellipsoid
from relforest.worlds.keepaway.server.options import KeepawayOptions

SMALL: Final = RunConfig("corridor", episodes=4, iterations=1, test_episodes=2)
TWO_RUNS: Final = replace(SMALL, runs=2)


def contents(folder: Path, *, pictures: bool = True) -> dict[str, bytes]:
    """Return every file that must be the same after any interruption, by name."""
    return {
        path.relative_to(folder).as_posix(): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file()
        and path.name not in {"timings.jsonl", ".lock"}
        and (pictures or path.suffix != ".png")
    }


def stamps(folder: Path) -> dict[str, int]:
    """Return when each of these files was written last."""
    return {name: (folder / name).stat().st_mtime_ns for name in contents(folder)}


def write_run_of_sarsa(folder: Path, team: Team, rules: KeepawayOptions) -> None:
    """Write a run of Sarsa before learning, with a given team."""
    learner = SarsaLearner(rules, SarsaSettings(), False, seed_sequence(0), 1, 1)  # noqa: FBT003
    row = {"iteration": 0, "test_reward": 1.0, "train_reward": None, "trees": 0, "leaves": 0}
    RunStore(folder, learner).write(Run(Trained(team), (row,)))


def write_run_of_trees(folder: Path) -> None:
    """Write a run of SMRF-RPI in keepaway, with a tree that asks whether the receiver is near the centre."""
    world = world_of(task_named("keepaway").make())
    learner = RPILearner(task_named("keepaway").make(), RPISettings(), seed_sequence(0), 1, 1)
    schema = Schema(world.schema.attributes, world.action_types[1].parameters)
    centre = Ellipsoid(np.zeros(2), np.eye(2), 5.0, 1, 0.0)
    asked = TreeQuestion(Mapping("identity", schema["location"]), (1,), centre, 3, 4, 5)
    leaves = [Leaf(probability, 1, 1) for probability in (0.9, 0.1, 0.5)]
    tree = Tree(schema, (Instantiation(1), Instantiation(2), asked, *leaves))
    weights = (np.array([1.0]), np.array([0.5, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0]))
    value = ValueFunction(world.schema, world.action_types, "densities+bits", ((), (tree,)), weights)
    row = {"iteration": 0, "test_reward": 1.0, "train_reward": None, "trees": 1, "leaves": 3}
    RunStore(folder, learner).write(Run(Knowledge(value, ((), ("0001-pass-1.json",)), ()), (row,)))


def write_run_of_questions(folder: Path, iterations: int = 1) -> None:
    """Write a run of smrf-q in the corridor, with a policy that goes to the nearer end."""
    env = task_named("corridor").make()
    world, learner = world_of(env), QLearner(env, QSettings(), seed_sequence(0), 4, 2)
    place = Mapping("identity", world.schema["location"])
    right = Condition(1, (Statement(place, (0,), Bound(0, "at least", 0.5)),))
    knots, falls = (-0.5, -0.25, 0.0, 0.25, 0.5), (2.0, 1.0, 0.0, -1.0, -2.0)
    questions = ((Question(right, knots, falls[::-1], 1.0),), (Question(right, knots, falls, 2.0),))
    view = View(world.schema, ())
    value = QValue(
        view, world.action_types, Sum(view.schemas(world.action_types), None, (1.0, 1.5), questions)
    )
    batch = rollout(env, RandomPolicy(), 4, seed_sequence(0))
    rows = tuple(
        dict(zip(METRIC_NAMES, (number, 1.0, 1.0 if number else None, 2, 10), strict=True))
        for number in range(iterations + 1)
    )
    known = QKnowledge(value, (batch,) * iterations) if iterations else QKnowledge(None, ())
    RunStore(folder, learner).write(Run(known, rows))
