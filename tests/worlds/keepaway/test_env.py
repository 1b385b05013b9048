from __future__ import annotations

import copy
import itertools
import warnings
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.error import ResetNeeded
from gymnasium.utils.env_checker import check_env
from numpy.typing import NDArray

from interpreted import compiled_only
from relforest.rl.policy import RandomPolicy
from relforest.rl.rollout import rollout
from relforest.scenes import Scenes
from relforest.support.errors import InputError
from relforest.support.rng import seed_sequence, stream
from relforest.testing import check_world
from relforest.worlds.keepaway.decisions.policies import HandCodedPolicy, hand_coded
from relforest.worlds.keepaway.decisions.scene import NOBODY, location_of
from relforest.worlds.keepaway.decisions.variables import n_variables, nearest_keeper, state_variables
from relforest.worlds.keepaway.env import KeepawayEnv
from relforest.worlds.keepaway.play.advance import HAND, HOLD, NO_ACTION, advance
from relforest.worlds.keepaway.play.games import new_games
from relforest.worlds.keepaway.players.views import new_work
from relforest.worlds.keepaway.server.layout import END, PLAYING, TIME
from relforest.worlds.keepaway.server.options import KeepawayOptions
from relforest.worlds.keepaway.spaces import variables_space
from relforest.worlds.keepaway.wrapper import StateVariables

pytestmark = compiled_only

Step = tuple[dict[str, Any], float, bool, bool, dict[str, Any]]


def random_episodes(env: KeepawayEnv, seed: int, episodes: int) -> list[tuple[dict[str, Any], list[Step]]]:
    """Play at random and return, for each episode, the info of its reset and what each step returned."""
    rng = np.random.default_rng(seed)
    played = []
    for number in range(episodes):
        _, first = env.reset(seed=seed if number == 0 else None)
        steps: list[Step] = []
        while not steps or not (steps[-1][2] or steps[-1][3]):
            steps.append(env.step(rng.integers(env.action_space.n)))
        played.append((first, steps))
    return played


def test_gymnasiums_own_check_passes_without_a_warning() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_env(gymnasium.make("relforest/Keepaway-v0", render_mode="rgb_array").unwrapped)


@pytest.mark.parametrize(
    "options",
    [
        {},
        {"keepers": 4, "takers": 3, "size": 25.0},
        {"keepers": 2, "takers": 1, "size": (12, 9.5), "max_cycles": 40},
        {"keepers": 5, "takers": 3, "size": 30.0, "perception": "exact", "stuck_ball": 100},
    ],
)
def test_keepaway_is_a_world(options: dict[str, Any]) -> None:
    check_world(lambda: gymnasium.make("relforest/Keepaway-v0", **options), seed=2, steps=60)


def test_spaces_have_the_numbers_of_players() -> None:
    env = KeepawayEnv(keepers=4, takers=3, size=(30.0, 20.0))
    assert env.action_space.n == 4
    shapes = {name: space.shape for name, space in env.observation_space.spaces.items()}
    assert shapes == {"location": (7, 2), "orientation": (7, 1), "color": (7, 3), "mask": (7,)}


def test_rewards_and_the_first_time_add_up_to_the_duration() -> None:
    env = KeepawayEnv()
    for first, steps in random_episodes(env, 3, 5):
        # The ball starts 4 m inside the corner, out of reach of everybody (3 m at most along each axis).
        assert first["time"] > 0
        times = [first["time"], *(info["time"] for *_, info in steps)]
        rewards = [reward for _, reward, *_ in steps]
        assert rewards == np.diff(times).tolist()
        assert first["time"] + sum(rewards) == steps[-1][-1]["time"]


def test_the_discounted_reward_counts_each_cycle_from_the_decision_on() -> None:
    for _, steps in random_episodes(KeepawayEnv(), 4, 3):
        for _, reward, _, _, info in steps:
            assert info["duration"] == reward
            expected = sum(0.9**k for k in range(int(reward)))
            assert info["discounted_reward"] == pytest.approx(expected, abs=1e-12)


def test_episodes_end_out_or_taken() -> None:
    ends = set()
    env = KeepawayEnv()
    for seed in range(15):
        _, info = env.reset(seed=seed)
        terminated = False
        while not terminated:
            *_, terminated, truncated, info = env.step(0)
            assert terminated == ("end" in info)
            assert not truncated
        ends.add(info["end"])
        assert info["actor"] == NOBODY
        assert info["action_mask"].tolist() == [0, 0, 0]
    assert ends == {"out", "taken"}


def test_nothing_can_be_done_in_a_terminal_state() -> None:
    env = KeepawayEnv()
    (_, steps), *_ = random_episodes(env, 0, 1)
    assert len(env.decision()) == 0
    # What is shown is the true state.
    np.testing.assert_array_equal(env.decision().objects[:, :2], env.batch.games.players[0, :, :2])
    with pytest.raises(ResetNeeded, match=f"ended after {steps[-1][-1]['time']} cycles"):
        env.step(0)


def test_a_limit_of_time_truncates() -> None:
    env = KeepawayEnv(max_cycles=20)
    (_, steps), *_ = random_episodes(env, 1, 1)
    *_, terminated, truncated, info = steps[-1]
    assert (terminated, truncated, info["end"], info["time"]) == (False, True, "capped", 20)
    # Somebody stands in, so that the value of the state can be asked for: whoever is nearest to the ball.
    games = env.batch.games
    assert info["actor"] == nearest_keeper(games.players[0], games.ball[0], 3)
    assert len(env.decision()) == 3
    assert info["action_mask"].tolist() == [1, 1, 1]


def test_episodes_without_a_decision_are_passed_over_and_counted() -> None:
    # The first touch comes after about five cycles, so with six some episodes end before it.
    env = KeepawayEnv(max_cycles=6)
    counts = []
    for seed in range(12):
        _, info = env.reset(seed=seed)
        assert 0 < info["time"] < 6
        assert env.batch.ends[0] == PLAYING
        counts.append(info["without_decision"])
    assert 0 in counts
    assert max(counts) > 0


def test_a_limit_that_allows_no_decision_is_an_error() -> None:
    with pytest.raises(InputError, match=r"1000 episodes in a row .* a larger max_cycles than 1, or 0"):
        KeepawayEnv(max_cycles=1).reset(seed=0)


def test_every_keeper_has_its_own_samples() -> None:
    # E. g. keeper 0 decides at 5 and 9, keeper 1 at 7: their own samples are 5 -> 9 and 7 -> end.
    for first, steps in random_episodes(KeepawayEnv(), 5, 5):
        before: dict[int, int] = {}
        info = first
        for *_, following in steps:
            actor, last = info["actor"], info["last_times"]
            if actor in before:
                # It has had the ball since only if it went on passing, one cycle after the other.
                assert before[actor] <= last[actor] < info["time"]
            else:
                assert last[actor] == -1
            before[actor] = info["time"]
            info = following
        assert all(info["last_times"][keeper] >= time for keeper, time in before.items())
        assert all(info["last_times"][keeper] == -1 for keeper in {0, 1, 2} - before.keys())


def test_holding_lasts_one_cycle() -> None:
    env = KeepawayEnv()
    _, info = env.reset(seed=0)
    seen = 0
    for _ in range(20):
        actor, time = info["actor"], info["time"]
        _, reward, terminated, _, info = env.step(0)
        if terminated:
            break
        if info["actor"] == actor and reward > 0:
            assert info["last_times"][actor] == time
            seen += reward == 1
    assert seen > 0


def test_two_keepers_may_decide_in_the_same_cycle() -> None:
    found = 0
    env = KeepawayEnv(keepers=6, takers=1, size=10.0)
    for first, steps in random_episodes(env, 0, 20):
        infos = [first, *(info for *_, info in steps)]
        for before, after in itertools.pairwise(infos):
            if after["duration"] == 0:
                found += 1
                assert after["actor"] > before["actor"]
                assert after["time"] == before["time"]
                assert after["discounted_reward"] == 0
    assert found > 0


@pytest.mark.parametrize("name", ["hold", "hand"])
def test_decisions_from_outside_give_the_game_of_the_built_in_policies(name: str) -> None:
    options = KeepawayOptions(keepers=4, takers=3, size=25.0)
    setup = options.setup()
    games, work = new_games(setup, [seed_sequence(11)]), new_work(setup)
    advance(games, 0, setup, {"hold": HOLD, "hand": HAND}[name], NO_ACTION, work)
    assert games.counters[0, END] != PLAYING

    env = KeepawayEnv(keepers=4, takers=3, size=25.0)
    _, info = env.reset(seed=11)
    assert info["without_decision"] == 0
    ended = False
    while not ended:
        action = hand_coded(info["variables"], 4, 3) if name == "hand" else 0
        *_, ended, _, info = env.step(action)
    assert info["time"] == games.counters[0, TIME]
    np.testing.assert_array_equal(env.batch.games.players, games.players)
    np.testing.assert_array_equal(env.batch.games.ball, games.ball)


def test_with_exact_perception_the_scene_is_the_state() -> None:
    env = KeepawayEnv(perception="exact")
    observation, info = env.reset(seed=1)
    for _ in range(20):
        games = env.batch.games
        np.testing.assert_array_equal(observation["location"], games.players[0, :, :2])
        np.testing.assert_allclose(
            np.exp(1j * observation["orientation"][:, 0]), np.exp(1j * np.radians(games.players[0, :, 4]))
        )
        expected = np.empty(13)
        state_variables(games.players[0], games.ball[0], 3, expected)
        np.testing.assert_array_equal(info["variables"], expected)
        observation, _, ended, _, info = env.step(1)
        if ended:
            break


def test_with_quantised_perception_the_scene_is_what_the_actor_sees() -> None:
    env = KeepawayEnv()
    inexact = 0
    for seed in range(5):
        observation, info = env.reset(seed=seed)
        true = env.batch.games.players[0, :, :2]
        seen, own = observation["location"], true[info["actor"]]
        assert seen[info["actor"]].tolist() == own.tolist()
        error = np.linalg.norm(seen - true, axis=1)
        # Distances are off by 5 % and by rounding to 0.1 m, directions by half a degree.
        assert (error <= 0.07 * np.linalg.norm(true - own, axis=1) + 0.06).all()
        inexact += int((error > 0).sum())
    assert inexact >= 15


def test_passes_are_counted_by_distance() -> None:
    env = KeepawayEnv(keepers=5, takers=2, size=25.0)
    for seed in range(5):
        _, info = env.reset(seed=seed)
        decision = env.decision()
        location = location_of(decision.objects)
        assert decision.arguments[:, 0].tolist() == [info["actor"]] * 5
        distances = np.linalg.norm(location[decision.arguments[1:, 1]] - location[info["actor"]], axis=1)
        assert (np.diff(distances) >= 0).all()
        assert set(decision.arguments[1:, 1]) == set(range(5)) - {info["actor"]}


@pytest.mark.parametrize("action", [1, 2])
def test_a_pass_goes_towards_its_receiver(action: int) -> None:
    env = KeepawayEnv(perception="exact")
    agreed = 0
    for seed in range(8):
        env.reset(seed=seed)
        receiver = env.decision().arguments[action, 1]
        ball, target = env.batch.games.ball[0, :2].copy(), env.batch.games.players[0, receiver, :2].copy()
        env.step(action)
        # Some passes are taken on their way, or need a stop first.
        moved = env.batch.games.ball[0, :2] - ball
        agreed += bool(moved @ (target - ball) > 0.9 * np.linalg.norm(moved) * np.linalg.norm(target - ball))
    assert agreed >= 5


def test_scenes_can_be_read_from_the_observation() -> None:
    env = KeepawayEnv()
    observation, info = env.reset(seed=0)
    read = Scenes.from_padded(observation, schema=env.schema)
    np.testing.assert_array_equal(read.matrix, info["scene"].matrix)
    assert info["scene"].object_ids.tolist() == ["keeper_0", "keeper_1", "keeper_2", "taker_0", "taker_1"]


def trajectory(env: KeepawayEnv, seed: int) -> list[Any]:
    return [
        (step[0]["location"].tolist(), step[1], step[-1]["variables"].tolist())
        for _, steps in random_episodes(env, seed, 2)
        for step in steps
    ]


def test_the_same_seed_gives_the_same_episodes() -> None:
    env = KeepawayEnv()
    first = trajectory(env, 5)
    assert trajectory(env, 5) == first
    assert trajectory(KeepawayEnv(), 5) == first
    assert trajectory(KeepawayEnv(), 6) != first


def test_without_a_seed_games_differ() -> None:
    assert KeepawayEnv().reset()[1]["variables"].tolist() != KeepawayEnv().reset()[1]["variables"].tolist()


def test_bodies_keep_their_directions_from_one_episode_to_the_next() -> None:
    env = KeepawayEnv(max_cycles=30)
    random_episodes(env, 0, 1)
    bodies = env.batch.games.players[0, :, 4].copy()
    twin = copy.deepcopy(env)
    twin.batch.games.players[0, :, 4] = 0.0
    assert (bodies != 0.0).any()
    assert env.reset()[0]["orientation"].tolist() != twin.reset()[0]["orientation"].tolist()


def test_a_copy_continues_like_the_original() -> None:
    env = KeepawayEnv()
    env.reset(seed=0)
    twin = copy.deepcopy(env)
    for action in (0, 1, 0, 2):
        ours, theirs = env.step(action), twin.step(action)
        assert ours[1:4] == theirs[1:4]
        assert ours[0]["location"].tolist() == theirs[0]["location"].tolist()


def test_what_is_returned_belongs_to_the_caller() -> None:
    env, twin = KeepawayEnv(), KeepawayEnv()
    observation, info = env.reset(seed=0)
    twin.reset(seed=0)
    for array in (*observation.values(), info["variables"], info["last_times"], info["action_mask"]):
        array[:] = 0
    scene = info["scene"].matrix.copy()
    assert env.step(1)[0]["location"].tolist() == twin.step(1)[0]["location"].tolist()
    np.testing.assert_array_equal(info["scene"].matrix, scene)


def test_learners_can_gather_experience() -> None:
    env, seed = gymnasium.make("relforest/Keepaway-v0"), np.random.SeedSequence(0)
    found = rollout(env, RandomPolicy(), 3, seed)
    assert found.terminal.sum() == 3
    # Learners of all kinds are scored by whole episodes, though they learn from the first decision on.
    first = [env.reset(seed=int(stream(seed, i, 0).generate_state(1)[0]))[1]["time"] for i in range(3)]
    assert min(first) > 0
    assert found.durations.sum() + sum(first) == found.episode_durations.sum()
    np.testing.assert_array_equal(found.episode_rewards, found.episode_durations)
    assert (found.rewards <= 10.0).all()


def test_the_hand_coded_policy_agrees_with_the_state_variables() -> None:
    env = KeepawayEnv()
    _, info = env.reset(seed=8)
    chosen, rng = [], np.random.default_rng(0)
    for _ in range(60):
        location = location_of(env.decision().objects).copy()
        action = HandCodedPolicy().choose(env.decision(), rng)
        variables = np.empty(13)
        state_variables(location, location[info["actor"]], 3, variables)
        assert action == hand_coded(variables, 3, 2)
        chosen.append(action)
        *_, ended, _, info = env.step(action)
        if ended:
            _, info = env.reset()
    assert {0} < set(chosen)


def test_state_variables_instead_of_scenes() -> None:
    env = StateVariables(gymnasium.make("relforest/Keepaway-v0", keepers=4, takers=3, size=25.0))
    variables, info = env.reset(seed=0)
    assert env.observation_space == variables_space(KeepawayEnv(keepers=4, takers=3, size=25.0).setup)
    assert env.observation_space.shape == (n_variables(4, 3),) == (19,)
    for action in (0, 0, 1, 2):
        assert env.observation_space.contains(variables)
        assert variables.tolist() == info["variables"].tolist()
        variables, *_, info = env.step(np.int64(action))


def test_state_variables_are_of_keepaway() -> None:
    with pytest.raises(InputError, match="env must be keepaway, got CorridorEnv"):
        StateVariables(gymnasium.make("relforest/Corridor-v0"))


def test_wrapped_environments_can_be_made_again() -> None:
    env = StateVariables(gymnasium.make("relforest/Keepaway-v0", keepers=2, takers=1))
    assert env.spec is not None
    again = gymnasium.make(env.spec)
    assert again.observation_space == env.observation_space


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"keepers": 1}, "keepers must be an integer from 2 to 32, got 1"),
        ({"takers": 0}, "takers must be an integer from 1 to 32, got 0"),
        ({"size": 1.0}, "size must be"),
        ({"perception": "blind"}, "perception must be one of"),
    ],
)
def test_options_outside_their_range_are_errors(options: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        KeepawayEnv(**options)


def test_rendering_shows_the_state() -> None:
    env = KeepawayEnv(render_mode="rgb_array")
    env.reset(seed=0)
    pictures: list[NDArray[np.uint8]] = [env.render()]
    env.step(1)
    pictures.append(env.render())
    assert pictures[0].dtype == np.uint8
    assert pictures[0].shape == pictures[1].shape
    assert (pictures[0] != pictures[1]).any()
