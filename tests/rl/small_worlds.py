"""A relational world, trees and experience small enough to work out by hand."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import gymnasium
import numpy as np
from gymnasium import spaces

from relforest.mappings import Mapping
from relforest.rl.experience import Experience
from relforest.scenes import Attribute, Schema
from relforest.scenes.arrays import IntArray
from relforest.smdp import UNBOUND, ActionType, Decision
from relforest.trees import Instantiation, Leaf, Question, Tree
from relforest.volumes import Ellipsoid

LOCATION = Attribute("location")
SCHEMA = Schema((LOCATION,))
WAIT, PICK = 0, 1
ACTION_TYPES = (ActionType("wait"), ActionType("pick", ("thing",)))
PICK_SCHEMA = Schema((LOCATION,), ("thing",))


class Picking(gymnasium.Env[dict[str, Any], np.int64]):
    """Pick up things one after the other; only those left of 0.5 are worth anything.

    Waiting takes 1 unit of time, picking 2, and the reward comes at the end of the first unit. The episode is
    terminal when nothing is left and truncated after 4 actions.
    """

    schema = SCHEMA
    action_types = ACTION_TYPES
    discount = 0.5
    observation_space = spaces.Dict({"left": spaces.Discrete(5)})

    def __init__(self, things: int = 3) -> None:
        self.n_things = things
        self.action_space = spaces.Discrete(1 + things)
        self.things = np.empty(0)
        self.steps = 0

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, Any], dict[str, Any]]:
        super().reset(seed=seed, options=options)
        self.things, self.steps = self.np_random.random(self.n_things), 0
        return {"left": len(self.things)}, {}

    def step(self, action: np.int64 | int) -> tuple[dict[str, Any], float, bool, bool, dict[str, Any]]:
        self.steps += 1
        reward, duration = 0.0, 1.0
        if action > 0:
            reward, duration = float(self.things[action - 1] < 0.5), 2.0
            self.things = np.delete(self.things, action - 1)
        info = {"duration": duration, "discounted_reward": reward * self.discount}
        return {"left": len(self.things)}, reward, len(self.things) == 0, self.steps >= 4, info

    def decision(self) -> Decision:
        n = len(self.things)
        numbers = np.arange(1 + n)
        return Decision(self.things[:, None].copy(), np.minimum(numbers, 1), numbers[:, None] - 1, numbers)


class Limited(Picking):
    """Picking that says how many of its four actions are left."""

    def decision(self) -> Decision:
        return replace(super().decision(), remaining=4 - self.steps if len(self.things) else 0)


REACHING_TYPES = (ActionType("wait"), ActionType("reach", ("thing", "place")))
REACH_SCHEMA = Schema((LOCATION,), ("thing", "place"))
PLACES = 2


class Reaching(gymnasium.Env[dict[str, Any], np.int64]):
    """Carry things to places that nothing but the action itself knows; close to another thing is worth 1.

    There are two places for each thing, drawn anew in every state: private objects. Three actions make an
    episode.
    """

    schema = SCHEMA
    action_types = REACHING_TYPES
    discount = 0.5
    observation_space = spaces.Dict({"left": spaces.Discrete(5)})

    def __init__(self, things: int = 3) -> None:
        self.n_things = things
        self.action_space = spaces.Discrete(1 + PLACES * things)
        self.things, self.places, self.steps = np.empty(0), np.empty(0), 0

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, Any], dict[str, Any]]:
        super().reset(seed=seed, options=options)
        self.things, self.steps = self.np_random.random(self.n_things), 0
        self.places = self.np_random.random(PLACES * self.n_things)
        return {"left": 0}, {}

    def step(self, action: np.int64 | int) -> tuple[dict[str, Any], float, bool, bool, dict[str, Any]]:
        self.steps += 1
        reward = 0.0
        if action > 0:
            thing, place = (action - 1) // PLACES, self.places[action - 1]
            reward = float((np.abs(np.delete(self.things, thing) - place) < 0.1).any())
            self.things[thing] = place
        self.places = self.np_random.random(len(self.places))
        return {"left": 0}, reward, False, self.steps >= 3, {"duration": 1.0}

    def decision(self) -> Decision:
        n, numbers = len(self.things), np.arange(len(self.places))
        bound = np.stack([numbers // PLACES, n + numbers], axis=1)
        return Decision(
            np.concatenate([self.things, self.places])[:, None],
            np.concatenate([[WAIT], np.ones_like(numbers)]),
            np.concatenate([[[UNBOUND, UNBOUND]], bound]),
            np.arange(1 + len(numbers)),
            n_private=len(self.places),
        )


class Proposing(Reaching):
    """Reaching that proposes places 0.05 to the right of those it is asked about, at most `EXTRA`."""

    EXTRA = 5

    def __init__(self, things: int = 3) -> None:
        super().__init__(things)
        self.action_space = spaces.Discrete(1 + PLACES * things + self.EXTRA)
        self.owners: list[int] = []
        self.asked: list[list[int]] = []

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, Any], dict[str, Any]]:
        self.owners = []
        return super().reset(seed=seed, options=options)

    def step(self, action: np.int64 | int) -> tuple[dict[str, Any], float, bool, bool, dict[str, Any]]:
        n = PLACES * self.n_things
        if action > n:
            thing = self.owners[action - 1 - n]
            # The place takes the slot of one that the world offers itself.
            self.places[PLACES * thing], action = self.places[action - 1], 1 + PLACES * thing
        self.owners, self.places = [], self.places[:n]
        return super().step(action)

    def refine(self, positions: IntArray) -> Decision:
        self.asked.append(positions.tolist())
        now = self.decision()
        for position in positions:
            thing, place = now.arguments[position]
            x = now.objects[place, 0] + 0.05
            if now.types[position] and len(self.owners) < self.EXTRA and x not in self.places:
                self.owners.append(int(thing))
                self.places = np.append(self.places, x)
        return self.decision()

    def decision(self) -> Decision:
        found, n = super().decision(), PLACES * self.n_things
        arguments = found.arguments.copy()
        arguments[1 + n :, 0] = self.owners
        return replace(found, arguments=arguments)


def within(mean: float, radius: float, *, keys: int = 1) -> Ellipsoid:
    """All numbers within `radius` of `mean`; the density there is exp(-keys * (x - mean)**2 / 2)."""
    return Ellipsoid(np.array([mean]), np.eye(1), radius, keys, 0.0)


def near(schema: Schema, mean: float = 0.25, radius: float = 0.25) -> Tree:
    """Ask whether the first object (the argument, if there is one) is near `mean`: three leaves."""
    question = Question(Mapping("identity", LOCATION), (0,), within(mean, radius), 2, 3, 4)
    return Tree(schema, (Instantiation(1), question, Leaf(0.9, 1, 9), Leaf(0.2, 8, 2), Leaf(0.5, 0, 0)))


def beside() -> Tree:
    """Ask whether another thing is within 0.1 of the argument, and if so whether that one is near 0.5."""
    first = Question(Mapping("difference", LOCATION), (0, 1), within(0.0, 0.1, keys=50), 3, 7, 8)
    second = Question(Mapping("identity", LOCATION), (1,), within(0.5, 0.2, keys=3), 4, 5, 6)
    leaves = [Leaf(probability, 1, 1) for probability in (0.95, 0.7, 0.6, 0.1, 0.3)]
    return Tree(PICK_SCHEMA, (Instantiation(1), Instantiation(2), first, second, *leaves))


def two_episodes() -> Experience:
    """Two episodes in `Picking`, written out.

    Episode 0: state 0 has things at 0.2 and 0.8; pick the first (candidate 1), get to state 1 with the thing
    at 0.8; pick it (candidate 4), get to state 2, which is terminal and empty but for waiting. Episode 1:
    state 3 has a thing at 0.4; wait (candidate 6), get to the same in state 4, where time is up.
    """
    return Experience(
        matrix=np.array([[0.2], [0.8], [0.8], [0.4], [0.4]]),
        objects=np.array([0, 2, 3, 3, 4, 5]),
        private=np.zeros(5, dtype=np.int64),
        remaining=np.full(5, -1),
        candidates=np.array([0, 3, 5, 6, 8, 10]),
        types=np.array([0, 1, 1, 0, 1, 0, 0, 1, 0, 1]),
        arguments=np.array([[-1], [0], [1], [-1], [0], [-1], [-1], [0], [-1], [0]]),
        states=np.array([0, 1, 3]),
        next_states=np.array([1, 2, 4]),
        actions=np.array([1, 4, 6]),
        rewards=np.array([0.5, 0.0, 0.0]),
        durations=np.array([2.0, 2.0, 1.0]),
        terminal=np.array([False, True, False]),
        truncated=np.array([False, False, True]),
        episode_rewards=np.array([1.0, 0.0]),
        episode_durations=np.array([4.0, 1.0]),
    )
