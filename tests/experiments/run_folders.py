"""Small runs of the corridor, and how their folders are compared."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Final

from relforest.experiments.keepaway_team import Team
from relforest.experiments.run_config import RunConfig
from relforest.experiments.sarsa import SarsaLearner, Trained
from relforest.rl.baselines import SarsaSettings
from relforest.runs import Run, RunStore
from relforest.support.rng import seed_sequence
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
