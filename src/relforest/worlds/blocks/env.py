"""The Gymnasium environment of the tasks of the blocks world."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, Literal, final

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from relforest.playing.frames import Frame, Stage
from relforest.playing.shapes import Shape, Words
from relforest.smdp import Decision
from relforest.support.errors import InputError
from relforest.support.options import between, in_range, one_of
from relforest.worlds.arguments import RENDER_MODES
from relforest.worlds.blocks.arm import OptionResult
from relforest.worlds.blocks.command import Command, run_command
from relforest.worlds.blocks.frames import (
    block_chip,
    block_things,
    grip,
    marks_of,
    mean_line,
    option_words,
    table_stage,
    target_of,
)
from relforest.worlds.blocks.handling import Handling
from relforest.worlds.blocks.moment import Moment, Observer, observation_space
from relforest.worlds.blocks.policies import POLICIES
from relforest.worlds.blocks.samplers import nearby_targets
from relforest.worlds.blocks.scene import SCHEMA, locations
from relforest.worlds.blocks.simulation import STEPS_PER_SECOND, BlocksSimulation
from relforest.worlds.blocks.state import BlocksState
from relforest.worlds.blocks.tasks import (
    ARCH_SIZE,
    DISCOUNT,
    DONE,
    MAX_ACTIONS,
    MOST_ACTIONS,
    MOVE,
    SIDES,
    Task,
    arch,
    color_grouping,
    high_towers,
)
from relforest.worlds.environment import Arrays, Info, Policies, Step, WorldEnv
from relforest.worlds.viewing import viewable

_HANDLING = Handling()
_NOTHING = OptionResult(0.0, 0, 0, grasped=False)


@final
class BlocksEnv(WorldEnv):
    """Blocks are dropped on a table; a robot lifts, turns and drops them, one option per step.

    An episode begins with the blocks at rest and is truncated after ``max_actions`` actions. It terminates
    with the action ``done``, or, in tasks without it, when no block is left to act on. A block that falls off
    the table is gone for the rest of the episode. Without a seed, `reset` continues the numbering of blocks.

    Observation: one slot per block, in the order in which they were dropped, then one per possible target of
    a move, each with ``location`` (2,) in world units, ``extent`` (2,) half sizes, ``orientation`` (1,) in
    radians, ``color`` (3,) and ``mask``; see `relforest.worlds.blocks.scene`. Targets only have a location;
    their undefined attributes are 0 here and NaN in scenes.

    Actions: see `relforest.worlds.blocks.actions`. An unavailable action does nothing, takes no time, and
    counts as an action. `perform` takes actions by name, with ids and any target.

    Time, including ``info["duration"]``, is in simulated seconds. The reward of an action is earned in its
    last primitive step of 0.01 s. ``info["discounted_reward"]`` discounts it as in Palmer (2015), section
    2.1, r = sum of gamma^i r_i over the steps i = 0 to D - 1 of an option: from the beginning of that last
    step, gamma**(duration - 0.01).

    In addition to the entries that `relforest.smdp` requires, ``info`` contains

    - the score of the present state: ``mean_height``, ``grouping_score``, or ``arch_score``, which rates the
      arch even though only ``done`` is rewarded;
    - ``option``, after a step: how the option went, an `OptionResult`.

    Parameters
    ----------
    task : Task
        The actions and the rewards.
    render_mode : {"rgb_array"}, optional
        Whether `render` returns pictures.
    n_blocks : int
        Blocks of an episode, 1 to the limit of the task (100; arch: 25).
    max_actions : int
        Actions per episode, 1 to 1000.
    handling : Handling
        How the robot handles blocks.

    Raises
    ------
    InputError
        If an option is out of range, an action does not exist, a seed is invalid, or a reset has options.
    gymnasium.error.ResetNeeded
        On any use before the first `reset`, and on a step after the end of an episode.

    References
    ----------
    Palmer (2015), section 7.4.

    Examples
    --------
    >>> import gymnasium
    >>> env = gymnasium.make("relforest/HighTowers-v0")
    >>> observation, info = env.reset(seed=0)
    >>> action = env.action_space.sample(info["action_mask"])
    >>> observation, reward, terminated, truncated, info = env.step(action)
    """

    metadata: dict[str, Any] = {"render_modes": list(RENDER_MODES), "render_fps": 2}  # noqa: RUF012 - Gymnasium's type
    schema = SCHEMA
    discount = DISCOUNT
    unit = "action"

    def __init__(
        self,
        task: Task,
        render_mode: str | None = None,
        *,
        n_blocks: int,
        max_actions: int = MAX_ACTIONS,
        handling: Handling = _HANDLING,
    ) -> None:
        super().__init__(render_mode)
        if not isinstance(task, Task):
            raise InputError(f"task must be a Task, such as high_towers(), got {task!r}")
        self.task = task
        self.action_types = task.action_types
        self.n_blocks = between("n_blocks", n_blocks, 1, task.most_blocks)
        self.max_actions = between("max_actions", max_actions, 1, MOST_ACTIONS)
        if not isinstance(handling, Handling):
            raise InputError(f"handling must be a Handling, such as Handling(), got {handling!r}")
        self._handling = handling
        self._watcher = Observer(task, self.n_blocks)
        self.observation_space = observation_space(self._watcher.n_slots)
        self.action_space = spaces.Discrete(self._watcher.n_actions)
        self._simulation: BlocksSimulation
        self._moment: Moment
        self._taken = 0
        self._last: Command | None = None
        self._reward = 0.0
        self._runs = False
        self._marks: tuple[float, tuple[Shape, ...]] = (0.0, ())

    @property
    def simulation(self) -> BlocksSimulation:
        """The simulation of the blocks, for inspection; only actions may change it."""
        self._check_begun()
        return self._simulation

    @property
    def moment(self) -> Moment:
        """What the agent sees at present."""
        self._check_begun()
        return self._moment

    @property
    def state(self) -> BlocksState:
        """The blocks at present."""
        return self.moment.state

    def perform(self, name: str, *arguments: float) -> Step:
        """Take an action by name, like `step`: ``perform("move", 17, -3.5)`` moves block 17 to x = -3.5.

        Parameters
        ----------
        name : str
            One of the task's action types.
        *arguments
            Ids of blocks; for the target of a move, any x in world units, even if it is not a candidate.
        """
        self.check_running()
        one_of("action", name, [action_type.name for action_type in self.task.action_types])
        command = Command(name, arguments)
        self._watch_simulation()
        before, self._last, self._runs = self._last, command, True
        try:
            result = run_command(self.simulation, command, self._handling)
        except InputError:
            self._last = before
            raise
        finally:
            self._runs = False
        step = self._stepped(command, result)
        self._show()
        return step

    def command(self, position: int) -> Command:
        """Return the action at a position of the present `decision`, in the form that `perform` takes."""
        decision = self.moment.decision
        action = decision.action(position)
        name = self.task.action_types[action.type].name
        ids = self.state.ids
        if name != MOVE.name:
            return Command(name, tuple(int(ids[row]) for row in action.arguments))
        block, target = action.arguments
        return Command(name, (int(ids[block]), float(locations(decision.objects)[target, 0])))

    def decision(self) -> Decision:
        """Return the objects and the available ground actions of the present state."""
        return self.moment.decision

    def refine(self, positions: NDArray[np.int64]) -> Decision:
        """Return the decision with more targets near those of some moves, see `relforest.smdp.RefiningWorld`.

        They are those of `relforest.worlds.blocks.samplers.nearby_targets`, as long as slots are free; other
        actions have none.
        """
        decision, x = self.moment.decision, locations(self.moment.decision.objects)[:, 0].tolist()
        moves: list[tuple[int, float]] = []
        for position in positions:
            action = decision.action(int(position))
            if self.task.action_types[action.type] == MOVE:
                block, target = action.arguments
                others = [x[other] for other in range(len(self.state)) if other != block]
                moves += [(block, near) for near in nearby_targets(x[target], others)]
        self._moment = self._watcher.with_moves(self._moment, moves, n_kept=1)
        return self._moment.decision

    def offer_move(self, block: int, x: float) -> int:
        """Return the position of a move in the decision, which from now on offers it if it did not before.

        Parameters
        ----------
        block : int
            Position of the block in the state.
        x : float
            Where to, world units; finite.

        Raises
        ------
        InputError
            If there is no such block or place, the task has no moves, or all slots for targets are taken.
        """
        between("block", block, 0, len(self.state) - 1)
        in_range("x", x, -math.inf, math.inf, open_low=True, open_high=True)
        moment = self._watcher.with_moves(self.moment, [(block, x)])
        position = self._watcher.move(moment, block, x)
        if position is None:
            raise InputError(f"a move of block {block} to {x:g} cannot be offered in {self.task.name}")
        self._moment = moment
        return position

    @property
    def policies(self) -> Policies:
        """The policies made for the task."""
        return {name: make(self) for name, make in POLICIES[self.task.name].items()}

    @property
    def stage(self) -> Stage:
        """The table."""
        return table_stage(self.task)

    def say(self, position: int) -> Words:
        """Return an action in words, such as "put 3 on 1"."""
        colors = dict(zip(self.state.ids.tolist(), self.state.colors.tolist(), strict=True))
        return option_words(self.command(position), colors)

    def named(self, position: int) -> tuple[str, Words] | None:
        """Return the key of the thing that an object is, and its name: the id of a block."""
        if position >= len(self.state):
            return None  # a place
        block = int(self.state.ids[position])
        return f"block {block}", (block_chip(block, self.state.colors[position].tolist()),)

    def _begin(self, seed: int | None, options: Mapping[str, Any]) -> tuple[Arrays, Info]:  # noqa: ARG002 - the hook's
        if seed is not None or not self._begun:
            self._simulation = BlocksSimulation(self.np_random)
        self._last, self._runs, self._taken = None, True, 0
        self._watch_simulation()
        self._simulation.rng = self.np_random
        blocks = self.task.blocks(self.np_random, self.n_blocks, self._simulation.next_id)
        self._simulation.drop(blocks, turned=self.task.turned)
        self._watcher.begin(np.array([block.id for block in blocks]))
        self._runs = False
        self._look()
        return self._moment.observation(), self._info()

    def _act(self, action: int) -> Step:
        # An action that is unavailable does nothing and counts.
        position = np.flatnonzero(self._moment.decision.indices == action)
        if not len(position):
            return self._stepped(None, _NOTHING)
        command = self.command(int(position[0]))
        return self.perform(command.name, *command.arguments)

    def _ended(self) -> int | None:
        over = not len(self._moment.decision) or self._taken >= self.max_actions
        return self._taken if over else None

    def _watch_simulation(self) -> None:
        self._simulation.watch = self._watching

    def _frame(self) -> Frame:
        simulation, state, runs = self._simulation, self._simulation.state, self._runs
        blocks = (state.half_extents, simulation.poses, state.colors, state.ids.tolist())
        things = block_things(*blocks, command=self._last if runs else None)
        if self.task.name == "high-towers" and len(state):
            things = (*things, mean_line(float(state.poses[:, 1].mean())))
        if simulation.tool is not None and (simulation.held is not None or not runs):
            things = (*things, grip(simulation.tool))
        if not runs:
            self._marks = simulation.time, marks_of(state, self.task)
        since, marks = self._marks
        # What the last score was based on is shown for another second.
        notes = marks if simulation.time - since < 1.0 else ()
        if runs and self._last is not None:
            notes = (*notes, *target_of(self._last))
        falls = runs and self._last is None
        return Frame(
            time=simulation.time,
            things=things,
            notes=() if falls else notes,
            caption="drop" if falls else self._caption(),
            score=None if falls else self._moment.score,
            band="" if self._last is None else ("wood", "edge")[(self._taken - (not runs)) % 2],
        )

    def _caption(self) -> str:
        if self._runs:
            return str(self._last)
        if not self._taken:
            return self.task.name.replace("-", " ")
        done = "unavailable action" if self._last is None else str(self._last)
        earned = f"{self._reward:+.2f}".replace("-", "\N{MINUS SIGN}")
        return f"{done}: {earned if abs(self._reward) >= 0.005 else '0.00'}"

    def _look(self, *, ended: bool = False) -> None:
        self._moment = self._watcher.look(self._simulation.state, self.max_actions - self._taken, ended=ended)

    def _info(self) -> Info:
        return self._moment.info() | {self.task.score_name: self._moment.score}

    def _stepped(self, command: Command | None, result: OptionResult) -> Step:
        before, name = self._moment.score, "" if command is None else command.name
        self._taken += 1
        self._look(ended=name == DONE.name)
        terminated = not len(self._moment.decision)
        truncated = not terminated and self._taken >= self.max_actions
        reward = self.task.reward(name, before, self._moment.score, is_last=terminated or truncated)
        self._last, self._reward = command, reward
        info = self._info()
        info["duration"], info["option"] = result.duration, result
        info["discounted_reward"] = reward * self.discount ** (max(result.steps - 1, 0) / STEPS_PER_SECOND)
        return self._moment.observation(), reward, terminated, truncated, info


def high_towers_env(
    render_mode: str | None = None,
    *,
    sides: tuple[float, float] = SIDES,
    n_blocks: int = 5,
    max_actions: int = MAX_ACTIONS,
    handling: Handling = _HANDLING,
) -> BlocksEnv:
    """Return the environment of `tasks.high_towers`; for the other parameters see `BlocksEnv`."""
    task = high_towers(sides)
    return BlocksEnv(task, render_mode, n_blocks=n_blocks, max_actions=max_actions, handling=handling)


def color_grouping_env(
    render_mode: str | None = None,
    *,
    distance: str = "ciede2000",
    sides: tuple[float, float] = SIDES,
    n_blocks: int = 5,
    max_actions: int = MAX_ACTIONS,
    handling: Handling = _HANDLING,
) -> BlocksEnv:
    """Return the environment of `tasks.color_grouping`; for the other parameters see `BlocksEnv`."""
    task = color_grouping(distance, sides)
    return BlocksEnv(task, render_mode, n_blocks=n_blocks, max_actions=max_actions, handling=handling)


def arch_env(
    render_mode: str | None = None,
    *,
    sampler: str = "test",
    pays: Literal["done", "end"] = "done",
    size: tuple[float, float] = ARCH_SIZE,
    n_blocks: int = 3,
    max_actions: int = MAX_ACTIONS,
    handling: Handling = _HANDLING,
) -> BlocksEnv:
    """Return the environment of `tasks.arch`; for the other parameters see `BlocksEnv`."""
    task = arch(sampler, size, pays)
    return BlocksEnv(task, render_mode, n_blocks=n_blocks, max_actions=max_actions, handling=handling)


make_high_towers = viewable(high_towers_env)
make_color_grouping = viewable(color_grouping_env)
make_arch = viewable(arch_env)
"""The entry points for ``gymnasium.make``."""
