from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

import gymnasium
import numpy as np
import pytest

from relforest.smdp import Decision
from relforest.support.errors import InputError
from relforest.worlds import environment_id
from relforest.worlds.blocks.arch_policies import CarefulPolicy
from relforest.worlds.blocks.color_policy import ColorPolicy
from relforest.worlds.blocks.env import arch_env
from relforest.worlds.blocks.moment import Moment, Observer
from relforest.worlds.blocks.policies import POLICIES, Policy, RandomPolicy, make_policy
from relforest.worlds.blocks.state import BlocksState
from relforest.worlds.blocks.tasks import Task, arch, color_grouping, high_towers
from relforest.worlds.blocks.tower_policy import TowerPolicy
from worlds.blocks.staged_blocks import LONG, UPRIGHT, portal, row, staged

RED, PINK, BLUE, GREEN = (1.0, 0.0, 0.0), (1.0, 0.3, 0.3), (0.0, 0.0, 1.0), (0.0, 1.0, 0.0)


@dataclass(frozen=True)
class StagedWorld:
    task: Task
    state: BlocksState
    asked: list[tuple[int, float]] = field(default_factory=list)

    def decision(self) -> Decision:
        return self._look()[1].decision

    def offer_move(self, block: int, x: float) -> int:
        self.asked.append((block, x))
        watcher, moment = self._look()
        position = watcher.move(moment, block, x)
        assert position is not None
        return position

    def _look(self) -> tuple[Observer, Moment]:
        watcher = Observer(self.task, len(self.state))
        watcher.begin(self.state.ids)
        return watcher, watcher.with_moves(watcher.look(self.state, 5), self.asked)


def chosen(policy: Policy, world: StagedWorld, seed: int = 0) -> tuple[str, tuple[int, ...]]:
    world.asked.clear()
    position = policy.choose(world.decision(), np.random.default_rng(seed))
    action = world.decision().action(position)
    return world.task.action_types[action.type].name, action.arguments


def move_of(world: StagedWorld) -> tuple[int, float]:
    """Return what the careful policy moves: a block, and the x that it goes to."""
    name, (block, target) = chosen(CarefulPolicy(world), world)
    assert name == "move"
    return block, float(world.decision().objects[target, 0])


def towers(state: BlocksState) -> StagedWorld:
    return StagedWorld(high_towers(), state)


def grouping(state: BlocksState) -> StagedWorld:
    return StagedWorld(color_grouping(), state)


def arches(state: BlocksState) -> StagedWorld:
    return StagedWorld(arch("training"), state)


def test_the_random_policy_chooses_types_by_their_weights_and_objects_uniformly() -> None:
    world, rng = towers(row(-20.0, 0.0, 20.0)), np.random.default_rng(0)
    decision, policy = world.decision(), RandomPolicy((0.75, 0.25))
    counts = np.bincount([policy.choose(decision, rng) for _ in range(9000)], minlength=9)
    # 6 puts of 0.125 each, 3 rotations of 0.0833: standard deviations sqrt(9000 p (1 - p)) = 31.4 and 26.2.
    np.testing.assert_allclose(counts, [1125] * 6 + [750] * 3, atol=4 * 31.4)


def test_the_random_policy_leaves_out_what_is_not_available() -> None:
    world = towers(row(0.0))
    assert {chosen(RandomPolicy((0.75, 0.25)), world, seed)[0] for seed in range(20)} == {"rotate"}
    with pytest.raises(InputError, match="a weight must be a finite number above 0"):
        RandomPolicy((1.0, 0.0))


def test_towers_are_built_of_the_largest_or_of_the_smallest_block_next() -> None:
    # A stack of 0 and 1 (highest); outside, 2 is small and 3 large.
    state = staged(
        ((2, 2), (0, 2, 0)), ((1, 1), (0.5, 5, 0)), ((1, 1.5), (15, 1.5, 0)), ((3, 2), (-15, 2, 0))
    )
    assert chosen(TowerPolicy("large"), towers(state)) == ("put", (3, 1))
    assert chosen(TowerPolicy("small"), towers(state)) == ("put", (2, 1))
    assert not TowerPolicy("small").is_finished(towers(state).decision())


def test_blocks_beside_the_stack_belong_to_it() -> None:
    # 1 stands on 0 and hangs over 2, which it overlaps by half a unit.
    state = staged(((2, 2), (0, 2, 0)), ((3, 1), (0.5, 5, 0)), ((1, 1), (4, 1, 0)), ((1, 1), (20, 1, 0)))
    assert chosen(TowerPolicy("large"), towers(state)) == ("put", (3, 1))


def test_a_finished_tower_is_topped_again_with_what_is_its_top() -> None:
    state = staged(((2, 2), (0, 2, 0)), ((1, 1), (0, 7, 0)), ((1, 1), (0, 5, 0)))
    assert TowerPolicy("large").is_finished(towers(state).decision())
    assert chosen(TowerPolicy("large"), towers(state)) == ("put", (1, 2))
    assert chosen(TowerPolicy("small"), towers(row(0.0))) == ("rotate", (0,))


def test_a_tower_policy_takes_one_of_two_words() -> None:
    with pytest.raises(InputError, match="first must be one of 'large', 'small'"):
        TowerPolicy("medium")  # type: ignore[arg-type]


def test_what_does_not_match_its_group_is_isolated() -> None:
    # Red, pink and blue in one stack. Mean (0.667, 0.1, 0.433): pink is 0.41 away, red 0.56, blue 0.88.
    # From pink, red is 0.42 away and blue 1.26.
    state = row(0.0, 1.0, 2.0, 20.0, colors=[RED, BLUE, PINK, RED])
    assert chosen(ColorPolicy(), grouping(state)) == ("isolate", (1,))


def test_isolated_blocks_join_the_highest_block_of_the_group_they_match_best() -> None:
    # Green matches nothing; pink matches the reds at 0, of which 2 is the higher.
    state = staged(
        ((2, 2), (0, 2, 0)),
        ((2, 2), (20, 2, 0)),
        ((2, 2), (0, 6, 0)),
        ((2, 2), (-20, 2, 0)),
        colors=[RED, PINK, RED, GREEN],
    )
    assert chosen(ColorPolicy(), grouping(state)) == ("put", (1, 2))


def test_two_isolated_blocks_may_begin_a_group() -> None:
    state = row(-20.0, 0.0, 20.0, colors=[GREEN, RED, PINK])
    assert chosen(ColorPolicy(), grouping(state)) == ("put", (1, 2))


def test_when_colors_are_grouped_an_isolated_block_stays_isolated() -> None:
    # 2 overlaps no other block; 1 does not count as part of the stack of 0 and 3, but overlaps it.
    state = staged(
        ((3, 2), (0, 2, 0)),
        ((2, 2), (4.5, 2, 0)),
        ((2, 2), (-20, 2, 0)),
        ((2, 2), (0, 6, 0)),
        colors=[RED, GREEN, BLUE, RED],
    )
    policy = ColorPolicy()
    assert policy.is_finished(grouping(state).decision())
    assert chosen(policy, grouping(state)) == ("isolate", (2,))


def test_when_all_blocks_are_in_groups_a_top_is_put_where_it_is() -> None:
    state = staged(((2, 2), (0, 2, 0)), ((2, 2), (0, 10, 0)), ((2, 2), (0, 6, 0)), colors=[RED, RED, PINK])
    assert ColorPolicy().is_finished(grouping(state).decision())
    assert chosen(ColorPolicy(), grouping(state)) == ("put", (1, 2))


def test_the_careful_policy_rotates_then_spaces_then_tops_then_is_done() -> None:
    lying = staged((LONG, (-20, 2, 0)), (LONG, (0, 2, 0)), (LONG, (20, 2, 0)))
    assert chosen(CarefulPolicy(arches(lying)), arches(lying)) == ("rotate", (1,))
    half = staged((LONG, (-20, 2, 0)), (LONG, (0, 4, UPRIGHT)), (LONG, (20, 2, 0)))
    assert chosen(CarefulPolicy(arches(half)), arches(half)) == ("rotate", (2,))
    apart = staged((LONG, (-20, 2, 0)), (LONG, (0, 4, UPRIGHT)), (LONG, (20, 4, UPRIGHT)))
    # To 10 or from 0 to 10: supports ten apart.
    assert move_of(arches(apart)) == pytest.approx((1, 10.0))
    assert move_of(arches(portal(contacts=False))) == pytest.approx((2, 0.0))
    assert chosen(CarefulPolicy(arches(portal())), arches(portal())) == ("done", ())
    assert chosen(CarefulPolicy(arches(row(0.0))), arches(row(0.0))) == ("done", ())


def test_the_trainer_errs_as_often_as_it_should() -> None:
    lying = arches(staged((LONG, (-20, 2, 0)), (LONG, (0, 2, 0)), (LONG, (20, 2, 0))))
    trainer = make_policy("trainer", lying)
    choices = [chosen(trainer, lying, seed) for seed in range(2000)]
    # 0.9 * (0.5, 0.25) rotate the supports, and 0.9 * 0.25 move though they lie. At random, 0.1 of all:
    # rotate 0.225 / 3 each, done 0.1. Standard deviations up to sqrt(0.25 / 2000) = 0.0112.
    assert choices.count(("rotate", (1,))) / 2000 == pytest.approx(0.45 + 0.0075, abs=0.045)
    assert choices.count(("rotate", (2,))) / 2000 == pytest.approx(0.225 + 0.0075, abs=0.045)
    assert choices.count(("rotate", (0,))) / 2000 == pytest.approx(0.0075, abs=0.0075)
    built = arches(portal())
    ends = [chosen(make_policy("trainer", built), built, seed)[0] for seed in range(2000)]
    assert ends.count("done") / 2000 == pytest.approx(0.45 + 0.01, abs=0.045)


def test_the_trainer_asks_for_its_move_only_when_it_takes_it() -> None:
    # Supports that are 23 apart; the plan's move to 10 from each other is nowhere near a sampled target.
    world = arches(staged((LONG, (-20, 2, 0)), (LONG, (0, 4, UPRIGHT)), (LONG, (23, 4, 1.5))))
    offered = len(world.decision())
    trainer, names = make_policy("trainer", world), []
    for seed in range(200):
        name, arguments = chosen(trainer, world, seed)
        # 3 objects, and 15 targets of the training sampler: the plan's is the last object of all.
        assert bool(world.asked) == (name == "move" and arguments[1] == 18)
        assert len(world.decision()) == offered + bool(world.asked)
        names.append(name)
    assert {"move", "done", "rotate"} == set(names)


def test_all_policies_can_be_made_by_name() -> None:
    worlds = {"high-towers": towers(row(0.0, 9.0)), "color-grouping": grouping(row(0.0, 9.0))}
    worlds["arch"] = arches(portal())
    for task, makers in POLICIES.items():
        decision = worlds[task].decision()
        for name in makers:
            policy = make_policy(name, worlds[task])
            assert 0 <= policy.choose(decision, np.random.default_rng(0)) < len(decision)
            assert not policy.is_finished(decision)


def test_an_unknown_policy_is_an_error_that_lists_those_of_the_task() -> None:
    with pytest.raises(InputError, match="policy for arch must be one of 'random', 'careful', 'trainer'"):
        make_policy("large-first", arches(portal()))


def test_a_wrapped_environment_is_told_from_the_world_itself() -> None:
    wrapped: Any = gymnasium.make("relforest/HighTowers-v0")
    with pytest.raises(InputError, match=r"not OrderEnforcing: pass env\.unwrapped"):
        make_policy("random", wrapped)


@pytest.mark.parametrize("weights", [(0.5, math.nan), (math.inf, 1.0), (0.5, "1"), (True, 0.5)])
def test_weights_are_finite_numbers(weights: Any) -> None:
    with pytest.raises(InputError, match="a weight must be a finite number above 0, got"):
        RandomPolicy(weights)


def test_there_is_a_weight_for_each_action_type() -> None:
    env = arch_env()
    env.reset(seed=0)
    with pytest.raises(InputError, match="weights must have one number per action type, got 2"):
        RandomPolicy((0.5, 0.5)).choose(env.decision(), np.random.default_rng(0))
    weights: Any = 0.5
    with pytest.raises(InputError, match=r"weights must be a tuple .* got 0\.5"):
        RandomPolicy(weights)


@pytest.mark.parametrize("task", list(POLICIES))
def test_no_policy_chooses_when_there_is_nothing_to_choose(task: str) -> None:
    env: Any = gymnasium.make(environment_id(task)).unwrapped
    env.reset(seed=0)
    over = env.decision()
    none = Decision(over.objects, over.types[:0], over.arguments[:0], over.indices[:0], over.n_private)
    for name in POLICIES[task]:
        with pytest.raises(InputError, match="offers no action: the episode has ended, call reset"):
            make_policy(name, env).choose(none, np.random.default_rng(0))
