"""Fitted Q iteration on vectors, in iterations."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar, Final, final

import numpy as np

from relforest.rl.configuration import describe_run
from relforest.rl.experience import Experience, concatenate, latest
from relforest.rl.experience_files import EXPERIENCE_FILES, experience_files, read_experience
from relforest.rl.fitted.evidence import Evidence
from relforest.rl.fitted.settings import QSettings
from relforest.rl.fitted.view import View
from relforest.rl.policy import exploring
from relforest.rl.rollout import Environment, rollout, tested, world_of
from relforest.rl.vectors.approximator import Approximator, Model, Rows, VectorMap
from relforest.runs.learner import Row, Snapshot
from relforest.scenes.arrays import FloatArray
from relforest.smdp import Decision, Decisions
from relforest.support.errors import ModelFormatError
from relforest.support.files import read_npz
from relforest.support.progress import part
from relforest.support.rng import generator, stream

KEY: Final = "vectors"
"""What a checkpoint names the file of the model under."""
_TRAINING, _TESTING, _LEARNING = 0, 1, 2


@final
@dataclass(frozen=True, slots=True, eq=False)
class VectorValue:
    """Q(s, a) by a model of vectors."""

    vector_map: VectorMap
    model: Model

    def values(self, decision: Decision) -> FloatArray:
        """Return the value of each action of a decision, (n_actions,)."""
        return self.values_all(Decisions.of([decision]))

    def values_all(self, decisions: Decisions) -> FloatArray:
        """Return the values of the actions of each decision, one after the other."""
        return self.model.values(Rows.of(decisions, self.vector_map))


@final
@dataclass(frozen=True, slots=True, eq=False)
class VectorKnowledge:
    """What is known after an iteration: a value, None before learning, and the training experience."""

    value: VectorValue | None
    batches: tuple[Experience, ...]


@final
@dataclass(frozen=True, slots=True, eq=False)
class VectorLearner:
    """Fitted Q iteration on vectors; exploration and experience are as those of `smrf-q`.

    Its files are ``experience/iteration-0001.npz`` and so on, and ``values/iteration-0001.npz`` of the last
    iteration.

    Parameters
    ----------
    env : gymnasium.Env
        Its ``unwrapped`` implements `relforest.smdp.World`.
    vector_map : VectorMap
        Of this world.
    approximator : Approximator
    seed : SeedSequence
        Of the whole run.
    episodes, test_episodes : int
        Per iteration.
    """

    env: Environment
    vector_map: VectorMap
    approximator: Approximator[Any]
    seed: np.random.SeedSequence
    episodes: int
    test_episodes: int

    files: ClassVar[re.Pattern[str]] = re.compile(rf"{EXPERIENCE_FILES}|values/iteration-\d{{4}}\.npz")

    @property
    def configuration(self) -> dict[str, Any]:
        """Everything that the result depends on, as plain JSON values."""
        episodes = (self.episodes, self.test_episodes)
        return describe_run(self.env, self.approximator.to_dict(), self.seed, episodes)

    def start(self) -> VectorKnowledge:
        """Return that nothing is known."""
        return VectorKnowledge(None, ())

    def iterate(self, state: VectorKnowledge, number: int) -> VectorKnowledge:
        """Gain training experience, and learn from all of it."""
        seed, before, options = stream(self.seed, number), state.value, QSettings()
        with part("training"):
            policy = exploring(before, options.epsilon)
            gained = rollout(self.env, policy, self.episodes, stream(seed, _TRAINING))
        batches = (*state.batches, gained)
        with part("learning"):
            world, known = world_of(self.env), concatenate(latest(batches, options.max_samples))
            # Scenes are not needed, so objects are seen as they are.
            view = View(world.schema, ())
            evidence = Evidence.of([known], view, view.schemas(world.action_types), world.discount)
            rows = Rows.of(_decisions(known), self.vector_map)
            rng = generator(stream(seed, _LEARNING))
            model = self.approximator.improved(before and before.model, evidence, rows, rng)
        return VectorKnowledge(VectorValue(self.vector_map, model), batches)

    def evaluate(self, state: VectorKnowledge, number: int) -> Row:
        """Play test episodes with the policy."""
        seed = stream(self.seed, number, _TESTING)
        policy = exploring(state.value, 0.0)
        return tested(self.env, policy, self.test_episodes, seed, state.batches, (0, 0), n_jobs=1)

    def to_plain(self, state: VectorKnowledge, number: int) -> Snapshot:
        """Return the name of the model's file for the checkpoint, and the model and experience as files."""
        files = experience_files(state.batches)
        if state.value is None:
            return Snapshot({KEY: None}, files)
        name = _file(number)
        return Snapshot({KEY: name}, {**files, name: state.value.model.arrays()})

    def from_plain(self, document: Mapping[str, Any], number: int, folder: Path) -> VectorKnowledge:
        """Read the model and the experience of a checkpoint.

        Raises
        ------
        ModelFormatError
            If a file is missing or malformed, or the files do not match.
        """
        if number == 0:
            return self.start()
        value = read_value(document, number, folder, self.approximator.model, self.vector_map)
        world = world_of(self.env)
        return VectorKnowledge(value, read_experience(folder, number, world.schema, world.action_types))


def read_value(
    document: Mapping[str, Any], number: int, folder: Path, model: type[Model], vector_map: VectorMap
) -> VectorValue:
    """Read the value that a checkpoint names after so many iterations.

    Raises
    ------
    ModelFormatError
        If the file is not the one of this iteration, is missing, or does not hold such a model.
    """
    if document.get(KEY) != _file(number):
        raise ModelFormatError(f"the checkpoint in {folder} does not name the values of iteration {number}")
    path = folder / _file(number)
    arrays = read_npz(path, model.fields)
    return VectorValue(vector_map, model.of(arrays, vector_map.width, origin=str(path)))


def _file(iteration: int) -> str:
    return f"values/iteration-{iteration:04d}.npz"


def _decisions(known: Experience) -> Decisions:
    """Return the states of experience as decisions; what its actions are called in the world is not known."""
    return Decisions(
        known.matrix, known.objects, known.private, known.remaining,
        known.candidates, known.types, known.arguments, known.types,
    )  # fmt: skip
