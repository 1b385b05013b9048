"""The learner ``smrf-q`` in iterations."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, ClassVar, Final, final

import numpy as np

from relforest.rl.configuration import check_attributes, check_world, describe_run
from relforest.rl.experience import Experience, concatenate, latest
from relforest.rl.experience_files import EXPERIENCE_FILES, experience_files, read_experience
from relforest.rl.fitted.additive import improved
from relforest.rl.fitted.evidence import Evidence
from relforest.rl.fitted.horizon import Horizon, learned_backwards
from relforest.rl.fitted.policy_json import (
    FOREST_FILES,
    FORMAT,
    KEY,
    START,
    VERSION,
    describe,
    forest_files,
    learned_value,
    value_of,
)
from relforest.rl.fitted.settings import QSettings, Source
from relforest.rl.fitted.sum import Sum
from relforest.rl.fitted.value import QValue
from relforest.rl.fitted.view import View
from relforest.rl.fitted.voting import with_trees
from relforest.rl.policy_json import POLICY
from relforest.rl.practice import ANYHOW, Practice
from relforest.rl.rollout import Environment, rollout, tested, world_of
from relforest.runs.learner import Row, Snapshot
from relforest.runs.store import read_checkpoint
from relforest.smdp import NO_LIMIT
from relforest.support.errors import InputError
from relforest.support.progress import part
from relforest.support.rng import generator, stream

_TRAINING, _TESTING, _LEARNING = 0, 1, 2
_PER_EPISODES: Final = 100


@final
@dataclass(frozen=True, slots=True, eq=False)
class QKnowledge:
    """What ``smrf-q`` knows after an iteration.

    Parameters
    ----------
    value : QValue or None
        None before learning.
    batches : tuple of Experience
        Training experience, one batch per iteration.
    start : QValue or None
        What was known before there was any experience.
    """

    value: QValue | None
    batches: tuple[Experience, ...]
    start: QValue | None = None


@final
@dataclass(frozen=True, slots=True, eq=False)
class QLearner:
    """Fitted Q iteration on relational features; its states are `QKnowledge`.

    Its files are ``experience/iteration-0001.npz`` and so on, and ``forests/iteration-0001.npz`` of the last
    iteration.

    Parameters
    ----------
    env : gymnasium.Env
        Its ``unwrapped`` implements `relforest.smdp.World`.
    settings : QSettings
    seed : SeedSequence
        Of the whole run.
    episodes, test_episodes : int
        Per iteration.
    n_jobs : int
        Threads that measure scenes. The result does not depend on it.
    source : Source, optional
        What to begin with.
    practice : Practice
        How the world is practised and tested.
    """

    env: Environment
    settings: QSettings
    seed: np.random.SeedSequence
    episodes: int
    test_episodes: int
    n_jobs: int = 1
    source: Source | None = None
    practice: Practice = ANYHOW

    files: ClassVar[re.Pattern[str]] = re.compile(rf"{EXPERIENCE_FILES}|{FOREST_FILES}")

    @property
    def configuration(self) -> dict[str, Any]:
        """Everything that the result depends on, as plain JSON values."""
        episodes = (self.episodes, self.test_episodes)
        described = describe_run(self.env, self.settings.to_dict(), self.seed, episodes)
        described |= self.practice.to_dict(self.env)
        return described if self.source is None else described | self.source.to_dict()

    def start(self) -> QKnowledge:
        """Return that nothing is known, or what the source knows."""
        value = None if self.source is None else known_from(self.source, self.env)
        return QKnowledge(value, (), value)

    def iterate(self, state: QKnowledge, number: int) -> QKnowledge:
        """Gain training experience, and learn from it as soon as there is a share more."""
        seed, batches, value = stream(self.seed, number), state.batches, state.value
        n_before = sum(batch.n_episodes for batch in batches)
        gained: tuple[Experience, ...] = ()
        for place, size in enumerate(portions(n_before, self.episodes, self.settings)):
            with part("training"):
                env, portion = self.practice.training or self.env, stream(seed, _TRAINING, place)
                policy = self.practice.trainee(env, value, self.settings.epsilon)
                gained = (*gained, rollout(env, policy, size, portion))
            with part("learning"):
                rng = generator(stream(seed, _LEARNING, place))
                value = self._learned(state.start, value, (*batches, *gained), rng, size)
        return QKnowledge(value, (*batches, concatenate(gained)), state.start)

    def _learned(
        self,
        start: QValue | None,
        before: QValue | None,
        batches: tuple[Experience, ...],
        rng: np.random.Generator,
        n_new: int,
    ) -> QValue:
        world, settings = world_of(self.env), self.settings
        view = before.view if before else View.of(world.schema, batches[0].matrix, settings.max_values)
        schemas = view.schemas(world.action_types)
        recent = latest(batches, settings.max_samples)
        evidence = Evidence.of(recent, view, schemas, world.discount, self.n_jobs)
        known, first = (None if each is None else each.learned for each in (before, start))
        if (evidence.remaining != NO_LIMIT).any():
            offered = known if isinstance(known, Horizon) else None
            grown = learned_backwards(schemas, evidence, settings.forests, rng, offered)
            return QValue(view, world.action_types, grown)
        if not isinstance(known, Sum):
            known = Sum.zero(schemas, evidence.base_type())
        rounds = max(1, round(settings.curves.rounds * n_new / _PER_EPISODES))
        curves = replace(settings.curves, rounds=rounds)
        first = first if isinstance(first, Sum) and any(first.constants) else None
        is_first = not any(known.constants)
        explained = improved(known, evidence, curves, rng, start=first, is_first=is_first)
        learned = with_trees(explained, evidence, settings, rng, start=first)
        return QValue(view, world.action_types, learned)

    def evaluate(self, state: QKnowledge, number: int) -> Row:
        """Play test episodes with the policy."""
        seed, size = (
            stream(self.seed, number, _TESTING),
            (0, 0) if state.value is None else state.value.learned.size,
        )
        policy = self.practice.tested(self.env, state.value)
        return tested(self.env, policy, self.test_episodes, seed, state.batches, size, self.n_jobs)

    def to_plain(self, state: QKnowledge, number: int) -> Snapshot:
        """Return the policy for the checkpoint, its forests and the experience as files."""
        document = None if state.value is None else describe(state.value)
        start = {} if state.start is None else {START: describe(state.start)}
        header = {"format": FORMAT, "version": VERSION, "iteration": number}
        return Snapshot(
            {KEY: document, **start},
            {
                **experience_files(state.batches),
                **forest_files(state.start, 0),
                **forest_files(state.value, number),
            },
            {} if document is None else {POLICY: header | document},
        )

    def from_plain(self, document: Mapping[str, Any], number: int, folder: Path) -> QKnowledge:
        """Read the policy and the experience of a checkpoint.

        Raises
        ------
        ModelFormatError
            If a file is missing or malformed, or the files do not match.
        InputError
            If they are of another world.
        """
        start = value_of(document[START], folder, 0) if START in document else None
        if number == 0:
            return QKnowledge(start, (), start)
        value = value_of(document.get(KEY), folder, number)
        check_world(value.schema, value.action_types, self.env)
        return QKnowledge(value, read_experience(folder, number, value.schema, value.action_types), start)


def known_from(source: Source, env: Environment) -> QValue:
    """Return what another run knows, as far as it is wanted.

    Raises
    ------
    InputError
        If it is no run of ``smrf-q``, has not learned anything yet, or is of another world.
    ModelFormatError
        If a file is missing or malformed.
    """
    value, world = learned_value(read_checkpoint(source.folder), source.folder), world_of(env)
    if source.what == "policy":
        check_world(value.schema, value.action_types, env)
        return value
    check_attributes(value.schema, env)
    known = {action_type: place for place, action_type in enumerate(value.action_types)}
    places = [known.get(action_type) for action_type in world.action_types]
    if all(place is None for place in places):
        raise InputError(
            f"{source.folder} knows no action type of {type(world).__name__}: give a run of a similar task"
        )
    schemas = value.view.schemas(world.action_types)
    return QValue(value.view, world.action_types, value.learned.offered(places, schemas))


def portions(n_before: int, episodes: int, settings: QSettings) -> Iterator[int]:
    """Yield how many of the episodes of an iteration are played before each time of learning.

    Parameters
    ----------
    n_before : int
        Training episodes of earlier iterations.
    episodes : int
        Those of this iteration.
    settings : QSettings
    """
    while episodes:
        size = max(settings.portion, int(n_before * settings.growth))
        # What would be left over is not worth learning for.
        size = episodes if 2 * episodes < 3 * size else size
        yield size
        n_before, episodes = n_before + size, episodes - size
