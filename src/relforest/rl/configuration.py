"""Everything that the result of a run depends on, as plain JSON values, and its comparison."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from relforest.rl.rollout import Environment, world_of
from relforest.rl.settings import RPISettings
from relforest.rl.value import ValueFunction
from relforest.support.documents import well_formed
from relforest.support.errors import InputError, RunFolderError


def describe_run(
    env: Environment, settings: RPISettings, seed: np.random.SeedSequence, episodes: tuple[int, int]
) -> dict[str, Any]:
    """Return the configuration of a run; `episodes` are training and test episodes per iteration."""
    world = world_of(env)
    return {
        "random_state": _seed_to_dict(seed),
        "episodes": episodes[0],
        "test_episodes": episodes[1],
        "settings": settings.to_dict(),
        "world": {
            "name": type(world).__name__,
            "options": _options(env),
            "discount": float(world.discount),
        },
    }


def restore_run(configuration: Mapping[str, Any], folder: Path) -> tuple[np.random.SeedSequence, RPISettings]:
    """Return the seed and the settings of a stored configuration.

    Raises
    ------
    ModelFormatError
        If they are missing or malformed; the message names `folder`.
    """
    with well_formed(f"the checkpoint in {folder} is damaged"):
        stored = configuration["random_state"]
        seed = np.random.SeedSequence(stored["entropy"], spawn_key=tuple(stored["spawn_key"]))
        return seed, RPISettings.from_dict(configuration["settings"])


def check_configuration(there: Mapping[str, Any], here: Mapping[str, Any], folder: Path) -> None:
    """Check that a run folder contains the run that is about to be continued.

    Raises
    ------
    RunFolderError
        If it does not; the message names every difference.
    """
    differing = differences(there, here)
    if differing:
        raise RunFolderError(
            f"{folder} contains a run with a different configuration: {'; '.join(differing)}; "
            "choose another folder, or use the configuration of that run"
        )


def check_world(value: ValueFunction, env: Environment) -> None:
    """Check that an agent can act in a world.

    Raises
    ------
    InputError
        If the attributes of objects or the action types differ. Numbers of objects may differ.
    """
    world = world_of(env)
    name = type(world).__name__
    if world.schema.attributes != value.schema.attributes:
        raise InputError(
            f"the agent was trained on objects with {value.schema.names}, but {name} has "
            f"{world.schema.names}: use a world with the same attributes"
        )
    if tuple(world.action_types) != value.action_types:
        raise InputError(
            f"the agent knows the action types {[kind.name for kind in value.action_types]}, but {name} has "
            f"{[kind.name for kind in world.action_types]}: names and parameters must be the same"
        )


def differences(there: object, here: object, name: str = "") -> list[str]:
    """Return the differences between two configurations, such as ``episodes (500 there, 10 here)``."""
    if isinstance(there, Mapping) and isinstance(here, Mapping):
        found: list[str] = []
        for key in dict.fromkeys([*there, *here]):
            found += differences(there.get(key), here.get(key), f"{name}.{key}" if name else str(key))
        return found
    return [] if there == here else [f"{name} ({there!r} there, {here!r} here)"]


def _seed_to_dict(seed: np.random.SeedSequence) -> dict[str, Any]:
    entropy = seed.entropy
    words = entropy if isinstance(entropy, int) else [int(word) for word in np.ravel(np.asarray(entropy))]
    return {"entropy": words, "spawn_key": [int(word) for word in seed.spawn_key]}


def _options(env: Environment) -> dict[str, Any]:
    """Return the options that an environment was created with, as far as Gymnasium records them."""
    spec = getattr(env, "spec", None)
    options = {} if spec is None else {"id": spec.id, **spec.kwargs}
    plain = (bool, int, float, str, type(None))
    return {str(name): value if isinstance(value, plain) else repr(value) for name, value in options.items()}
