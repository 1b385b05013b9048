"""Policies to compare with, by name: random ones and hand-made ones.

All follow the protocol of learned policies: ``choose(decision, rng)`` returns a position in the decision.
Those that need more than the objects of the decision keep a reference to the world.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final, Protocol, final, runtime_checkable

import numpy as np

from relforest.smdp import Decision
from relforest.support.errors import InputError
from relforest.support.options import in_range, one_of
from relforest.worlds.blocks.arch_policies import CarefulPolicy, TrainerPolicy
from relforest.worlds.blocks.color_policy import ColorPolicy
from relforest.worlds.blocks.state import BlocksState
from relforest.worlds.blocks.tasks import Task
from relforest.worlds.blocks.tower_policy import TowerPolicy


class BlocksWorld(Protocol):
    """The part of a world that policies use."""

    @property
    def task(self) -> Task:
        """The task."""
        ...

    @property
    def state(self) -> BlocksState:
        """The blocks at present."""
        ...

    def offer_move(self, block: int, x: float) -> int:
        """Return the position of a move, which the decision offers from now on."""
        ...


@runtime_checkable
class Policy(Protocol):
    """Chooses actions, and signals when it would rather do nothing."""

    def choose(self, decision: Decision, rng: np.random.Generator) -> int:
        """Return the position of an action in `decision`, which offers at least one."""
        ...

    def is_finished(self, decision: Decision) -> bool:
        """Return whether the policy has finished, so that the caller may end the episode.

        These tasks do not have an action that does nothing. A policy that must act takes the action that
        changes least.
        """
        ...


@final
@dataclass(frozen=True, slots=True)
class RandomPolicy:
    """Choose an action type with given probabilities, then uniformly among its ground actions.

    Types without an available action are left out.

    Raises
    ------
    InputError
        If a weight is not a finite number above 0, or there are fewer than action types.

    References
    ----------
    Palmer (2015), section 7.4.1.
    """

    weights: tuple[float, ...]  # one per action type, above 0; they need not sum to 1

    def __post_init__(self) -> None:
        if not isinstance(self.weights, tuple):
            raise InputError(f"weights must be a tuple with one number per action type, got {self.weights!r}")
        for weight in self.weights:
            in_range("a weight", weight, 0.0, math.inf, open_low=True, open_high=True)

    def choose(self, decision: Decision, rng: np.random.Generator) -> int:
        """Return a random position; consumes one number and one integer from `rng`."""
        decision.check_offers()
        types = np.flatnonzero(np.bincount(decision.types))
        if types[-1] >= len(self.weights):
            raise InputError(f"weights must have one number per action type, got {len(self.weights)}")
        weights = np.array(self.weights)[types]
        # What `rng.choice` does, without its checks.
        shares = np.cumsum(weights / weights.sum())
        chosen = types[np.searchsorted(shares / shares[-1], rng.random(), side="right")]
        positions = np.flatnonzero(decision.types == chosen)
        return int(positions[rng.integers(len(positions))])

    def is_finished(self, decision: Decision) -> bool:  # noqa: ARG002 - the protocol's
        """Return False."""
        return False


def _random(world: BlocksWorld) -> Policy:
    return RandomPolicy(world.task.exploration)


def _trainer(world: BlocksWorld) -> Policy:
    return TrainerPolicy(world, RandomPolicy(world.task.exploration))


POLICIES: Final[Mapping[str, Mapping[str, Callable[[BlocksWorld], Policy]]]] = MappingProxyType(
    {
        "high-towers": MappingProxyType(
            {
                "random": _random,
                "large-first": lambda _: TowerPolicy("large"),
                "small-first": lambda _: TowerPolicy("small"),
            }
        ),
        "color-grouping": MappingProxyType({"random": _random, "manual": lambda _: ColorPolicy()}),
        "arch": MappingProxyType({"random": _random, "careful": CarefulPolicy, "trainer": _trainer}),
    }
)
"""Name of a task -> name of a policy -> function that creates it for a world."""


def make_policy(name: str, world: BlocksWorld) -> Policy:
    """Return a policy for a world of blocks.

    Parameters
    ----------
    name : str
        ``"random"``, or ``"large-first"`` and ``"small-first"`` for high towers, ``"manual"`` for color
        grouping, ``"careful"`` and ``"trainer"`` for the arch.
    world : BlocksWorld
        The ``unwrapped`` environment that the policy will act in.

    Raises
    ------
    InputError
        If the policy is unknown (the message lists those of the task), or the environment is still wrapped.

    Examples
    --------
    >>> import gymnasium
    >>> env = gymnasium.make("relforest/Arch-v0")
    >>> policy = make_policy("careful", env.unwrapped)
    """
    if not hasattr(world, "task"):
        raise InputError(f"a policy needs the world itself, not {type(world).__name__}: pass env.unwrapped")
    choices = POLICIES[world.task.name]
    return choices[one_of(f"policy for {world.task.name}", name, tuple(choices))](world)
