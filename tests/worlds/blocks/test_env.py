from __future__ import annotations

import copy
import pickle
import subprocess
import sys
import warnings
from collections.abc import Callable, Mapping
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.error import ResetNeeded
from gymnasium.utils.env_checker import check_env

from relforest.rl.action_scenes import action_scenes
from relforest.rl.rollout import experience_of
from relforest.scenes import Scenes, Schema
from relforest.smdp import Decisions, Outcomes, check_refined
from relforest.support.errors import InputError
from relforest.testing import check_world
from relforest.worlds.blocks.arm import OptionResult
from relforest.worlds.blocks.blocks import Block
from relforest.worlds.blocks.command import Command
from relforest.worlds.blocks.env import BlocksEnv, arch_env, color_grouping_env, high_towers_env
from relforest.worlds.blocks.handling import Handling, Noise
from relforest.worlds.blocks.policies import make_policy
from relforest.worlds.blocks.scene import SCHEMA
from relforest.worlds.blocks.tasks import ARCH_ACTIONS, DONE, MOVE
from worlds.blocks.staged_blocks import UPRIGHT, Pose

IDENTIFIERS = ("relforest/HighTowers-v0", "relforest/ColorGrouping-v0", "relforest/Arch-v0")
GREY = (0.5, 0.5, 0.5)
EXACT = Handling(Noise.none())


BESIDE_THE_TABLE = ((2.0, 2.0), (150.0, 2.0, 0.0))


def staged(env: BlocksEnv, *placed: tuple[tuple[float, float], Pose], at_rest: bool = True) -> BlocksEnv:
    """Put these blocks in the place of those of a new episode."""
    env.reset(seed=0)
    sim = env.simulation
    blocks = [Block(sim.next_id + i, half, GREY) for i, (half, _) in enumerate(placed)]
    sim.place(blocks, [pose for _, pose in placed])
    if at_rest:
        sim.wait_for_rest()
    env._watcher.begin(sim.state.ids)
    env._look()
    return env


def played(env: BlocksEnv, seed: int, steps: int = 5) -> list[tuple[float, float, bytes]]:
    rng = np.random.default_rng(seed)
    env.reset(seed=seed)
    moments = []
    for _ in range(steps):
        observation, reward, terminated, truncated, info = env.step(rng.choice(env.decision().indices))
        moments.append((reward, info["duration"], observation["location"].tobytes()))
        if terminated or truncated:
            env.reset()
    return moments


@pytest.mark.parametrize("identifier", IDENTIFIERS)
def test_gymnasiums_own_check_passes_without_a_warning(identifier: str) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_env(gymnasium.make(identifier, render_mode="rgb_array").unwrapped)


@pytest.mark.parametrize(
    ("identifier", "options"),
    [
        ("relforest/HighTowers-v0", {}),
        ("relforest/HighTowers-v0", {"n_blocks": 1}),
        ("relforest/ColorGrouping-v0", {}),
        ("relforest/ColorGrouping-v0", {"distance": "rgb", "n_blocks": 7, "max_actions": 2}),
        ("relforest/Arch-v0", {}),
        ("relforest/Arch-v0", {"sampler": "training"}),
        ("relforest/Arch-v0", {"pays": "end", "n_blocks": 4}),
    ],
)
def test_the_tasks_are_worlds(identifier: str, options: Mapping[str, Any]) -> None:
    check_world(lambda: gymnasium.make(identifier, **options), steps=15)


@pytest.mark.parametrize("identifier", IDENTIFIERS)
def test_random_masked_actions_run_without_end(identifier: str) -> None:
    env = gymnasium.make(identifier)
    _, info = env.reset(seed=3)
    env.action_space.seed(3)
    for _ in range(1000):
        mask = env.unwrapped.action_masks()  # type: ignore[attr-defined]
        assert mask.dtype == np.bool_
        np.testing.assert_array_equal(mask, info["action_mask"])
        observation, reward, terminated, truncated, info = env.step(
            env.action_space.sample(info["action_mask"])
        )
        assert env.observation_space.contains(observation)
        assert np.isfinite([reward, info["duration"], info["discounted_reward"]]).all()
        assert info["duration"] >= 0.5
        if terminated or truncated:
            _, info = env.reset()


def test_rewards_are_what_an_action_changed_about_the_score() -> None:
    for env, score in ((high_towers_env(), "mean_height"), (color_grouping_env(), "grouping_score")):
        _, info = env.reset(seed=1)
        first, total, rng = info[score], 0.0, np.random.default_rng(1)
        for number in range(5):
            before = info[score]
            _, reward, terminated, truncated, info = env.step(rng.choice(env.decision().indices))
            assert reward == pytest.approx(info[score] - before)
            assert (terminated, truncated) == (False, number == 4)
            total += reward
        assert total == pytest.approx(info[score] - first)


def test_a_put_without_noise_by_hand() -> None:
    env = staged(high_towers_env(handling=EXACT, n_blocks=2), ((2, 2), (0, 2, 0)), ((1, 1), (15, 1, 0)))
    assert env.moment.score == pytest.approx(1.5, abs=0.05)
    first, second = env.state.ids
    _, reward, _, _, info = env.perform("put", second, first)
    # Heights 2 and 1 become 2 and 5.
    assert info["mean_height"] == pytest.approx(3.5, abs=0.05)
    assert reward == pytest.approx(2.0, abs=0.05)
    # Paid in the last step of 0.01 s: discounted by all the time before it.
    duration = info["duration"]
    assert duration == pytest.approx(info["option"].steps / 100)
    assert info["discounted_reward"] == pytest.approx(reward * 0.99 ** (duration - 0.01))


def test_only_done_is_paid_for_an_arch() -> None:
    env = arch_env(handling=EXACT)
    half = (4.0, 2.0)
    staged(env, (half, (-5, 4, UPRIGHT)), (half, (5, 4, UPRIGHT)), (half, (25, 2, 0)))
    assert env.moment.score == 0.0
    policy, rng = make_policy("careful", env), np.random.default_rng(0)
    position = policy.choose(env.decision(), rng)
    command = env.command(position)
    assert command.name == "move"
    assert command.arguments == pytest.approx((env.state.ids[2], 0.0), abs=0.02)
    assert env.command(0) == Command("rotate", (int(env.state.ids[0]),))
    _, reward, terminated, _, info = env.step(int(env.decision().indices[position]))
    # The top lies on both supports: a gap of 6, 8 high.
    assert (reward, terminated) == (0.0, False)
    assert info["arch_score"] == pytest.approx(48.0, abs=0.5)
    position = policy.choose(env.decision(), rng)
    _, reward, terminated, truncated, info = env.step(int(env.decision().indices[position]))
    assert (reward, terminated, truncated) == (info["arch_score"], True, False)
    assert 0.5 < info["duration"] < 2.0
    assert info["discounted_reward"] == pytest.approx(reward * 0.99 ** (info["duration"] - 0.01))
    assert len(env.decision()) == 0
    assert not env.action_masks().any()
    with pytest.raises(ResetNeeded, match=r"ended after 2 actions: call reset\(\) first"):
        env.step(0)


def test_an_arch_of_the_last_action_is_told_but_not_paid() -> None:
    env = arch_env(handling=EXACT, max_actions=1)
    half = (4.0, 2.0)
    staged(env, (half, (-5, 4, UPRIGHT)), (half, (5, 4, UPRIGHT)), (half, (25, 2, 0)))
    _, reward, terminated, truncated, info = env.perform("move", env.state.ids[2], 0.0)
    assert (reward, terminated, truncated) == (0.0, False, True)
    assert info["arch_score"] == pytest.approx(48.0, abs=0.5)


def test_the_last_action_is_paid_where_the_end_pays() -> None:
    env = arch_env(handling=EXACT, max_actions=2, pays="end")
    half = (4.0, 2.0)
    staged(env, (half, (-5, 4, UPRIGHT)), (half, (5, 4, UPRIGHT)), (half, (25, 2, 0)))
    assert env.perform("move", env.state.ids[2], 0.0)[1:4] == (0.0, False, False)
    again = env.perform("move", env.state.ids[2], 0.0)
    assert again[1] == again[4]["arch_score"] > 40.0
    assert again[3]
    env.reset(seed=0)
    # Also where the last action says so.
    assert env.step(24)[1:3] == (0.0, True)


def test_targets_near_moves_by_hand() -> None:
    env = arch_env(n_blocks=3)
    staged(env, *(((2.0, 2.0), (x, 2.0, 0.0)) for x in (0.0, 10.0, 30.0)))
    before, first = env.decision(), env.state.ids[0]
    # Rotate the first block; move it onto the second, to 10; half way there, to 5.
    asked = np.array([0, 4, 6])
    after = env.refine(asked)
    assert [env.command(int(position)).arguments[1:] for position in asked] == [
        (),
        pytest.approx((10.0,), abs=0.1),
        pytest.approx((5.0,), abs=0.1),
    ]
    # From 10: half way to 30 is between the others, which is offered already; a tenth away from it is 8. From
    # 5: half way to 10 and 30, and a tenth away from them.
    added = after.objects[before.n_objects :, 0]
    np.testing.assert_allclose(added, [8.0, 7.5, 17.5, 4.5, 2.5], atol=0.1)
    assert after.types[len(before) :].tolist() == [1] * 5
    assert after.arguments[len(before) :].tolist() == [[0, before.n_objects + i] for i in range(5)]
    check_refined(before, after)
    assert env.refine(asked) is after
    np.testing.assert_array_equal(np.flatnonzero(env.action_masks()), np.sort(after.indices))
    # It can be taken.
    assert env.command(len(after) - 1).arguments == pytest.approx((first, 2.5), abs=0.1)
    env.step(after.indices[-1])
    assert env._caption().startswith(f"move({first}")
    with pytest.raises(InputError, match="position must name one of"):
        env.refine(np.array([999]))


def test_only_so_many_targets_are_added_and_one_slot_is_left_for_a_policy() -> None:
    env = arch_env()
    env.reset(seed=0)
    for _ in range(30):
        env.refine(np.flatnonzero(env.decision().types == 1))
    assert env.moment.targets.free == 1
    n_before = len(env.decision())
    position = env.offer_move(1, 12.34567)
    assert position == n_before
    assert env.command(position).arguments == pytest.approx((1, 12.34567))
    assert env.offer_move(1, 12.34567) == position
    with pytest.raises(InputError, match=r"a move of block 1 to 3\.21 cannot be offered in arch"):
        env.offer_move(1, 3.21)
    env.step(env.decision().indices[position])
    assert env.moment.targets.free == 81


@pytest.mark.parametrize(
    ("block", "x", "message"),
    [(3, 0.0, "block must be an integer from 0 to 2"), (0, float("nan"), "x must be a finite number")],
)
def test_a_move_that_is_impossible_is_not_offered(block: int, x: float, message: str) -> None:
    env = arch_env()
    env.reset(seed=0)
    before = env.decision()
    with pytest.raises(InputError, match=message):
        env.offer_move(block, x)
    assert env.decision() is before


def test_without_moves_there_is_nothing_to_refine() -> None:
    env = high_towers_env()
    env.reset(seed=0)
    before = env.decision()
    assert env.refine(np.arange(len(before))) is before
    with pytest.raises(InputError, match="cannot be offered in high-towers"):
        env.offer_move(0, 1.0)


def test_a_copy_knows_what_was_added_and_goes_on_with_it() -> None:
    env = arch_env()
    env.reset(seed=0)
    action = env.decision().indices
    after = env.refine(np.flatnonzero(env.decision().types == 1)[:2])
    assert len(after) > len(action)
    other = copy.deepcopy(env)
    one, two = (each.step(after.indices[-1]) for each in (env, other))
    assert one[0]["location"].tobytes() == two[0]["location"].tobytes()


def test_done_without_an_arch_earns_nothing() -> None:
    env = arch_env()
    env.reset(seed=0)
    _, reward, terminated, _, info = env.step(24)
    assert (reward, terminated, info["arch_score"]) == (0.0, True, 0.0)


def test_a_block_that_falls_off_the_table_is_gone_and_its_actions_with_it() -> None:
    env = staged(high_towers_env(n_blocks=2), ((2, 2), (0, 2, 0)), BESIDE_THE_TABLE, at_rest=False)
    lost = env.state.ids[1]
    observation, _, terminated, _, info = env.step(2)
    # What is left is rotate of the first block: the actions are put, put, rotate, rotate.
    assert info["action_mask"].tolist() == [0, 0, 1, 0]
    assert observation["mask"].tolist() == [1, 0]
    assert observation["extent"].tolist() == [[2, 2], [0, 0]]
    assert info["mean_height"] == pytest.approx(env.state.poses[0, 1])
    assert not terminated
    with pytest.raises(InputError, match=f"block {lost} is not on the table"):
        env.perform("rotate", lost)


def test_an_unavailable_action_does_nothing_and_counts() -> None:
    env = high_towers_env(n_blocks=2, max_actions=3)
    staged(env, ((2, 2), (0, 2, 0)), BESIDE_THE_TABLE, at_rest=False)
    env.step(2)
    before, time = env.state, env.simulation.time
    _, reward, terminated, truncated, info = env.step(0)
    assert (reward, terminated, truncated) == (0.0, False, False)
    assert (info["duration"], info["discounted_reward"]) == (0.0, 0.0)
    assert info["option"] == OptionResult(0.0, 0, 0, grasped=False)
    assert env.simulation.time == time
    np.testing.assert_array_equal(env.state.poses, before.poses)
    assert env.step(0)[3]


def test_every_action_leaves_one_less() -> None:
    env = high_towers_env(n_blocks=2, max_actions=3)
    staged(env, ((2, 2), (0, 2, 0)), BESIDE_THE_TABLE, at_rest=False)
    remaining = [env.decision().remaining]
    for action in (2, 0, 2):  # the second one is unavailable by then
        env.step(action)
        remaining.append(env.decision().remaining)
    assert remaining == [3, 2, 1, 0]
    assert len(env.decision())
    env.reset()
    assert env.decision().remaining == 3


def test_nothing_remains_after_done() -> None:
    env = arch_env()
    env.reset(seed=0)
    assert env.decision().remaining == env.max_actions
    env.step(24)
    assert env.decision().remaining == 0


def test_without_any_block_the_episode_is_over() -> None:
    env = staged(high_towers_env(n_blocks=1), BESIDE_THE_TABLE, at_rest=False)
    observation, reward, terminated, truncated, info = env.step(0)
    assert (terminated, truncated) == (True, False)
    assert not observation["mask"].any()
    assert info["mean_height"] == 0.0
    assert env.decision().remaining == 0
    assert np.isfinite(reward)


def test_info_describes_state_and_choices() -> None:
    env = arch_env()
    observation, info = env.reset(seed=5)
    assert "duration" not in info
    scene = info["scene"]
    assert isinstance(scene, Scenes)
    # At most 3 blocks, 7 targets for each, and 4 near each of 20 of them and one of a policy's own.
    assert observation["location"].shape == (105, 2)
    decision = env.decision()
    assert observation["mask"].sum() == decision.n_objects > 3
    # Targets are private to the moves that go there: they are in the observation, but not in the scene.
    assert scene.object_ids.tolist() == ["block_0", "block_1", "block_2"]
    assert decision.n_shared == 3
    # What is undefined about them is 0 in the observation.
    assert np.isnan(decision.objects[3:, 2:]).all()
    assert not observation["extent"][3:].any()


def test_a_move_sees_the_blocks_and_its_own_target() -> None:
    env = arch_env(n_blocks=2)
    half = (4.0, 2.0)
    staged(env, (half, (-10, 2, 0)), (half, (10, 2, 0)))
    # For each of two blocks: onto the other, half the way towards it, a tenth farther away.
    targets = [10.0, 0.0, -12.0, -10.0, 0.0, 12.0]
    nothing, never, first = np.empty(0), np.empty(0, dtype=np.bool_), np.empty(0, dtype=np.int64)
    outcomes = Outcomes(nothing, nothing, nothing, never, never)
    experience = experience_of(
        Decisions.of([env.decision()]), np.zeros(1, np.int64), first, first, outcomes, np.zeros((2, 1))
    )
    moves = np.flatnonzero(experience.types == ARCH_ACTIONS.index(MOVE))
    scenes = action_scenes(experience, moves, Schema(SCHEMA.attributes, MOVE.parameters))
    assert scenes.counts.tolist() == [3] * 6
    for i, target in enumerate(targets):
        objects = scenes.matrix[scenes.objects(i)]
        np.testing.assert_allclose(objects[:, 0], [-10.0, 10.0, target], atol=0.1)
        assert np.isnan(objects[:, 2]).tolist() == [False, False, True]
        assert scenes.arguments[i].tolist() == [i // 3, 2 + i]
    done = np.flatnonzero(experience.types == ARCH_ACTIONS.index(DONE))
    assert action_scenes(experience, done, SCHEMA).counts.tolist() == [2]


def test_sizes_are_options() -> None:
    env = color_grouping_env(sides=(2.0, 3.0), n_blocks=40)
    env.reset(seed=0)
    assert env.state.half_extents.min() == pytest.approx(1.0, abs=0.05)
    assert env.state.half_extents.max() == pytest.approx(1.5, abs=0.05)
    assert ((env.state.half_extents >= 1.0) & (env.state.half_extents <= 1.5)).all()
    portal = arch_env(size=(6.0, 1.0))
    portal.reset(seed=0)
    assert portal.state.half_extents.tolist() == [[3.0, 0.5]] * 3


def test_ids_count_on_until_a_seed_is_given() -> None:
    env = high_towers_env()
    for seed, expected in ((0, 0), (None, 5), (None, 10), (1, 0)):
        env.reset(seed=seed)
        assert env.state.ids.tolist() == list(range(expected, expected + 5))


@pytest.mark.parametrize("make", [high_towers_env, color_grouping_env, arch_env])
def test_the_same_seed_gives_the_same_episodes(make: Any) -> None:
    env = make()
    first = played(env, 7, steps=8)
    assert played(env, 7, steps=8) == first
    assert played(make(), 7, steps=8) == first
    assert played(env, 8, steps=8) != first


def test_another_process_sees_the_same_episode_bit_for_bit() -> None:
    script = """
import hashlib, numpy as np
from relforest.worlds.blocks.env import arch_env
env, rng, seen = arch_env(), np.random.default_rng(0), hashlib.sha256()
env.reset(seed=11)
for _ in range(3):
    observation, *_, info = env.step(rng.choice(np.flatnonzero(env.action_masks())[:-1]))
    seen.update(observation["location"].tobytes() + repr(info["duration"]).encode())
print(seen.hexdigest())
"""
    seen = {
        subprocess.run(
            [sys.executable, "-c", script],
            capture_output=True,
            text=True,
            check=True,
            env={"PYTHONHASHSEED": seed, "PYTHONPATH": ":".join(sys.path)},
        ).stdout
        for seed in ("0", "1")
    }
    assert len(seen) == 1


def test_pictures_are_made_on_request() -> None:
    env = arch_env("rgb_array")
    env.reset(seed=0)
    picture = env.render()
    assert picture.ndim == 3
    assert picture.dtype == np.uint8
    assert picture.std() > 0
    with pytest.raises(InputError, match='make the world with render_mode="rgb_array"'):
        arch_env().render()


def test_frames_tell_the_last_action_its_reward_and_where_the_robot_let_go() -> None:
    env = arch_env(handling=EXACT)
    staged(env, ((4.0, 2.0), (-10, 2, 0)), ((4.0, 2.0), (10, 2, 0)), BESIDE_THE_TABLE, at_rest=False)
    ids = env.state.ids.tolist()
    frames = [env._frame()]
    env.perform("move", ids[0], -16.66)
    frames.append(env._frame())
    for action in (2, 24):
        env.step(action)
        frames.append(env._frame())
    assert [frame.caption for frame in frames] == [
        "arch",
        f"move({ids[0]}, x = \N{MINUS SIGN}16.7): 0.00",
        "unavailable action: 0.00",
        "done: 0.00",
    ]
    grips = [[thing for thing in frame.things if thing.key == "grip"] for frame in frames]
    # The block was let go 2 above the table.
    assert grips[0] == []
    assert (grips[1][0].x, grips[1][0].y) == pytest.approx((-16.66, 4.0), abs=0.1)


def test_an_action_that_is_refused_does_not_change_what_is_told() -> None:
    env = high_towers_env(n_blocks=2)
    env.reset(seed=0)
    before = env._frame()
    with pytest.raises(InputError):
        env.perform("rotate", 77)
    assert env._frame() == before


@pytest.mark.parametrize(
    ("name", "arguments", "message"),
    [
        ("put", (0, 1), "action must be one of 'rotate', 'move', 'done', got 'put'"),
        ("move", (0, float("nan")), "x must be a finite number"),
        ("move", (0, float("inf")), "x must be a finite number"),
        ("move", (0,), r"got move with arguments \(0,\)"),
        ("rotate", (17,), "block 17 is not on the table"),
        ("rotate", (0.5,), "id of a block must be an integer"),
        ("done", (1,), "got done with arguments"),
    ],
)
def test_a_command_that_cannot_be_carried_out_changes_nothing(
    name: str, arguments: tuple[float, ...], message: str
) -> None:
    env = arch_env()
    env.reset(seed=0)
    time = env.simulation.time
    with pytest.raises(InputError, match=message):
        env.perform(name, *arguments)
    assert env.simulation.time == time
    assert not env.perform("done")[3]


def test_a_block_is_not_put_on_itself() -> None:
    env = high_towers_env()
    env.reset(seed=0)
    with pytest.raises(InputError, match="cannot be put on itself"):
        env.perform("put", 1, 1)


def test_a_far_away_target_is_given_up() -> None:
    env = arch_env()
    env.reset(seed=0)
    observation, *_, info = env.perform("move", 0, 1e12)
    assert info["option"].steps <= 2500
    assert env.observation_space.contains(observation)


@pytest.mark.parametrize(
    ("make", "options", "message"),
    [
        (high_towers_env, {"n_blocks": 0}, "n_blocks must be an integer from 1 to 100, got 0"),
        (high_towers_env, {"n_blocks": 99_999}, "n_blocks must be an integer from 1 to 100, got 99999"),
        (color_grouping_env, {"n_blocks": 101}, "n_blocks must be an integer from 1 to 100, got 101"),
        (arch_env, {"n_blocks": 26}, "n_blocks must be an integer from 1 to 25, got 26"),
        (high_towers_env, {"max_actions": 0}, "max_actions must be an integer from 1 to 1000, got 0"),
        (arch_env, {"max_actions": 1001}, "max_actions must be an integer from 1 to 1000, got 1001"),
        (
            high_towers_env,
            {"handling": Noise()},
            r"handling must be a Handling, such as Handling\(\), got Noise",
        ),
        (color_grouping_env, {"distance": "lab"}, "distance must be one of"),
        (arch_env, {"sampler": "all"}, "sampler must be one of"),
        (arch_env, {"pays": "change"}, "pays must be one of 'done', 'end', got 'change'"),
        (arch_env, {"size": (0.0, 4.0)}, "size must be a number of at least 0.02 and of at most 10, got 0.0"),
        (high_towers_env, {"sides": (4.0, 2.0)}, "sides must be the smallest and the largest side"),
        (high_towers_env, {"sides": 4.0}, "sides must be two lengths, got 4.0"),
        (
            color_grouping_env,
            {"sides": (1.0, 11.0)},
            "sides must be a number of at least 0.02 and of at most 10",
        ),
    ],
)
def test_options_out_of_range_are_errors(make: Any, options: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        make(**options)


def test_the_order_of_calls_is_kept() -> None:
    env = high_towers_env(max_actions=1)
    for use in (
        lambda: env.step(0),
        env.decision,
        env.action_masks,
        lambda: env.state,
        lambda: env.simulation,
    ):
        with pytest.raises(ResetNeeded, match=r"no episode has begun: call reset\(\) first"):
            use()
    env.reset(seed=0)
    assert env.step(0)[3]
    with pytest.raises(ResetNeeded, match="ended after 1 action:"):
        env.step(0)
    env.reset()
    env.step(0)


@pytest.mark.parametrize("make", [high_towers_env, color_grouping_env, arch_env])
def test_an_environment_can_be_sent_to_a_process_before_its_first_reset(
    make: Callable[[], BlocksEnv],
) -> None:
    env = make()
    sent = pickle.loads(pickle.dumps(env))  # noqa: S301 - our own bytes

    for name, array in env.reset(seed=1)[0].items():
        np.testing.assert_array_equal(array, sent.reset(seed=1)[0][name])
