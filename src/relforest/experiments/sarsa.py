"""Sarsa with the tile coding of the keepaway benchmark, bells or trees, as a learner in iterations."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, ClassVar, Final, final

import numpy as np

from relforest.experiments.keepaway_team import Team, benchmark_team, play_episodes_with, renewed
from relforest.rl.baselines import SarsaSettings, make_team, read_team
from relforest.rl.baselines.sarsa_file import MODEL, describe_team
from relforest.rl.baselines.tile_coding import TileKind
from relforest.rl.configuration import seed_to_dict
from relforest.rl.frozen import ForestFeatures
from relforest.rl.policy_json import TREE_FILES, plain_policy, policy_of
from relforest.runs.learner import Row, Snapshot
from relforest.runs.store import read_checkpoint
from relforest.support.documents import well_formed
from relforest.support.errors import InputError, ModelFormatError
from relforest.support.progress import part
from relforest.support.rng import stream
from relforest.worlds.keepaway.decisions.scene import ACTION_TYPES, SCHEMA
from relforest.worlds.keepaway.server.options import KeepawayOptions

_TRAINING, _TESTING, _AGENTS = 0, 1, 2
_TEAM: Final = "team"
_FEATURES: Final = "features"


@final
@dataclass(frozen=True, slots=True, eq=False)
class Trained:
    """A team after an iteration; its agents are never changed."""

    team: Team
    reward: float | None = None
    """Mean duration of the training episodes of the iteration, in cycles; None if unknown."""


@final
@dataclass(frozen=True, slots=True, eq=False)
class SarsaLearner:
    """Sarsa; rewards are durations of episodes in cycles.

    Its files are those of `relforest.rl.baselines.write_team` in ``model-0001/`` and so on, of the last
    iteration, and the trees that it began with, if any.
    """

    rules: KeepawayOptions
    settings: SarsaSettings
    shared: bool  # whether all agents learn from everyone's experience
    seed: np.random.SeedSequence  # of the whole run
    episodes: int
    test_episodes: int
    """Training and test episodes per iteration."""
    kind: TileKind = "tiles"  # the features, see `relforest.experiments.keepaway_team.benchmark_team`
    source: Path | None = None
    """A run of SMRF-RPI; its trees are the features instead. It is read once, when the new run begins."""

    files: ClassVar[re.Pattern[str]] = re.compile(
        rf"model-\d{{4}}/sarsa(-[0-9a-f]{{16}}\.npz|\.json)|{TREE_FILES}"
    )

    @property
    def configuration(self) -> dict[str, Any]:
        """Everything that the result depends on, as plain JSON values."""
        rules = asdict(self.rules).items()
        return {
            "random_state": seed_to_dict(self.seed),
            "episodes": self.episodes,
            "test_episodes": self.test_episodes,
            "settings": self.settings.to_dict(),
            "shared": self.shared,
            "rules": {name: list(value) if isinstance(value, tuple) else value for name, value in rules},
            # Older runs name no features.
            **({} if self.kind == "tiles" else {"features": self.kind}),
            **({} if self.source is None else {"from": str(self.source)}),
        }

    def start(self) -> Trained:
        """Return untrained agents."""
        seed = stream(self.seed, 0, _AGENTS)
        if self.source is not None:
            features = _trees_of(self.source)
            team = make_team(
                features, self.rules.keepers, self.settings, shared=self.shared, random_state=seed
            )
            return Trained(team)
        return Trained(
            benchmark_team(self.rules, self.settings, kind=self.kind, shared=self.shared, random_state=seed)
        )

    def iterate(self, state: Trained, number: int) -> Trained:
        """Let the agents learn while they play."""
        seed = stream(self.seed, number)
        team = renewed(state.team, stream(seed, _AGENTS), learn=True)
        with part("training"):
            played = play_episodes_with(team, self.rules, self.episodes, stream(seed, _TRAINING))
        return Trained(team, float(played.mean()))

    def evaluate(self, state: Trained, number: int) -> Row:
        """Play test episodes without learning."""
        seed = stream(self.seed, number, _TESTING)
        with part("testing"):
            team = renewed(state.team, seed, learn=False)
            tested = play_episodes_with(team, self.rules, self.test_episodes, seed)
        reward = {"test_reward": float(tested.mean()), "train_reward": state.reward}
        return {**reward, "trees": 0, "leaves": 0}

    def to_plain(self, state: Trained, number: int) -> Snapshot:
        """Return the name of the folder of the team, and the files in it."""
        document, arrays = describe_team(state.team)
        folder = f"model-{number:04d}"
        files = {f"{folder}/{document['weights']}": arrays, f"{folder}/{MODEL}": document}
        features = state.team[0].features
        if not isinstance(features, ForestFeatures):
            return Snapshot({_TEAM: folder}, files)
        policy, trees = plain_policy(features.value, features.tree_names)
        return Snapshot({_TEAM: folder, _FEATURES: policy}, {**files, **trees})

    def from_plain(self, document: Mapping[str, Any], number: int, folder: Path) -> Trained:
        """Read the team; its random streams are renewed in every iteration.

        Raises
        ------
        ModelFormatError
            If a file is missing or malformed.
        """
        if document.get(_TEAM) != f"model-{number:04d}":
            raise ModelFormatError(f"the checkpoint in {folder} does not name the team of iteration {number}")
        features = _stored_features(document, folder)
        return Trained(read_team(folder / f"model-{number:04d}", features, random_state=0))


def trained_team(folder: Path) -> Team:
    """Return the present agents of a run of Sarsa, without learning.

    Raises
    ------
    ModelFormatError
        If the folder does not contain such a run, or a file is missing or damaged.
    """
    checkpoint = read_checkpoint(folder)
    with well_formed(f"{folder} does not contain a run of Sarsa"):
        name = checkpoint.document[_TEAM]
        if name != f"model-{checkpoint.iteration:04d}":
            raise ModelFormatError("its checkpoint does not name the team of its iteration")
    return read_team(folder / name, _stored_features(checkpoint.document, folder), learn=False)


def _stored_features(document: Mapping[str, Any], folder: Path) -> ForestFeatures | None:
    """Return the trees of a checkpoint of Sarsa, None if it has other features."""
    return ForestFeatures(*policy_of(document[_FEATURES], folder)) if _FEATURES in document else None


def _trees_of(folder: Path) -> ForestFeatures:
    """Return the trees of a run of SMRF-RPI that played keepaway.

    Raises
    ------
    InputError
        If it is another run, or has no trees yet.
    ModelFormatError
        If a file is missing or malformed.
    """
    document = read_checkpoint(folder).document
    if "policy" not in document:
        raise InputError(f"{folder} is no run of smrf-rpi: sarsa-on-smrf needs the trees of one")
    value, names = policy_of(document, folder)
    if (value.schema, value.action_types) != (SCHEMA, ACTION_TYPES):
        raise InputError(f"{folder} was not learned in keepaway: give a run that has seen its players")
    if not value.n_trees:
        raise InputError(f"{folder} has no trees: let it learn first")
    return ForestFeatures(value, names)
