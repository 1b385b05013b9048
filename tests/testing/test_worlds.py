from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium import spaces
from gymnasium.envs.toy_text import FrozenLakeEnv
from gymnasium.wrappers import TransformAction, TransformObservation
from numpy.typing import NDArray

from interpreted import compiled_only
from relforest.scenes import Attribute, Scenes, Schema
from relforest.scenes.batch import scenes_of
from relforest.smdp import ActionType, Decision
from relforest.support.errors import InputError
from relforest.testing import check_world
from relforest.worlds.corridor.env import CorridorEnv
from relforest.worlds.keepaway import env as keepaway
from relforest.worlds.keepaway.env import KeepawayEnv
from relforest.worlds.keepaway.play.lockstep import LockstepGames

SCHEMA = Schema((Attribute("location", 2), Attribute("weight", 1)))
SLOTS = 4


class Picking(gymnasium.Env[dict[str, Any], np.int64]):
    """Pick the things up, one after the other: a small world with all that the corridor lacks.

    Two to four things, one of unknown weight; actions with an argument, of which only some are available;
    options of several units of time; terminal states without actions; a discount of 1.
    """

    schema = SCHEMA
    action_types = (ActionType("wait"), ActionType("pick", ("thing",)))
    discount = 1.0

    def __init__(self) -> None:
        self.observation_space = spaces.Dict(
            {
                "location": spaces.Box(0.0, 1.0, (SLOTS, 2)),
                "weight": spaces.Box(0.0, 9.0, (SLOTS, 1)),
                "mask": spaces.MultiBinary(SLOTS),
            }
        )
        self.action_space = spaces.Discrete(1 + SLOTS)
        self.things = np.empty((0, 3))

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, Any], dict[str, Any]]:
        super().reset(seed=seed, options=options)
        # Single precision, so that the observation holds the exact values.
        things = self.np_random.random((self.np_random.integers(2, SLOTS, endpoint=True), 3), np.float32)
        self.things = things.astype(np.float64)
        self.things[0, 2] = np.nan
        return self.observe()

    def step(self, action: np.int64) -> tuple[dict[str, Any], float, bool, bool, dict[str, Any]]:
        before = len(self.things)
        if 0 < action <= before:
            self.things = np.delete(self.things, action - 1, axis=0)
        observation, info = self.observe()
        reward = float(before - len(self.things))
        return observation, reward, len(self.things) == 0, False, info | {"duration": 0.5 + 2.0 * reward}

    def decision(self) -> Decision:
        n = len(self.things)
        if n == 0:
            return Decision(
                self.things, np.empty(0, np.int64), np.empty((0, 1), np.int64), np.empty(0, np.int64)
            )
        numbers = np.arange(1 + n)
        return Decision(self.things, np.minimum(numbers, 1), numbers[:, None] - 1, numbers)

    def observe(self) -> tuple[dict[str, Any], dict[str, Any]]:
        n = len(self.things)
        padded = np.zeros((SLOTS, 3), dtype=np.float32)
        padded[:n] = np.nan_to_num(self.things)
        observation = {
            "location": padded[:, :2].copy(),
            "weight": padded[:, 2:].copy(),
            "mask": (np.arange(SLOTS) < n).astype(np.int8),
        }
        mask = np.zeros(1 + SLOTS, dtype=np.int8)
        mask[self.decision().indices] = 1
        scene = Scenes(SCHEMA, self.things.copy(), np.arange(n), np.array([0]), np.array([n]))
        return observation, {"scene": scene, "action_mask": mask}


Patch = Callable[[Any], Any]


def corridor(**patches: Patch) -> Callable[[], gymnasium.Env[Any, Any]]:
    """Make corridors of which some members are replaced by functions of the original member."""

    def make() -> CorridorEnv:
        env = CorridorEnv()
        for name, patch in patches.items():
            setattr(env, name, patch(getattr(env, name)))
        return env

    return make


def after(function: Callable[..., Any]) -> dict[str, Patch]:
    """Patch what reset and step return: `function` changes (observation, info) in place."""

    def patch(original: Callable[..., Any]) -> Callable[..., Any]:
        @functools.wraps(original)
        def changed(*args: Any, **options: Any) -> Any:
            result = original(*args, **options)
            function(result[0], result[-1])
            return result

        return changed

    return {"reset": patch, "step": patch}


def stepping(**changes: Any) -> dict[str, Patch]:
    """Patch what step returns: the reward, or entries of info."""

    def patch(original: Callable[..., Any]) -> Callable[..., Any]:
        def changed(action: int) -> Any:
            observation, reward, terminated, truncated, info = original(action)
            info.update({name: value for name, value in changes.items() if name != "reward"})
            return observation, changes.get("reward", reward), terminated, truncated, info

        return changed

    return {"step": patch}


def masking(function: Patch) -> dict[str, Patch]:
    """Patch what action_masks returns."""
    return {"action_masks": lambda original: lambda: function(original())}


def deciding(**changes: Any) -> dict[str, Patch]:
    """Patch fields of the decision."""
    return {"decision": lambda original: lambda: replace(original(), **changes)}


def test_the_corridor_passes_wrapped_and_unwrapped() -> None:
    check_world(CorridorEnv)
    check_world(lambda: gymnasium.make("relforest/Corridor-v0"), seed=3, steps=25)


def test_a_step_may_take_no_time() -> None:
    check_world(corridor(**stepping(duration=0.0)), steps=5)


def test_a_world_with_arguments_padding_options_and_terminal_states_passes() -> None:
    check_world(Picking)


@pytest.mark.parametrize("make_env", [None, "relforest/Corridor-v0", CorridorEnv()])
def test_what_makes_no_environment_is_an_input_error(make_env: Any) -> None:
    with pytest.raises(InputError, match="make_env must be a function"):
        check_world(make_env)


def test_an_object_that_is_no_environment_is_an_input_error() -> None:
    with pytest.raises(InputError, match=r"make_env must return a gymnasium.Env, but returned 3"):
        check_world(lambda: 3)  # type: ignore[arg-type, return-value]  # the mistake under test


@pytest.mark.parametrize("options", [{"steps": 0}, {"steps": 10**9}, {"seed": -1}, {"seed": True}])
def test_options_are_checked(options: dict[str, int]) -> None:
    with pytest.raises(InputError, match=r"must be an integer (from 1 to 100000|of at least 0), got"):
        check_world(CorridorEnv, **options)


def zeros(*shape: int) -> NDArray[np.int64]:
    return np.zeros(shape, dtype=np.int64)


NO_ACTIONS = {"types": zeros(0), "arguments": zeros(0, 0), "indices": zeros(0)}


def other_scene(scene: Scenes, **changes: Any) -> Scenes:
    return scenes_of(scene.parts._replace(**changes))


LOCATION = spaces.Box(0.0, 1.0, (1, 1), np.float64)
MASK = spaces.MultiBinary(1)


@pytest.mark.parametrize(
    ("space", "function", "message"),
    [
        (LOCATION, lambda seen: seen["location"], "the observation space must be a Dict"),
        (
            spaces.Dict({"location": LOCATION}),
            lambda seen: {"location": seen["location"]},
            r"observations must contain \['location', 'mask'\], got \['location'\]",
        ),
        (
            spaces.Dict({"location": LOCATION, "mask": spaces.MultiBinary((1, 1))}),
            lambda seen: seen | {"mask": seen["mask"][None]},
            r"the mask must have the shape \(slots,\), got \(1, 1\)",
        ),
        (
            spaces.Dict({"location": spaces.Box(0.0, 1.0, (1,), np.float64), "mask": MASK}),
            lambda seen: seen | {"location": seen["location"][0]},
            r"'location' must have the shape \(1, 1\), got \(1,\)",
        ),
    ],
)
def test_observations_have_the_agreed_form(space: Any, function: Any, message: str) -> None:
    with pytest.raises(AssertionError, match=f"^spaces: {message}"):
        check_world(lambda: TransformObservation(CorridorEnv(), function, space))


def test_actions_are_counted_from_zero() -> None:
    def make() -> gymnasium.Env[Any, Any]:
        return TransformAction(CorridorEnv(), lambda action: action - 1, spaces.Discrete(2, start=1))

    with pytest.raises(AssertionError, match=r"^spaces: the action space must be Discrete and start at 0"):
        check_world(make)


def test_observations_lie_in_their_space() -> None:
    def far(seen: dict[str, Any]) -> dict[str, Any]:
        return seen | {"location": seen["location"] + 2.0}

    with pytest.raises(AssertionError, match=r"^observation: .* is not in the observation space"):
        check_world(lambda: TransformObservation(CorridorEnv(), far, CorridorEnv().observation_space))


def test_empty_slots_hold_zeros() -> None:
    def dirty(seen: dict[str, Any]) -> dict[str, Any]:
        return seen | {"weight": np.where(seen["mask"][:, None] == 1, seen["weight"], np.float32(5.0))}

    with pytest.raises(AssertionError, match=r"^observation: 'weight' must be 0 in slots without an object"):
        check_world(lambda: TransformObservation(Picking(), dirty, Picking().observation_space))


def test_the_environment_is_a_world() -> None:
    with pytest.raises(AssertionError, match=r"^world: env.unwrapped must have schema, action_types"):
        check_world(FrozenLakeEnv)


def test_discounting_changes_nothing_where_the_discount_is_one() -> None:
    def make() -> gymnasium.Env[Any, Any]:
        return corridor(discount=lambda _: 1.0, **stepping(reward=1.0, discounted_reward=0.9))()

    with pytest.raises(AssertionError, match=r"^step: .* is 0.9 and the reward 1.0, but the discount is 1"):
        check_world(make)


@pytest.mark.parametrize(
    ("outcome", "message"),
    [
        (("much", False, False), "the reward must be a finite number, got 'much'"),
        ((float("nan"), False, False), "the reward must be a finite number, got nan"),
        ((0.0, 0, False), "terminated must be a bool, got 0"),
        ((0.0, False, None), "truncated must be a bool, got None"),
    ],
)
def test_steps_return_what_gymnasium_wants_beyond_the_first(outcome: Any, message: str) -> None:
    # Gymnasium's own check looks at the first steps only.
    calls: list[int] = []

    def patch(original: Callable[..., Any]) -> Callable[..., Any]:
        def changed(action: int) -> Any:
            calls.append(action)
            observation, *usual, info = original(action)
            return observation, *(outcome if len(calls) > 100 else usual), info

        return changed

    env = corridor(step=patch)()
    with pytest.raises(AssertionError, match=f"^step: {message}"):
        check_world(lambda: env, steps=200)


def test_trajectories_depend_on_the_seed_only() -> None:
    made: list[gymnasium.Env[Any, Any]] = []

    def make() -> gymnasium.Env[Any, Any]:
        made.append(CorridorEnv(noise=0.05 if len(made) % 2 else 0.06))
        return made[-1]

    with pytest.raises(AssertionError, match=r"^determinism: two runs with seed 4 differ at moment"):
        check_world(make, seed=4)


@pytest.mark.parametrize(
    ("patches", "message"),
    [
        (after(lambda observation, _: observation["location"].__iadd__(2.0)), "gymnasium: check_env fails"),
        ({"discount": lambda _: 0.0}, "world: discount must be above 0"),
        ({"discount": lambda _: 1.5}, "world: discount must be above 0 and at most 1, got 1.5"),
        ({"discount": lambda _: "0.9"}, "world: discount"),
        ({"schema": lambda _: None}, "world: schema must be a Schema"),
        ({"schema": lambda schema: Schema(schema.attributes, ("A",))}, "world: schema .* without parameters"),
        ({"action_types": list}, "world: action_types must be a tuple of ActionType"),
        ({"action_types": lambda _: ()}, "world: action_types"),
        (
            {"action_types": lambda _: (ActionType("left"),) * 2},
            "world: action types must have different",
        ),
        (deciding(objects=np.zeros((1, 2))), "decision: objects has 2 columns"),
        (deciding(types=np.array([0, 2])), "decision: action 1 has type 2"),
        (deciding(**NO_ACTIONS), "decision: a state that is not terminal must offer an action"),
        ({"decision": lambda original: lambda: shuffled(original())}, "decision: two calls of decision"),
        (deciding(n_private=1), "scene: its objects must be the shared objects of decision\\(\\)"),
        (deciding(indices=np.array([0, 2])), "action_mask: must be 1 only at the indices"),
        (after(lambda _, info: info.pop("action_mask")), "action_mask: .* must be an int8 array"),
        (after(lambda _, info: info.update(action_mask=np.ones(2))), "action_mask: .* must be an int8 array"),
        (
            after(lambda _, info: info.update(action_mask=np.ones(3, np.int8))),
            r"action_mask: .* shape \(2,\)",
        ),
        (after(lambda _, info: info["action_mask"].__imul__(2)), "action_mask: must be 1 only"),
        (after(lambda _, info: info["action_mask"].put(0, 0)), "action_mask: must be 1 only"),
        (masking(lambda masks: masks.astype(np.int8)), r"action_mask: action_masks\(\) must be array.* got"),
        (masking(lambda masks: ~masks), r"action_mask: action_masks\(\) must be"),
        (masking(lambda masks: masks[:1]), r"action_mask: action_masks\(\) must be"),
        (after(lambda _, info: info.pop("scene")), "scene: .* must be Scenes of length 1, got None"),
        (after(lambda _, info: info.update(scene=info["scene"].take([0, 0]))), "scene: .* length 1"),
        (
            after(
                lambda _, info: info.update(scene=other_scene(info["scene"], schema=Schema([Attribute("x")])))
            ),
            "scene: its schema must be the schema of the world",
        ),
        (
            after(lambda _, info: info.update(scene=other_scene(info["scene"], matrix=np.array([[7.0]])))),
            "scene: its objects must be the shared objects",
        ),
        (after(lambda observation, _: observation["mask"].fill(0)), "observation: the mask marks 0 objects"),
        (
            after(lambda observation, _: observation["location"].fill(0.123)),
            "observation: 'location' must hold the objects",
        ),
        (
            stepping(duration=-0.5),
            r'step: info\["duration"\] must be a finite number of at least 0, got -0.5',
        ),
        (stepping(duration=None), r'step: info\["duration"\]'),
        (stepping(duration=np.inf), r'step: info\["duration"\]'),
        (stepping(discounted_reward=np.inf), r'step: info\["discounted_reward"\] must be a finite number'),
        (
            after(lambda _, info: info.update(duration_before=-1.0)),
            r'before: info\["duration_before"\] after a reset must be a finite number, got -1.0',
        ),
        (after(lambda _, info: info.update(reward_before=np.inf)), r'before: info\["reward_before"\]'),
        (stepping(discounted_reward="1"), r'step: info\["discounted_reward"\] must be a finite number'),
    ],
)
def test_violations_name_the_clause(patches: dict[str, Patch], message: str) -> None:
    with pytest.raises(AssertionError, match=f"^{message}"):
        check_world(corridor(**patches))


@compiled_only
def test_episodes_that_are_played_together_must_be_as_those_played_alone(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    check_world(KeepawayEnv, steps=5)
    monkeypatch.setattr(
        keepaway,
        "LockstepGames",
        lambda setup, gamma, seeds: LockstepGames(setup, gamma, [s + 1 for s in seeds]),
    )
    with pytest.raises(AssertionError, match=r"^lockstep: .* of episodes that are played together"):
        check_world(KeepawayEnv, steps=5)


def limited(first: int | None, *after: int | None) -> Callable[[], gymnasium.Env[Any, Any]]:
    """Make corridors of two steps that say how many actions remain at first and after each step."""

    def make() -> CorridorEnv:
        env = CorridorEnv(max_steps=2)
        original = env.decision
        env.decision = lambda: replace(original(), remaining=(first, *after)[env.state.steps])  # type: ignore[method-assign]
        return env

    return make


@pytest.mark.parametrize("remaining", [(None, None, None), (2, 1, 0), (3, 2, 1)])
def test_remaining_actions_may_be_counted_down(remaining: tuple[int | None, ...]) -> None:
    check_world(limited(*remaining), steps=5)


@pytest.mark.parametrize(
    ("remaining", "message"),
    [
        ((2, 2, 1), "must be 1 after an action in a state with 2, got 2"),
        ((2, None, None), "must be 1 after an action in a state with 2, got None"),
        ((None, 1, 0), "must be None after an action in a state with None, got 1"),
        ((1, 0, 0), "no action remains, but the episode has not ended"),
        ((0, 0, 0), "no action remains"),
    ],
)
def test_remaining_actions_fall_by_one(remaining: tuple[int | None, ...], message: str) -> None:
    with pytest.raises(AssertionError, match=f"^remaining: {message}"):
        check_world(limited(*remaining))


class Ending(Picking):
    """Counts at most nine actions, but the last thing ends the episode before."""

    left_over = 0

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, Any], dict[str, Any]]:
        self.taken = 0
        return super().reset(seed=seed, options=options)

    def step(self, action: np.int64) -> tuple[dict[str, Any], float, bool, bool, dict[str, Any]]:
        self.taken += 1
        observation, reward, terminated, _, info = super().step(action)
        return observation, reward, terminated, self.taken == 9, info

    def decision(self) -> Decision:
        remaining = 9 - self.taken if len(self.things) else self.left_over
        return replace(super().decision(), remaining=remaining)


def test_nothing_remains_in_a_terminal_state() -> None:
    check_world(Ending)

    class Wrong(Ending):
        left_over = 1

    with pytest.raises(AssertionError, match=r"^decision: remaining must be 0 in a state without actions"):
        check_world(Wrong)


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        (lambda action: type(action) is int, "step\\(\\) must accept the action 0: odd"),
        (
            lambda action: isinstance(action, np.ndarray),
            r"step\(\) must accept the action array\(0\): odd",
        ),
    ],
)
def test_integers_of_any_kind_are_actions(wrong: Patch, message: str) -> None:
    class Picky(Picking):
        checks = 0

        def step(self, action: np.int64) -> tuple[dict[str, Any], float, bool, bool, dict[str, Any]]:
            if wrong(action):
                raise TypeError("odd")
            return super().step(action)

    with pytest.raises(AssertionError, match=f"^action: {message}"):
        check_world(Picky)


def test_integers_of_any_kind_are_the_same_action() -> None:
    def careless(action: Any) -> Any:
        return 1 - action if isinstance(action, np.ndarray) else action

    def make() -> gymnasium.Env[Any, Any]:
        return TransformAction(CorridorEnv(), careless, spaces.Discrete(2))

    with pytest.raises(AssertionError, match=r"^action: array\(0\) must have the same effect as"):
        check_world(make)


OWN_SOURCE = np.random.default_rng(0)


def shuffled(decision: Decision) -> Decision:
    """Return the actions in another order, drawn from a source that no seed controls."""
    order = OWN_SOURCE.permutation(len(decision))
    return Decision(
        decision.objects, decision.types[order], decision.arguments[order], decision.indices[order]
    )
