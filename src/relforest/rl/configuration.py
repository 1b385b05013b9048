"""Everything that the result of a run depends on, as plain JSON values, and back."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from relforest.rl.rollout import Environment, world_of
from relforest.rl.settings import RPISettings
from relforest.scenes import Schema
from relforest.smdp import ActionType
from relforest.support.documents import well_formed
from relforest.support.errors import InputError


def describe_run(
    env: Environment, settings: Mapping[str, Any], seed: np.random.SeedSequence, episodes: tuple[int, int]
) -> dict[str, Any]:
    """Return the configuration of a run; `episodes` are training and test episodes per iteration."""
    world = world_of(env)
    return {
        "random_state": seed_to_dict(seed),
        "episodes": episodes[0],
        "test_episodes": episodes[1],
        "settings": settings,
        "world": {
            "name": type(world).__name__,
            "options": environment_options(env),
            "discount": float(world.discount),
        },
    }


def restore_run(
    configuration: Mapping[str, Any], folder: Path
) -> tuple[np.random.SeedSequence, RPISettings, tuple[int, int]]:
    """Return the seed, the settings and the episodes of a stored configuration; see `describe_run`.

    Raises
    ------
    ModelFormatError
        If they are missing or malformed; the message names `folder`.
    """
    with well_formed(f"the checkpoint in {folder} is damaged"):
        stored = configuration["random_state"]
        seed = np.random.SeedSequence(stored["entropy"], spawn_key=tuple(stored["spawn_key"]))
        episodes = int(configuration["episodes"]), int(configuration["test_episodes"])
        return seed, RPISettings.from_dict(configuration["settings"]), episodes


def check_world(schema: Schema, action_types: tuple[ActionType, ...], env: Environment) -> None:
    """Check that an agent that knows these attributes and action types can act in a world.

    Raises
    ------
    InputError
        If the attributes of objects or the action types differ. Numbers of objects may differ.
    """
    check_attributes(schema, env)
    world = world_of(env)
    if tuple(world.action_types) != action_types:
        there, here = ([known.name for known in types] for types in (action_types, world.action_types))
        raise InputError(
            f"the agent knows the action types {there}, but {type(world).__name__} has {here}: names and "
            "parameters must be the same"
        )


def check_attributes(schema: Schema, env: Environment) -> None:
    """Raise `InputError` if an agent that knows objects with these attributes cannot see those of a world."""
    world = world_of(env)
    if world.schema.attributes != schema.attributes:
        raise InputError(
            f"the agent was trained on objects with {schema.names}, but {type(world).__name__} has "
            f"{world.schema.names}: use a world with the same attributes"
        )


def seed_to_dict(seed: np.random.SeedSequence) -> dict[str, Any]:
    """Return what identifies a stream of random numbers, as plain JSON values."""
    entropy = seed.entropy
    words = entropy if isinstance(entropy, int) else [int(word) for word in np.ravel(np.asarray(entropy))]
    return {"entropy": words, "spawn_key": [int(word) for word in seed.spawn_key]}


def environment_options(env: Environment) -> dict[str, Any]:
    """Return the options that an environment was created with, as far as Gymnasium records them."""
    spec = getattr(env, "spec", None)
    options = {} if spec is None else {"id": spec.id, **spec.kwargs}
    plain = (bool, int, float, str, type(None))
    return {str(name): value if isinstance(value, plain) else repr(value) for name, value in options.items()}
