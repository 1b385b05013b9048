from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from reference.blocks import plain_engine
from relforest.support.errors import InputError
from relforest.worlds.blocks.arm import OptionResult
from relforest.worlds.blocks.blocks import Block, arch_blocks, random_blocks
from relforest.worlds.blocks.handling import Handling, Noise
from relforest.worlds.blocks.options import done, isolate, move, put, rotate
from relforest.worlds.blocks.simulation import BlocksSimulation

GREY = (0.5, 0.5, 0.5)
EXACT = Handling(Noise.none())


def table(*boxes: tuple[float, float, float, float], seed: int = 0, **options: Any) -> BlocksSimulation:
    """Return boxes (half width, half height, x, y) at rest; ids count from 0."""
    sim = BlocksSimulation(np.random.default_rng(seed), **options)
    blocks = [Block(i, box[:2], GREY) for i, box in enumerate(boxes)]
    sim.place(blocks, [(x, y, 0.0) for _, _, x, y in boxes])
    sim.wait_for_rest()
    return sim


def two() -> BlocksSimulation:
    return table((2.0, 1.0, -10.0, 1.02), (2.0, 1.0, 10.0, 1.02))


def is_upright(sim: BlocksSimulation, block: int) -> bool:
    return abs(math.sin(sim.pose(block)[2])) > math.sqrt(0.5)


def test_put_without_noise_puts_the_block_in_the_middle() -> None:
    sim = two()
    result = put(sim, 0, 1, handling=EXACT)

    assert sim.pose(0)[:2] == pytest.approx((10.0, 3.02), abs=0.05)
    assert sim.contacts == {(0, 1)}
    assert sim.held is None
    assert sim.at_rest
    assert result.grasped
    assert result.timeouts == 0
    assert result.duration == pytest.approx(result.steps / 100)
    assert 3.0 < result.duration < 6.0


def poses_while_held(sim: BlocksSimulation) -> list[tuple[float, float, float]]:
    """Return what will be filled with x, y and angle of block 0 in all steps in which it is held."""
    poses: list[tuple[float, float, float]] = []
    sim.watch, sim.frame_every = lambda: poses.append(sim.pose(0)) if sim.held == 0 else None, 1
    return poses


def test_put_lifts_the_block_above_all_and_lets_it_go_above_the_target() -> None:
    sim = two()
    poses = poses_while_held(sim)
    put(sim, 0, 1, handling=EXACT)
    held = np.array(poses)

    # Its own top is at 2.01, its lowest point at 0.01: 2.01 + 5 above the table, and its centre 1 higher.
    assert held[:, 1].max() == pytest.approx(8.02, abs=0.05)
    # Let go 2 above the other's top at 2.01; the centre is 1 higher.
    assert held[-1] == pytest.approx([10.0, 5.02, 0.0], abs=0.05)


def test_put_counts_what_lies_on_the_target() -> None:
    sim = table((2.0, 1.0, -10.0, 1.02), (2.0, 1.0, 10.0, 1.02), (2.0, 1.0, 10.0, 3.04))
    put(sim, 0, 1, handling=EXACT)

    assert sim.pose(0)[:2] == pytest.approx((10.0, 5.04), abs=0.06)
    assert sim.contacts == {(0, 2), (1, 2)}


@pytest.mark.parametrize(("overlap", "hits"), [("original", True), ("interval", False)])
def test_the_original_overlap_misses_a_wide_block(overlap: Any, *, hits: bool) -> None:
    # Block 1 stands at x = -8 beside a post. The beam on both is wider than block 0 on both sides, and its
    # centre is not above it: the original test lowers block 0 into the beam.
    sim = table((0.5, 0.5, -30.0, 0.52), (0.5, 1.0, -6.0, 1.02), (1.5, 1.0, 5.0, 1.02), (9.0, 0.5, 2.0, 2.55))
    top = sim.bounds[3, 3]
    poses = poses_while_held(sim)
    put(sim, 0, 1, handling=Handling(Noise.none(), overlap))
    lowest = min(y for x, y, _ in poses if x > -7)

    assert (lowest < top + 1.5) == hits


def test_blocks_that_lie_on_the_moved_one_come_along_or_fall() -> None:
    sim = table((2.0, 1.0, -10.0, 1.02), (2.0, 1.0, 10.0, 1.02), (2.0, 1.0, -10.0, 3.04))
    put(sim, 0, 1)

    assert len(sim.blocks) == 3
    assert sim.pose(0)[0] == pytest.approx(10.0, abs=6.0)


def test_move_goes_to_a_place() -> None:
    sim = two()
    result = move(sim, 0, 23.0, handling=EXACT)

    assert sim.pose(0)[:2] == pytest.approx((23.0, 1.01), abs=0.05)
    assert sim.pose(1)[0] == pytest.approx(10.0, abs=0.01)
    assert result.grasped


@pytest.mark.parametrize("angle", [0.0, 0.2, -0.2, math.pi / 2, -math.pi / 2, math.pi, 1.4, -1.7, 3.0])
def test_rotate_lays_down_and_sets_up(angle: float) -> None:
    sim = BlocksSimulation(np.random.default_rng(0))
    sim.place(arch_blocks(sim.rng, 1), [(0.0, 5.0, angle)])
    sim.wait_for_rest()
    upright = is_upright(sim, 0)
    result = rotate(sim, 0, handling=EXACT)

    assert is_upright(sim, 0) != upright
    assert result.grasped


@pytest.mark.parametrize(
    ("angle", "end", "height"),
    [
        # Lying: the end of its own x axis that is up is held, and 2 * 4 above where the centre was is enough.
        (0.0, math.pi / 2, 2.01 + 8),
        (math.pi, -math.pi / 2, 2.01 + 8),
        # Upright: the end of its own y axis that is on the right is held, and 2 * 2 is enough.
        (math.pi / 2, math.pi, 4.01 + 4),
        (-math.pi / 2, 0.0, 4.01 + 4),
    ],
)
def test_rotate_lifts_the_block_by_one_end(angle: float, end: float, height: float) -> None:
    sim = BlocksSimulation(np.random.default_rng(0))
    sim.place(arch_blocks(sim.rng, 1), [(0.0, 5.0, angle)])
    sim.wait_for_rest()
    poses = poses_while_held(sim)
    rotate(sim, 0, handling=EXACT)
    heights = [y for _, y, _ in poses]

    assert math.remainder(sim.pose(0)[2] - end, 2 * math.pi) == pytest.approx(0.0, abs=0.02)
    assert max(heights) == pytest.approx(height, abs=0.05)


def test_rotate_works_from_any_number_of_turns() -> None:
    sim = BlocksSimulation(np.random.default_rng(0))
    sim.place(arch_blocks(sim.rng, 1), [(0.0, 2.02, 10 * math.pi)])
    sim.wait_for_rest()
    rotate(sim, 0, handling=EXACT)

    assert is_upright(sim, 0)


def test_isolate_leaves_a_free_block_alone() -> None:
    sim = two()
    before = sim.poses
    results = [isolate(sim, 0) for _ in range(200)]
    durations = np.array([result.duration for result in results])

    # Gaussian with mean 1 and deviation 0.2, rounded up to steps, and a step more: 1.015 in the mean.
    assert durations.mean() == pytest.approx(1.015, abs=0.05)
    assert durations.std() == pytest.approx(0.2, abs=0.03)
    assert durations.min() >= 0.5
    assert not any(result.grasped for result in results)
    assert sim.poses == pytest.approx(before, abs=1e-3)


def test_isolate_uses_the_widest_gap() -> None:
    # Block 0 (4 wide) lies on block 1. Gaps: -18 to -2 (16) and 2 to 13 (11); it needs 4 + 2 * 2.
    sim = table((2.0, 1.0, 0.0, 3.04), (2.0, 1.0, 0.0, 1.02), (2.0, 1.0, -20.0, 1.02), (2.0, 1.0, 15.0, 1.02))
    isolate(sim, 0, handling=EXACT)

    assert sim.pose(0)[:2] == pytest.approx((-10.0, 1.01), abs=0.05)


@pytest.mark.parametrize(("shift", "x"), [(1.0, -9.0), (-1.0, 9.0)])
def test_isolate_goes_beyond_all_if_no_gap_is_wide_enough(shift: float, x: float) -> None:
    # The others reach from -4.1 to 4.1, plus the shift: 3.1 is nearer the middle than 5.1. Then 4 and half
    # its width farther.
    sim = table((2.0, 1.0, shift, 3.04), (2.0, 1.0, shift - 2.1, 1.02), (2.0, 1.0, shift + 2.1, 1.02))
    isolate(sim, 0, handling=EXACT)

    assert sim.pose(0)[:2] == pytest.approx((x, 1.01), abs=0.2)


def test_done_only_waits() -> None:
    sim = two()
    before, time = sim.poses, sim.time
    result = done(sim)

    assert sim.time - time == pytest.approx(result.duration)
    assert 0.5 <= result.duration < 2.0
    assert (result.timeouts, result.grasped) == (0, False)
    assert sim.poses == pytest.approx(before, abs=1e-3)


def test_puts_take_as_long_and_succeed_as_often_as_in_the_source() -> None:
    # Author's simulator: 8.98 s (deviation 2.84, n=315), 0.82 on or above the other block.
    durations, successes = [], []
    for seed in range(60):
        sim = BlocksSimulation(np.random.default_rng(seed))
        sim.drop(random_blocks(sim.rng, 5))
        durations.append(put(sim, 0, 1).duration)
        (left, right, low, _), (other_left, other_right, other_low, _) = sim.bounds[:2]
        successes.append(left <= other_right and right >= other_left and low > other_low)

    assert np.mean(durations) == pytest.approx(8.98, rel=0.15)
    assert np.mean(successes) == pytest.approx(0.82, abs=0.13)


def test_stages_end_after_500_steps() -> None:
    # A block as heavy as three of the largest cannot be lifted: 2500 / (2 * 100 * 3) < 10.
    sim = table((10.0, 7.5, 0.0, 7.52), (1.0, 1.0, 30.0, 1.02))
    result = put(sim, 0, 1, handling=EXACT)

    assert result.timeouts >= 2
    assert 1000 < result.steps <= 2002


def test_a_grasp_that_never_succeeds_ends() -> None:
    sim = two()
    before = sim.poses
    result = put(sim, 0, 1, handling=Handling(Noise(grasp=1e9)))

    # 500 steps of grasping; nothing is held, so one step until all rest, and one to notice.
    assert result == OptionResult(duration=5.02, steps=502, timeouts=1, grasped=False)
    assert sim.poses == pytest.approx(before, abs=1e-3)


@pytest.mark.parametrize("noise", [Noise(carry=1e6), Noise(carry=1e300)])
def test_goals_that_are_too_far_are_given_up(noise: Noise) -> None:
    sim = two()
    result = put(sim, 0, 1, handling=Handling(noise))

    assert result.grasped
    assert result.steps < 500
    assert sim.pose(0)[0] == pytest.approx(-10.0, abs=1.0)


def test_a_block_that_is_carried_beyond_the_table_is_lost() -> None:
    sim = two()
    result = move(sim, 0, 115.0, handling=EXACT)

    assert [block.id for block in sim.blocks] == [1]
    assert result.grasped
    assert result.steps < 2000
    with pytest.raises(InputError, match="block 0 is not on the table"):
        rotate(sim, 0)


@pytest.mark.parametrize("x", [1e4, -1e300])
def test_far_places_are_given_up(x: float) -> None:
    sim = two()
    move(sim, 0, x, handling=EXACT)

    assert sim.pose(0)[0] == pytest.approx(-10.0, abs=1.0)


@pytest.mark.parametrize("x", [math.nan, math.inf, -math.inf, "left", None])
def test_places_are_finite_numbers(x: Any) -> None:
    sim = two()
    with pytest.raises(InputError, match="x must be a finite number"):
        move(sim, 0, x)

    assert sim.held is None


@pytest.mark.parametrize(
    ("option", "message"),
    [
        (lambda sim: put(sim, 0, 9), "block 9 is not on the table"),
        (lambda sim: put(sim, 9, 0), "block 9 is not on the table"),
        (lambda sim: put(sim, 1, 1), "on itself"),
        (lambda sim: rotate(sim, -1), "block -1 is not on the table"),
        (lambda sim: isolate(sim, 9), "block 9 is not on the table"),
        (lambda sim: move(sim, 9, 0.0), "block 9 is not on the table"),
    ],
)
def test_options_refuse_what_they_cannot_do(
    option: Callable[[BlocksSimulation], object], message: str
) -> None:
    sim = two()
    before, time = sim.poses, sim.time
    with pytest.raises(InputError, match=message):
        option(sim)

    assert sim.time == time
    assert sim.poses.tobytes() == before.tobytes()
    assert sim.held is None


def test_the_target_may_fall_off_the_table_meanwhile() -> None:
    # Block 1 stands beyond the edge and falls while block 0 is lifted; that is then lowered where it is.
    sim = BlocksSimulation(np.random.default_rng(0), table_half_width=20.0)
    sim.place([Block(i, (1.0, 1.0), GREY) for i in range(2)], [(0.0, 1.02, 0.0), (25.0, 1.0, 0.0)])
    result = put(sim, 0, 1, handling=EXACT)

    assert [block.id for block in sim.blocks] == [0]
    assert result.grasped
    assert sim.pose(0)[:2] == pytest.approx((0.0, 1.01), abs=0.05)


def test_the_block_may_fall_off_the_table_while_it_is_grasped_for() -> None:
    sim = BlocksSimulation(np.random.default_rng(0), table_half_width=20.0)
    sim.place([Block(i, (1.0, 1.0), GREY) for i in range(2)], [(25.0, 4.0, 0.0), (0.0, 1.02, 0.0)])
    result = put(sim, 0, 1, handling=Handling(Noise(grasp=1e9)))

    assert [block.id for block in sim.blocks] == [1]
    assert not result.grasped
    assert result.timeouts == 0
    assert result.steps < 500


class TestTwin:
    """Whole episodes are the same on the plain engine, bit for bit."""

    @staticmethod
    def episode(seed: int, half_width: float) -> list[object]:
        sim = BlocksSimulation(np.random.default_rng(seed), table_half_width=half_width)
        sim.drop(random_blocks(sim.rng, 5))
        seen: list[object] = []
        for _ in range(4):
            ids = [block.id for block in sim.blocks]
            if len(ids) < 2:
                break
            a, b = sim.rng.permutation(ids)[:2].tolist()
            choices = (
                lambda a=a, b=b: put(sim, a, b),
                lambda a=a: rotate(sim, a),
                lambda a=a: isolate(sim, a),
                lambda a=a: move(sim, a, sim.rng.uniform(-40, 40)),
            )
            seen += [choices[sim.rng.integers(4)](), sim.poses.tobytes(), sim.bounds.tobytes(), sim.contacts]
        return seen

    @pytest.mark.parametrize("seed", range(4))
    def test_episodes_agree(self, seed: int) -> None:
        with plain_engine():
            plain = self.episode(seed, 100.0)

        assert self.episode(seed, 100.0) == plain

    @pytest.mark.parametrize("seed", range(3))
    def test_episodes_on_a_small_table_agree(self, seed: int) -> None:
        with plain_engine():
            plain = self.episode(seed, 22.0)

        assert self.episode(seed, 22.0) == plain


@given(
    seed=st.integers(0, 2**32),
    sd=st.floats(0.0, 30.0),
    half_width=st.floats(5.0, 40.0),
    overlap=st.sampled_from(["original", "interval"]),
)
@settings(max_examples=15, deadline=None)
def test_nothing_is_ever_undefined_or_endless(seed: int, sd: float, half_width: float, overlap: Any) -> None:
    sim = BlocksSimulation(np.random.default_rng(seed), table_half_width=half_width)
    sim.drop(random_blocks(sim.rng, 4))
    handling = Handling(Noise(grasp=sd, carry=sd, rotate=sd), overlap)
    for turn in range(3):
        ids = [block.id for block in sim.blocks]
        if len(ids) < 2:
            break
        for result in (
            put(sim, ids[0], ids[-1], handling=handling) if turn != 1 else done(sim),
            *(isolate(sim, block, handling=handling) for block in ids[1:2] if block in sim),
        ):
            assert 0 < result.steps <= 5 * 500 + 1
        assert np.isfinite(sim.poses).all()
        assert sim.held is None
