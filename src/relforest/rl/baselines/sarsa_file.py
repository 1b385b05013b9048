"""A team of Sarsa agents as files: ``sarsa.json`` and the weights that it names.

The weights are in a file named after their content, which is written before ``sarsa.json`` refers to it, so
that an interruption leaves either the old model or the new one, never a mixture.
"""

from __future__ import annotations

import os
import re
from collections.abc import Mapping, Sequence
from hashlib import blake2b
from pathlib import Path
from typing import Any, Final, get_args

import numpy as np

from relforest.rl.baselines.feature_map import FeatureMap
from relforest.rl.baselines.kernels import LIMIT
from relforest.rl.baselines.sarsa import SarsaLambda
from relforest.rl.baselines.settings import SarsaSettings
from relforest.rl.baselines.tile_coding import TileCoding, TileKind
from relforest.scenes.arrays import FloatArray
from relforest.support.errors import InputError, ModelFormatError
from relforest.support.files import read_json, read_npz, write_json, write_npz
from relforest.support.rng import RandomState, seed_sequence, stream

FORMAT: Final = "relforest-sarsa"
VERSION: Final = 1
MODEL: Final = "sarsa.json"
MAX_AGENTS: Final = 1000

_WEIGHTS_FILE: Final = re.compile(r"sarsa-[0-9a-f]{16}\.npz")


def write_team(folder: str | os.PathLike[str], team: Sequence[SarsaLambda[Any]]) -> None:
    """Write the weights of agents, and which agents share them; traces and random streams are not stored.

    Parameters
    ----------
    folder : path
        Where to write; an existing model is replaced.
    team : sequence of SarsaLambda
        1 to 1000 agents, all with the same options and feature map.

    Raises
    ------
    InputError
        If the team is empty, or the agents differ in more than their weights.
    """
    document, arrays = describe_team(team)
    name = document["weights"]
    write_npz(Path(folder) / name, arrays)
    write_json(Path(folder) / MODEL, document)
    for path in sorted(Path(folder).iterdir()):
        if _WEIGHTS_FILE.fullmatch(path.name) and path.name != name:
            path.unlink()


def describe_team(team: Sequence[SarsaLambda[Any]]) -> tuple[dict[str, Any], dict[str, FloatArray]]:
    """Return the JSON document of a team and the arrays of the file that it names; see `write_team`."""
    if not 1 <= len(team) <= MAX_AGENTS:
        raise InputError(f"a team must have 1 to {MAX_AGENTS} agents, got {len(team)}")
    settings, features = team[0].settings, team[0].features.to_dict()
    for number, agent in enumerate(team):
        if agent.settings != settings or agent.features.to_dict() != features:
            raise InputError(
                f"the options or features of agent {number} differ from those of agent 0; write it elsewhere"
            )
    vectors = {id(agent.weights): agent.weights for agent in team}
    rows = {key: row for row, key in enumerate(vectors)}
    weights = np.stack(list(vectors.values()))
    if not np.abs(weights).max() <= LIMIT:
        raise InputError("the weights are not finite: learning diverged; use a lower alpha")
    document = {
        "format": FORMAT,
        "version": VERSION,
        "weights": f"sarsa-{_digest(weights)}.npz",
        "agents": [rows[id(agent.weights)] for agent in team],
        "settings": settings.to_dict(),
        "features": features,
    }
    return document, {"weights": weights}


def read_team(
    folder: str | os.PathLike[str],
    features: FeatureMap[Any] | None = None,
    *,
    learn: bool = True,
    random_state: RandomState = None,
) -> tuple[SarsaLambda[Any], ...]:
    """Read what `write_team` wrote; agents that shared weights share them again.

    Parameters
    ----------
    folder : path
        The folder of the model.
    features : FeatureMap, optional
        The feature map of the model. Only tile coding can be read from the file.
    learn : bool
        Whether the agents continue to learn.
    random_state : int, SeedSequence, Generator or None
        Seed of the team, as in `relforest.rl.baselines.team.make_team`.

    Raises
    ------
    ModelFormatError
        If a file is missing or malformed, or the features differ from those of the model.
    """
    path = Path(folder) / MODEL
    document = read_json(path, format=FORMAT, version=VERSION)
    settings = SarsaSettings.from_dict(document.get("settings"))
    view = _feature_map(document.get("features"), features, path)
    weights = _read_weights(document.get("weights"), view.n_features, path)
    seed = seed_sequence(random_state)
    return tuple(
        SarsaLambda(view, settings, weights=weights[row], learn=learn, random_state=stream(seed, i))
        for i, row in enumerate(_rows(document.get("agents"), len(weights), path))
    )


def _feature_map(stored: object, given: FeatureMap[Any] | None, path: Path) -> FeatureMap[Any]:
    if given is None:
        if isinstance(stored, Mapping) and stored.get("kind") in get_args(TileKind):
            return TileCoding.from_dict(stored)
        raise ModelFormatError(
            f"the features of {path} are {stored!r:.200}; only tile coding can be read from a file: "
            "pass the feature map that created them"
        )
    if given.to_dict() != stored:
        raise ModelFormatError(
            f"{path} was learned with other features: {stored!r:.200} there, {given.to_dict()!r:.200} here"
        )
    return given


def _read_weights(name: object, n_features: int, path: Path) -> list[FloatArray]:
    # A model from elsewhere must not cause files outside its folder to be read.
    if not isinstance(name, str) or not _WEIGHTS_FILE.fullmatch(name):
        raise ModelFormatError(f"{path} does not name a file of weights: {name!r:.200}")
    table = read_npz(path.parent / name, ["weights"])["weights"]
    if table.dtype != np.float64 or table.ndim != 2 or table.shape[1] != n_features:
        raise ModelFormatError(
            f"{path.parent / name} must contain rows of {n_features} float64, according to {path}, "
            f"got {table.dtype} of shape {table.shape}"
        )
    if not (np.abs(table) <= LIMIT).all():
        raise ModelFormatError(f"{path.parent / name} contains weights that are not finite")
    # Separate arrays: agents that do not share weights should share nothing.
    return [np.array(row) for row in table]


def _rows(agents: object, n_rows: int, path: Path) -> list[int]:
    if not isinstance(agents, list) or not 1 <= len(agents) <= MAX_AGENTS:
        raise ModelFormatError(f"{path} must list 1 to {MAX_AGENTS} agents, got {agents!r:.200}")
    valid = all(type(row) is int and 0 <= row < n_rows for row in agents)
    if not valid or set(agents) != set(range(n_rows)):
        raise ModelFormatError(
            f"{path} must assign one of the {n_rows} rows of weights to each agent, and use every row, "
            f"got {agents!r:.200}"
        )
    return agents


def _digest(weights: FloatArray) -> str:
    return blake2b(weights.tobytes(), digest_size=8).hexdigest()
