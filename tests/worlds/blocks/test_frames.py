from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from relforest.playing.frames import Frame
from relforest.playing.painter import paint
from relforest.playing.recorder import Recording, record_episodes
from relforest.playing.shapes import Chip, Line, Polygon, Text, plain
from relforest.support.errors import InputError
from relforest.support.rng import generator, seed_sequence, stream
from relforest.worlds.blocks.blocks import Block
from relforest.worlds.blocks.command import Command
from relforest.worlds.blocks.env import BlocksEnv, arch_env, color_grouping_env, high_towers_env
from relforest.worlds.blocks.frames import block_things, marks_of, option_words, table_stage
from relforest.worlds.blocks.policies import make_policy
from relforest.worlds.blocks.simulation import BlocksSimulation
from relforest.worlds.blocks.state import Cast
from relforest.worlds.blocks.tasks import arch, color_grouping, high_towers

SIDES = np.array([[4.0, 2.0], [1.0, 3.0]])
POSES = np.array([[-10.0, 2.0, 0.0], [10.0, 3.0, 0.5]])
COLORS = np.array([[0.0, 0.5, 1.0], [1.2, -0.1, 1 / 255]])


def envs() -> list[BlocksEnv]:
    return [
        high_towers_env(n_blocks=3, max_actions=2),
        color_grouping_env(n_blocks=3, max_actions=2),
        arch_env(max_actions=2),
    ]


def recorded(env: BlocksEnv, seed: int = 0) -> Recording:
    (episode,) = record_episodes(env, make_policy("random", env), seed=seed)
    return episode


def test_blocks_are_things_in_their_colors() -> None:
    one, other = block_things(SIDES, POSES, COLORS, [7, 8])
    body, label = one.shapes

    assert (one.key, one.x, one.y, one.angle) == ("block 7", -10.0, 2.0, 0.0)
    assert isinstance(body, Polygon)
    assert isinstance(label, Text)
    assert (body.fill, label.words) == ("#0080ff", "7")
    assert body.corners == ((-4.0, -2.0), (4.0, -2.0), (4.0, 2.0), (-4.0, 2.0))
    assert getattr(other.shapes[0], "fill", "") == "#ff0001"
    assert [len(thing.shapes) for thing in block_things(SIDES, POSES, COLORS)] == [1, 1]
    assert block_things([], [], []) == ()
    # Frames share what does not change.
    assert block_things(SIDES, POSES + 1, COLORS, [7, 8])[0].shapes is one.shapes


def test_the_blocks_of_an_option_are_framed() -> None:
    def frames(command: Command) -> list[list[bool]]:
        things = block_things(SIDES, POSES, COLORS, [7, 8], command=command)
        return [
            [shape.dashed for shape in thing.shapes if isinstance(shape, Polygon) and shape.edge == "choice"]
            for thing in things
        ]

    assert frames(Command("put", (8, 7))) == [[True], [False]]
    assert frames(Command("move", (7, 8.0))) == [[False], []]
    assert frames(Command("done")) == [[], []]


@pytest.mark.parametrize(
    ("arrays", "message"),
    [
        ((SIDES[:, :1], POSES, COLORS), r"half_extents must contain finite numbers in shape \(2, 2\)"),
        ((SIDES, POSES[:1], COLORS), r"poses must contain finite numbers in shape \(2, 3\), got \(1, 3\)"),
        ((SIDES, POSES * np.nan, COLORS), "poses must contain finite numbers"),
    ],
)
def test_blocks_are_checked(arrays: Any, message: str) -> None:
    with pytest.raises(InputError, match=message):
        block_things(*arrays)
    with pytest.raises(InputError, match="ids must name all 2 blocks, got 1"):
        block_things(SIDES, POSES, COLORS, [3])


def test_options_are_told_in_words() -> None:
    colors = {3: (1.0, 0.0, 0.0), 1: (0.0, 0.0, 1.0)}

    assert option_words(Command("put", (3, 1)), colors) == (
        "put",
        " ",
        Chip("3", "#ff0000"),
        " on ",
        Chip("1", "#0000ff"),
    )
    assert plain(option_words(Command("move", (3, -3.456)), colors)) == "move 3 to \N{MINUS SIGN}3.5"
    assert plain(option_words(Command("done"), colors)) == "done"


def test_an_arch_is_marked_by_its_opening() -> None:
    sim = BlocksSimulation(np.random.default_rng(0))
    blocks = [Block(number, (4.0, 2.0), (0.5, 0.5, 0.5)) for number in range(3)]
    sim.place(blocks, [(-5.0, 4.0, np.pi / 2), (5.0, 4.0, np.pi / 2), (0.0, 10.0, 0.0)])
    sim.step(100)
    opening, area = marks_of(sim.state, arch())

    # Supports 4 wide with their centres 10 apart leave 6; they are 8 high.
    assert isinstance(opening, Polygon)
    np.testing.assert_allclose(opening.corners, [(-3, 0), (3, 0), (3, 8), (-3, 8)], atol=0.1)
    assert getattr(area, "words", "") == f"{arch().score(sim.state):.1f}"
    assert marks_of(sim.state, high_towers()) == ()


def test_stacks_are_marked_with_what_they_score() -> None:
    sim = BlocksSimulation(np.random.default_rng(0))
    colors = [(1.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 0.0), (1.0, 1.0, 1.0)]
    blocks = [Block(number, (2.0, 1.0), color) for number, color in enumerate(colors)]
    places = [(-20.0, 1.0), (-19.0, 3.1), (0.0, 1.0), (20.0, 1.0), (20.0, 3.1)]
    sim.place(blocks, [(x, y, 0.0) for x, y in places])
    red, one, grey, other = marks_of(sim.state, color_grouping("rgb"))

    # Equal colors score 1, the most different ones -1; the block between has no stack.
    assert isinstance(red, Line)
    assert isinstance(grey, Line)
    assert [(end[0][0], end[1][0]) for end in (red.points, grey.points)] == [(-22.0, -17.0), (18.0, 22.0)]
    assert [getattr(text, "words", "") for text in (one, other)] == ["1.00", "\N{MINUS SIGN}1.00"]


def test_an_empty_table_has_no_marks() -> None:
    empty = Cast.of([]).state(np.zeros((0, 3)), [])
    assert marks_of(empty, arch()) == marks_of(empty, color_grouping()) == ()


@pytest.mark.parametrize("env", envs(), ids=lambda env: env.task.name)
def test_what_is_recorded_is_what_happened(env: BlocksEnv) -> None:
    episode = recorded(env, seed=7)
    policy, root = make_policy("random", env), seed_sequence(7)
    rng = generator(stream(root, 0, 1))
    env.reset(seed=int(stream(root, 0, 0).generate_state(1)[0]))

    assert episode.scores[0] == env.moment.score
    for choice in episode.choices:
        position = policy.choose(env.decision(), rng)
        words, begin = env.say(position), env.simulation.time
        _, reward, _, _, info = env.step(env.decision().indices[position])

        assert (choice.words, choice.begin, choice.end) == (words, begin, env.simulation.time)
        assert choice.end - choice.begin == pytest.approx(info["duration"])
        assert choice.reward == reward
    assert episode.frames[-1] == env._frame()
    assert env.simulation.watch is None


def test_the_drop_is_part_of_the_episode() -> None:
    env = high_towers_env(n_blocks=3, max_actions=1)
    episode = recorded(env)
    begin = episode.choices[0].begin
    falling = [frame for frame in episode.frames if frame.time <= begin]

    def heights(frame: Frame) -> list[float]:
        return [thing.y for thing in frame.things if thing.key.startswith("block")]

    assert falling[0].time == 0.0
    assert (np.diff([frame.time for frame in episode.frames]) <= 0.0401).all()
    # Blocks begin in the air.
    assert np.mean(heights(falling[0])) > np.mean(heights(falling[-1])) + 3
    assert {frame.caption for frame in falling[:-1]} == {"drop"}
    assert falling[-1].caption == "high towers"
    assert [frame.score for frame in falling[:-1]] == [None] * (len(falling) - 1)


def test_what_is_held_has_a_grip() -> None:
    episode = recorded(high_towers_env(n_blocks=3, max_actions=2))
    first = episode.choices[0]
    during = [frame for frame in episode.frames if first.begin < frame.time < first.end]
    grips = ["grip" in {thing.key for thing in frame.things} for frame in during]

    assert (True in grips, grips[-1]) == (True, False)


def test_the_picture_shows_all_blocks() -> None:
    stage, things = table_stage(high_towers()), block_things(SIDES, [[-60, 2, 0], [3, 70, 0]], COLORS)
    left, right, low, high = stage.framed(things)

    assert (left, low, high) == (-69.0, -4.0, 79.0)
    assert right == 40.0
    assert paint(stage, Frame(0.0, things)).shape[2] == 3
