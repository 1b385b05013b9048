"""Plays episodes of a world and records what there is to see."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Final, NamedTuple, Protocol, SupportsFloat, final, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike

from relforest.playing.frames import Frame, Naming, Shown, Stage
from relforest.playing.reasons import Explanation, Reason, Reasoning
from relforest.playing.shapes import Words, plain
from relforest.smdp import Decision, World
from relforest.support.errors import InputError
from relforest.support.options import between
from relforest.support.progress import report
from relforest.support.rng import RandomState, generator, seed_sequence, stream

MOST_EPISODES: Final = 1000
"""Episodes in one call."""

MOST_THINGS: Final = 2_000_000
"""Things in all frames together: more than 8 hours of keepaway, about 1 GB of memory."""

MOST_LISTED: Final = 50
"""Actions of which a recorded choice tells the values."""
MOST_UNVALUED: Final = 8
"""Actions that a recorded choice tells without values."""


class Policy(Protocol):
    """Decides; `Valuing`, `Reasoning` and `Finishing` are what it may do beside that."""

    def choose(self, decision: Decision, rng: np.random.Generator) -> int:
        """Return the position of an action in `decision`, which offers at least one."""
        ...


@runtime_checkable
class Valuing(Protocol):
    """Tells what it thinks of the actions; that is recorded."""

    def values(self, decision: Decision) -> ArrayLike:
        """Return the value of each available action, (n_actions,), NaN = unknown."""
        ...


@runtime_checkable
class Finishing(Protocol):
    """Says when it would rather do nothing; the episode then ends."""

    def is_finished(self, decision: Decision) -> bool:
        """Return whether the policy has finished."""
        ...


class Playable(Protocol):
    """The part of a Gymnasium environment that is used to play."""

    @property
    def unwrapped(self) -> object:
        """The world, which is `Shown`."""
        ...

    def reset(self, *, seed: int | None = None) -> tuple[Any, dict[str, Any]]:
        """Begin an episode."""
        ...

    def step(self, action: Any, /) -> tuple[Any, SupportsFloat, bool, bool, dict[str, Any]]:  # noqa: ANN401 - Gymnasium's
        """Take an action."""
        ...


class Why(NamedTuple):
    """An `Explanation` of which what it names can be found in the frames."""

    rival: Words
    """The best of the other actions."""
    explanation: Explanation
    witnesses: tuple[tuple[tuple[str, str, Words], ...], ...]
    """For each reason the variables, keys of things and names of the objects that satisfy it best."""

    def words(self, number: int) -> tuple[Words, Words]:
        """Return a reason, and how it is in this state."""
        reason = self.explanation.reasons[number]
        clauses: list[Words] = [("if ", *self.rival)] if reason.of_rival else []
        clauses += [(reason.standing,)] if reason.standing else []
        clauses += [
            (f"{variable} is " if variable else "it is ", *name)
            for variable, _, name in self.witnesses[number]
        ]
        clauses += [("if ", *self.rival, f": {reason.compared}")] if reason.compared else []
        apart = (part for clause in clauses for part in ("; ", *clause))
        return (reason.says,), tuple(apart)[1:]

    def __str__(self) -> str:
        """Return the lead over the rival, and the strongest reasons for the action and against it."""
        lead, reasons = self.explanation.lead, self.explanation.reasons
        parts = [f"worth {abs(lead):.2f} {'more' if lead >= 0.0 else 'less'} than {plain(self.rival)}"]
        for what, sign in (("for it", 1.0), ("against it", -1.0)):
            number = next((i for i, each in enumerate(reasons) if each.adds * sign > 0.0), None)
            if number is not None:
                says, stands = map(plain, self.words(number))
                parts.append(f"{what}: {says}{f' ({stands})' if stands else ''} {reasons[number].adds:+.2f}")
        return "; ".join(parts)


@final
@dataclass(frozen=True, slots=True)
class Choice:
    """A decision, and what came of it.

    Parameters
    ----------
    begin, end : float
        Seconds since the episode began.
    words : sequence
        What was chosen.
    reward : float
    options : tuple of words
        The actions to choose from, or the most valuable of many.
    chosen : int
        Position among the options.
    values : tuple of float, optional
        What the policy thinks of them, NaN = unknown.
    why : Why, optional
        What spoke for the choice and against it, if that was asked for.
    """

    begin: float
    end: float
    words: Words
    reward: float
    options: tuple[Words, ...]
    chosen: int
    values: tuple[float, ...] | None
    why: Why | None = None


@final
@dataclass(frozen=True, slots=True, eq=False)
class Recording:
    """An episode.

    Parameters
    ----------
    stage : Stage
    frames : tuple of Frame
        In the order of their times, which differ; at least one.
    choices : tuple of Choice
        In order.
    end : str
        How it ended, if the world says so in ``info["end"]``.
    before : float
        Reward before the first decision, ``info["reward_before"]``.

    Raises
    ------
    InputError
        If there is no frame, or times do not increase.
    """

    stage: Stage
    frames: tuple[Frame, ...]
    choices: tuple[Choice, ...]
    end: str = ""
    before: float = 0.0

    def __post_init__(self) -> None:
        times = np.array([frame.time for frame in self.frames])
        if not len(times) or not np.isfinite(times).all() or (np.diff(times) <= 0).any():
            raise InputError("an episode needs frames at finite, increasing times, and at least one")

    @property
    def duration(self) -> float:
        """Seconds of the episode."""
        return self.frames[-1].time

    @property
    def reward(self) -> float:
        """Sum of all rewards, undiscounted, with that before the first decision."""
        return self.before + sum(choice.reward for choice in self.choices)

    @property
    def scores(self) -> tuple[float, ...]:
        """The scores of all states that have one, in order."""
        return tuple(frame.score for frame in self.frames if frame.score is not None)


def record_episodes(
    env: Playable, policy: Policy, episodes: int = 1, seed: RandomState = 0, *, explain: bool = False
) -> tuple[Recording, ...]:
    """Play episodes and record everything that can be seen.

    Parameters
    ----------
    env : gymnasium.Env
        Its ``unwrapped`` is a `relforest.smdp.World` that is `Shown`; wrappers are fine.
    policy : Policy
    episodes : int
        Number of episodes, 1 to 1000.
    seed : int, numpy.random.SeedSequence or Generator
        The same seed gives the same episodes. Each episode has two random streams, one for the world and one
        for the policy, as in `relforest.rl.rollout`.
    explain : bool
        Whether a policy that is `Reasoning` is asked why.

    Returns
    -------
    tuple of Recording

    Raises
    ------
    InputError
        If the world gives no frames, ``episodes`` is out of range, the policy returns a position or values
        that do not fit, or there are more than `MOST_THINGS` to record.
    """
    world = env.unwrapped
    if not isinstance(world, World) or not isinstance(world, Shown):
        raise InputError(
            f"{type(world).__name__} cannot be shown: a world needs stage, watch() and say(), "
            "see relforest.playing.Shown"
        )
    episodes, root = between("episodes", episodes, 1, MOST_EPISODES), seed_sequence(seed)
    recordings: list[Recording] = []
    watcher = _Watcher()
    world.watch(watcher.see)
    try:
        for episode in range(episodes):
            report("playing episodes", episode, episodes)
            _, info = env.reset(seed=int(stream(root, episode, 0).generate_state(1)[0]))
            reasoning = policy if explain and isinstance(policy, Reasoning) else None
            rng = generator(stream(root, episode, 1))
            choices, end = _play(env, world, (policy, reasoning), watcher, rng)
            before = float(info.get("reward_before", 0.0))
            recordings.append(Recording(world.stage, watcher.taken(), choices, end, before))
    finally:
        world.watch(None)
    return tuple(recordings)


class _ShownWorld(World, Shown, Protocol):
    """A world that can be looked at."""


def _play(
    env: Playable,
    world: _ShownWorld,
    policies: tuple[Policy, Reasoning | None],
    watcher: _Watcher,
    rng: np.random.Generator,
) -> tuple[tuple[Choice, ...], str]:
    policy, reasoning = policies
    choices: list[Choice] = []
    ended, info, decision = False, dict[str, Any](), world.decision()
    while not ended and len(decision):
        if isinstance(policy, Finishing) and policy.is_finished(decision):
            break
        position, begin = policy.choose(decision, rng), watcher.now
        # The policy may have asked for more actions, see `relforest.smdp.RefiningWorld`.
        decision = world.decision()
        decision.action(position)
        shown, values = _listed(policy, decision, int(position))
        options = tuple(world.say(number) for number in shown)
        explained = None if reasoning is None else reasoning.explain(decision, int(position))
        why = None if explained is None else _why(explained, world)
        _, reward, terminated, truncated, info = env.step(int(decision.indices[position]))
        chosen = shown.index(position)
        told = options[chosen], float(reward), options, chosen, values, why
        choices.append(Choice(begin, watcher.now, *told))
        ended, decision = terminated or truncated, world.decision()
    return tuple(choices), str(info.get("end", ""))


def _why(explained: Explanation, world: _ShownWorld) -> Why:
    """Return an explanation of the present decision with the names of what it is about."""

    def found(reason: Reason) -> tuple[tuple[str, str, Words], ...]:
        if not isinstance(world, Naming):
            return ()
        names = ((variable, world.named(position)) for variable, position in reason.witnesses)
        return tuple((variable, *name) for variable, name in names if name is not None)

    return Why(world.say(explained.rival), explained, tuple(map(found, explained.reasons)))


def _listed(policy: Policy, decision: Decision, position: int) -> tuple[list[int], tuple[float, ...] | None]:
    """Return the positions of the actions worth telling, and their values."""
    if not isinstance(policy, Valuing):
        return list(range(len(decision))) if len(decision) <= MOST_UNVALUED else [position], None
    values = np.asarray(policy.values(decision), dtype=np.float64)
    if values.shape != (len(decision),):
        raise InputError(
            f"values() must return one number for each of {len(decision)} actions, got {values.shape}"
        )
    # NaN is sorted to the end.
    best = np.argsort(-values, kind="stable")[:MOST_LISTED].tolist()
    shown = sorted(best if position in best else [*best[:-1], position])
    return shown, tuple(values[shown].tolist())


@final
class _Watcher:
    """Collects the frames of an episode."""

    def __init__(self) -> None:
        self._frames: list[Frame] = []
        self._left = MOST_THINGS

    @property
    def now(self) -> float:
        """The time of the latest frame."""
        return self._frames[-1].time if self._frames else math.nan

    def see(self, frame: Frame) -> None:
        """Take a frame; it replaces one of the same moment, and all of an episode that was begun anew."""
        while self._frames and frame.time <= self.now:
            self._left += len(self._frames.pop().things)
        self._left -= len(frame.things)
        if self._left < 0:
            raise InputError(
                f"the episodes together show more than {MOST_THINGS} things, the limit for recordings: "
                "choose fewer or shorter ones"
            )
        self._frames.append(frame)

    def taken(self) -> tuple[Frame, ...]:
        """Return all frames and begin anew."""
        frames, self._frames = tuple(self._frames), []
        return frames
