"""SMRF-RPI as a learner in iterations: the experience loop of Palmer (2015), Algorithm 6.1.

`relforest.rl.rounds` is the loop inside an iteration.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar, final

import numpy as np

from relforest.rl.configuration import check_world, describe_run
from relforest.rl.experience import Experience
from relforest.rl.experience_files import EXPERIENCE_FILES, experience_files, read_experience
from relforest.rl.policy_json import (
    TREE_FILES,
    TreeNames,
    derived_files,
    plain_policy,
    policy_of,
    slugs,
    tree_name,
)
from relforest.rl.practice import ANYHOW, Practice
from relforest.rl.rollout import Environment, rollout, tested, world_of
from relforest.rl.rounds import improve
from relforest.rl.samples import draw_samples
from relforest.rl.settings import RPISettings
from relforest.rl.value import ValueFunction, action_schemas
from relforest.runs.learner import Row, Snapshot
from relforest.support.progress import part, report
from relforest.support.rng import stream

_TRAINING, _TESTING, _SAMPLING, _LEARNING = 0, 1, 2, 3


@final
@dataclass(frozen=True, slots=True, eq=False)
class Knowledge:
    """What SMRF-RPI knows after an iteration."""

    value: ValueFunction
    tree_names: TreeNames  # the file names of the trees of `value`
    batches: tuple[Experience, ...]  # training experience, one batch per iteration


@final
@dataclass(frozen=True, slots=True, eq=False)
class RPILearner:
    """The source's learner; its states are `Knowledge`.

    Its files are ``experience/iteration-0001.npz`` and so on, and ``trees/0001-left-1.json`` and so on, the
    accepted trees.
    """

    env: Environment  # its ``unwrapped`` implements `relforest.smdp.World`
    settings: RPISettings
    seed: np.random.SeedSequence  # of the whole run
    episodes: int
    test_episodes: int
    """Per iteration, see `relforest.rl.rpi.SMRFRPI.learn`."""
    n_jobs: int = 1
    """Candidate trees learned at the same time, in threads. The result does not depend on it."""
    practice: Practice = ANYHOW  # how the world is practised and tested

    files: ClassVar[re.Pattern[str]] = re.compile(rf"{TREE_FILES}|{EXPERIENCE_FILES}")

    @property
    def configuration(self) -> dict[str, Any]:
        """Everything that the result depends on, as plain JSON values."""
        episodes = (self.episodes, self.test_episodes)
        run = describe_run(self.env, self.settings.to_dict(), self.seed, episodes)
        return run | self.practice.to_dict(self.env)

    def start(self) -> Knowledge:
        """Return no trees, and a value of zero."""
        world = world_of(self.env)
        value = ValueFunction.zero(world.schema, world.action_types, self.settings.features)
        return Knowledge(value, ((),) * len(world.action_types), ())

    def iterate(self, state: Knowledge, number: int) -> Knowledge:
        """Gain training experience and learn from it."""
        settings, seed, world = self.settings, stream(self.seed, number), world_of(self.env)
        env = self.practice.training or self.env
        policy = self.practice.trainee(env, state.value if number > 1 else None, settings.epsilon)
        with part("training"):
            batches = (*state.batches, rollout(env, policy, self.episodes, stream(seed, _TRAINING)))
        report("collecting samples")
        samples = draw_samples(
            batches,
            action_schemas(world.schema, world.action_types),
            discount=world.discount,
            max_samples=settings.max_samples,
            bootstrap_on_truncation=settings.bootstrap_on_truncation,
            seed=stream(seed, _SAMPLING),
        )
        value = improve(
            state.value, samples, settings=settings, seed=stream(seed, _LEARNING), n_jobs=self.n_jobs
        )
        names = tuple(
            (*old, *(tree_name(number, slug, i + 1) for i in range(len(trees) - len(old))))
            for old, slug, trees in zip(
                state.tree_names, slugs(world.action_types), value.forests, strict=True
            )
        )
        return Knowledge(value, names, batches)

    def evaluate(self, state: Knowledge, number: int) -> Row:
        """Play test episodes with the policy."""
        seed, size = stream(self.seed, number, _TESTING), (state.value.n_trees, state.value.n_leaves)
        policy = self.practice.tested(self.env, state.value if number else None)
        return tested(self.env, policy, self.test_episodes, seed, state.batches, size, self.n_jobs)

    def to_plain(self, state: Knowledge, number: int) -> Snapshot:
        """Return the policy for the checkpoint, its trees and the experience as files."""
        document, trees = plain_policy(state.value, state.tree_names)
        return Snapshot(
            document,
            {**experience_files(state.batches), **trees},
            derived_files(state.value, state.tree_names, number),
        )

    def from_plain(self, document: Mapping[str, Any], number: int, folder: Path) -> Knowledge:
        """Read the trees and the experience that a checkpoint names.

        Raises
        ------
        ModelFormatError
            If a file is missing or malformed, or the files do not match.
        InputError
            If they are of another world.
        """
        value, names = policy_of(document, folder)
        check_world(value.schema, value.action_types, self.env)
        batches = read_experience(folder, number, value.schema, value.action_types)
        return Knowledge(value, names, batches)
