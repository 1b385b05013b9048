from __future__ import annotations

from typing import Any, final

import gymnasium
import numpy as np
import pytest

from relforest.smdp import Decision
from relforest.support.errors import InputError
from relforest.support.progress import Stage, listening
from relforest.support.rng import generator, seed_sequence, stream
from relforest.worlds.blocks.blocks import Block
from relforest.worlds.blocks.env import BlocksEnv, arch_env, color_grouping_env, high_towers_env
from relforest.worlds.blocks.options import OptionResult
from relforest.worlds.blocks.policies import make_policy
from relforest.worlds.blocks.recorder import marks_of, record_episodes
from relforest.worlds.blocks.recording import Recording
from relforest.worlds.blocks.simulation import BlocksSimulation
from relforest.worlds.blocks.state import Cast
from relforest.worlds.blocks.tasks import arch, color_grouping, high_towers


def envs() -> list[BlocksEnv]:
    return [
        high_towers_env(n_blocks=3, max_actions=2),
        color_grouping_env(n_blocks=3, max_actions=2),
        arch_env(max_actions=2),
    ]


def recorded(env: BlocksEnv, seed: int = 0) -> Recording:
    (episode,) = record_episodes(env, make_policy("random", env), seed=seed)
    return episode


@pytest.mark.parametrize("env", envs(), ids=lambda env: env.task.name)
def test_what_is_recorded_is_what_happened(env: BlocksEnv) -> None:
    episode = recorded(env, seed=7)
    policy, root = make_policy("random", env), seed_sequence(7)
    rng = generator(stream(root, 0, 1))
    env.reset(seed=int(stream(root, 0, 0).generate_state(1)[0]))

    assert episode.ids.tolist() == env.state.ids.tolist()
    assert episode.first_score == env.moment.score
    np.testing.assert_array_equal(episode.half_extents, env.state.half_extents)
    np.testing.assert_array_equal(episode.colors, env.state.colors)
    for option in episode.options:
        position = policy.choose(env.decision(), rng)
        command, begin = env.command(position), env.simulation.time
        _, reward, _, _, info = env.step(env.decision().indices[position])

        assert (option.name, option.begin, option.end) == (command.name, begin, env.simulation.time)
        assert option.duration == pytest.approx(info["duration"])
        assert [*option.blocks, *([] if option.target is None else [option.target])] == [*command.arguments]
        assert (option.reward, option.score) == (reward, env.moment.score)
    np.testing.assert_array_equal(episode.poses[-1], env.state.poses)


def test_the_drop_is_part_of_the_episode() -> None:
    env = high_towers_env(n_blocks=3, max_actions=1)
    episode = recorded(env)
    begin = episode.options[0].begin
    falling = episode.poses[episode.times <= begin]
    env.reset(seed=int(stream(seed_sequence(0), 0, 0).generate_state(1)[0]))

    assert episode.times[0] == 0.0
    assert (np.diff(episode.times) <= 0.0401).all()
    # Blocks begin in the air, and rest where the environment says when the first option begins.
    assert falling[0, :, 1].mean() > falling[-1, :, 1].mean() + 3
    np.testing.assert_allclose(falling[-1], env.state.poses, atol=0.02)


def test_what_is_held_is_the_block_that_an_option_takes() -> None:
    episode = recorded(high_towers_env(n_blocks=3, max_actions=2))

    for option in episode.options:
        during = (episode.times > option.begin) & (episode.times < option.end)
        assert set(episode.held[during].tolist()) == {-1, option.blocks[0]}
    assert set(episode.held[episode.times < episode.options[0].begin].tolist()) == {-1}


def test_episodes_depend_on_the_seed_and_their_number_only() -> None:
    env = high_towers_env(n_blocks=2, max_actions=1)
    policy = make_policy("random", env)
    two, again = record_episodes(env, policy, 2, seed=5), record_episodes(env, policy, 1, seed=5)
    (other,) = record_episodes(env, policy, 1, seed=6)

    np.testing.assert_array_equal(two[0].poses, again[0].poses)
    assert two[0].options == again[0].options
    assert two[0].first_score != two[1].first_score
    assert again[0].first_score != other.first_score


def test_nothing_is_collected_after_an_episode() -> None:
    env = high_towers_env(n_blocks=2, max_actions=1)
    recorded(env)

    assert env.simulation.frames is None


@final
class Stubborn:
    """Always takes the first action, as often as it is told."""

    def __init__(self, times: int) -> None:
        self.times = times

    def choose(self, decision: Decision, rng: np.random.Generator) -> int:  # noqa: ARG002
        self.times -= 1
        return 0

    def is_finished(self, decision: Decision) -> bool:  # noqa: ARG002
        return self.times == 0


@pytest.mark.parametrize("times", [0, 2])
def test_an_episode_is_over_when_the_policy_has_nothing_left_to_do(times: int) -> None:
    (episode,) = record_episodes(high_towers_env(n_blocks=1), Stubborn(times))

    assert [option.name for option in episode.options] == ["rotate"] * times


def test_a_block_that_is_lost_has_no_place_any_more(monkeypatch: pytest.MonkeyPatch) -> None:
    # The table ends at 100.
    def throw(sim: BlocksSimulation, block: int, **_: object) -> OptionResult:
        sim.grab(block, (0.0, 0.0))
        sim.carry((130.0, 20.0))
        sim.let_go()
        sim.step(300)
        return OptionResult(8.0, 800, 0, grasped=True)

    monkeypatch.setattr("relforest.worlds.blocks.command.rotate", throw)
    (episode,) = record_episodes(high_towers_env(n_blocks=1), Stubborn(3))
    gone = np.isnan(episode.poses[:, 0, 0])

    assert len(episode.options) == 1
    assert (gone[0], gone[-1]) == (False, True)
    assert (np.diff(gone.astype(int)) >= 0).all()
    assert episode.last_score == 0.0


def test_an_arch_is_marked_by_its_opening() -> None:
    sim = BlocksSimulation(np.random.default_rng(0))
    blocks = [Block(number, (4.0, 2.0), (0.5, 0.5, 0.5)) for number in range(3)]
    sim.place(blocks, [(-5.0, 4.0, np.pi / 2), (5.0, 4.0, np.pi / 2), (0.0, 10.0, 0.0)])
    sim.step(100)
    state = sim.state
    (mark,) = marks_of(state, arch())

    # Supports 4 wide with their centres 10 apart leave 6; they are 8 high.
    assert (mark.left, mark.right) == pytest.approx((-3.0, 3.0), abs=0.1)
    assert (mark.low, mark.high) == pytest.approx((0.0, 8.0), abs=0.1)
    assert mark.score == arch().score(state)
    assert marks_of(state, high_towers()) == ()


def test_stacks_are_marked_with_what_they_score() -> None:
    sim = BlocksSimulation(np.random.default_rng(0))
    colors = [(1.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 0.0), (1.0, 1.0, 1.0)]
    blocks = [Block(number, (2.0, 1.0), color) for number, color in enumerate(colors)]
    places = [(-20.0, 1.0), (-19.0, 3.1), (0.0, 1.0), (20.0, 1.0), (20.0, 3.1)]
    sim.place(blocks, [(x, y, 0.0) for x, y in places])
    state = sim.state
    task = color_grouping("rgb")
    red, grey = marks_of(state, task)

    # Equal colours score 1, the most different ones -1; the block between has no stack.
    assert (red.left, red.right, red.low, red.high) == (-22.0, -17.0, 0.0, 0.0)
    assert (grey.left, grey.right) == (18.0, 22.0)
    assert (red.score, grey.score) == pytest.approx((1.0, -1.0))
    assert task.score(state) == pytest.approx(red.score + grey.score)


def test_an_empty_table_has_no_marks() -> None:
    empty = Cast.of([]).state(np.zeros((0, 3)), [])
    assert marks_of(empty, arch()) == marks_of(empty, color_grouping()) == ()


def test_no_episodes_are_refused() -> None:
    env = high_towers_env(n_blocks=2)
    for episodes in (0, 1001, True, 2.0):
        with pytest.raises(InputError, match=f"episodes must be an integer from 1 to 1000, got {episodes}"):
            record_episodes(env, make_policy("random", env), episodes)  # type: ignore[arg-type]


def test_recordings_that_do_not_fit_into_memory_are_refused_at_once() -> None:
    env = high_towers_env(n_blocks=100, max_actions=1000)
    with pytest.raises(InputError, match=r"at most 200000 to .*, got 3 x 1000 x 100: choose fewer"):
        record_episodes(env, make_policy("random", env), 3)


def test_what_is_recorded_is_checked() -> None:
    env = high_towers_env(n_blocks=2)
    policy = make_policy("random", env)
    wrapped: Any = gymnasium.make("relforest/HighTowers-v0")
    with pytest.raises(InputError, match=r"env must be a task .* itself, got .*: pass env.unwrapped"):
        record_episodes(wrapped, policy)
    named: Any = "random"
    with pytest.raises(InputError, match=r"policy must have choose\(\) and is_finished\(\), got 'random'"):
        record_episodes(env, named)


def test_progress_is_reported() -> None:
    env = high_towers_env(n_blocks=2, max_actions=1)
    stages: list[Stage] = []
    with listening(stages.append):
        record_episodes(env, make_policy("random", env), 2)
    assert stages == [Stage("playing episodes", 0, 2), Stage("playing episodes", 1, 2)]
