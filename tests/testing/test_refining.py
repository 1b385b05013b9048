from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from gymnasium import spaces

from relforest.scenes.arrays import IntArray
from relforest.smdp import Decision
from relforest.testing import check_world, refining
from relforest.worlds.blocks.env import BlocksEnv, arch_env
from relforest.worlds.blocks.samplers import Targets
from rl.small_worlds import Proposing

Refine = Callable[[IntArray], Decision]


def arch(change: Callable[[BlocksEnv, Refine], Refine]) -> Callable[[], BlocksEnv]:
    """Make arches of two blocks whose `refine` is changed."""

    def make() -> BlocksEnv:
        env: Any = arch_env(n_blocks=2)
        env.refine = change(env, env.refine)
        return env  # type: ignore[no-any-return]

    return make


def forgets(env: BlocksEnv, refine: Refine) -> Refine:
    """Return a `refine` that says what it would add, but does not offer it."""

    def changed(positions: IntArray) -> Decision:
        before = env._moment
        found = refine(positions)
        env._moment = before
        return found

    return changed


def outside(env: BlocksEnv, refine: Refine) -> Refine:
    """Return a `refine` that adds a place at infinity."""
    del env

    def changed(positions: IntArray) -> Decision:
        found = refine(positions)
        if not len(positions):
            return found
        objects = found.objects.copy()
        objects[-1, 0] = np.inf
        return replace(found, objects=objects)

    return changed


def hasty(env: BlocksEnv, refine: Refine) -> Refine:
    """Return a `refine` that adds something although it is asked about nothing."""

    def changed(positions: IntArray) -> Decision:
        return refine(positions if len(positions) else np.flatnonzero(env.decision().types == 1))

    return changed


def moody(env: BlocksEnv, refine: Refine) -> Refine:
    """Return a `refine` that answers differently in another world."""
    number = next(_NUMBERS)

    def changed(positions: IntArray) -> Decision:
        return refine(positions[number % 2 :])

    del env
    return changed


_NUMBERS = iter(range(10**6))


def test_a_world_that_only_appends_passes() -> None:
    check_world(lambda: arch_env(n_blocks=2), steps=2)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (forgets, r"decision\(\) must return what refine\(\) returned"),
        (outside, r"refine\(\) must add finite places"),
        (hasty, "asked about no action, it must change nothing"),
        (moody, "two runs with seed 0 differ after the same questions"),
    ],
)
def test_violations_name_the_clause(change: Callable[[BlocksEnv, Refine], Refine], message: str) -> None:
    with pytest.raises(AssertionError, match=f"^refine: {message}"):
        check_world(arch(change), steps=2)


def test_a_place_is_not_offered_twice(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Targets, "place", lambda *_: None)
    with pytest.raises(AssertionError, match=r"^refine: action \d+ aims at a place that is offered already"):
        check_world(lambda: arch_env(n_blocks=2), steps=2)


def test_a_world_must_come_to_an_end(monkeypatch: pytest.MonkeyPatch) -> None:
    world: Any = Proposing(2)
    monkeypatch.setattr(Proposing, "EXTRA", 10**6)
    monkeypatch.setattr(refining, "MOST_QUESTIONS", 10)
    world.action_space = spaces.Discrete(10**6)
    with pytest.raises(
        AssertionError, match=r"^refine: after 10 questions, it still adds actions: limit them"
    ):
        refining.ask(world, 0)
    world.action_space = spaces.Discrete(6)
    with pytest.raises(AssertionError, match=r"^refine: indices must be in Discrete\(6\), got"):
        refining.ask(world, 0)
