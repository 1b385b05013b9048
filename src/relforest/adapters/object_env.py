"""Any Gymnasium environment whose state is a list of objects, as a world."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, final

import gymnasium
import numpy as np
from gymnasium import spaces
from numpy.typing import ArrayLike, NDArray

from relforest.scenes import Scenes, Schema
from relforest.smdp import ActionType, Decision
from relforest.support.errors import InputError
from relforest.support.options import at_least, in_range

Info = dict[str, Any]


@final
class ObjectEnv(gymnasium.Env[dict[str, Any], np.int64]):
    """A world (`relforest.smdp.World`) around an environment with discrete actions.

    Observations are padded arrays: one (slots, dim) for each attribute and ``mask`` (slots,). Rewards, ends
    and pictures are those of the environment. Every action takes a time of 1, unless the environment tells
    another ``info["duration"]``. All actions are available, unless it gives an ``info["action_mask"]``.

    Parameters
    ----------
    env : gymnasium.Env
        With a ``Discrete`` action space that begins at 0.
    schema : Schema
        Attributes of the objects.
    objects : callable
        Turns an observation of `env` into the objects that are present, (n, w) in the columns of the schema,
        NaN where an attribute is undefined. The first ones are bound to the parameters of every action.
    actions : sequence of str
        Name of each action of the space.
    slots : int
        Most objects of a state.
    parameters : sequence of str
        What the first objects of every state are for every action, such as ``("agent",)``.
    discount : float
        Above 0, at most 1.

    Raises
    ------
    InputError
        If an option is out of its range, the action space is another one, or the objects of a state have
        another shape, are too many, or too few to be bound.

    Examples
    --------
    >>> import relforest as rf
    >>> place = rf.Attribute("location", 2)
    >>> env = gymnasium.make("CartPole-v1")
    >>> schema, names = rf.Schema((place,)), ("left", "right")
    >>> world = ObjectEnv(env, schema, lambda seen: [seen[:2]], names, slots=1, parameters=("cart",))
    >>> _ = world.reset(seed=0)
    >>> world.decision().n_objects, len(world.decision())
    (1, 2)
    """

    def __init__(
        self,
        env: gymnasium.Env[Any, Any],
        schema: Schema,
        objects: Callable[[Any], ArrayLike],
        actions: Sequence[str],
        *,
        slots: int,
        parameters: Sequence[str] = (),
        discount: float = 0.95,
    ) -> None:
        space = env.action_space
        if not isinstance(space, spaces.Discrete) or space.start != 0 or space.n != len(actions):
            raise InputError(
                f"the environment must have a Discrete space of {len(actions)} actions from 0, one for each "
                f"name, got {space}"
            )
        self.env, self.schema, self.objects = env, schema, objects
        self.action_types = tuple(ActionType(name, tuple(parameters)) for name in actions)
        self.discount = in_range("discount", discount, 0.0, 1.0, open_low=True)
        self.slots = at_least("slots", slots, max(1, len(parameters)))
        self.metadata, self.render_mode = env.metadata, env.render_mode
        self.action_space: spaces.Discrete = spaces.Discrete(len(actions))
        self.observation_space = spaces.Dict(
            {
                each.name: spaces.Box(-np.inf, np.inf, (self.slots, each.dim), np.float64)
                for each in schema.attributes
            }
            | {"mask": spaces.MultiBinary(self.slots)}
        )
        self._decision: Decision | None = None

    def reset(
        self, *, seed: int | None = None, options: Mapping[str, Any] | None = None
    ) -> tuple[dict[str, Any], Info]:
        """Begin an episode; `options` are those of the environment."""
        super().reset(seed=seed)
        seen, info = self.env.reset(seed=seed, options=None if options is None else dict(options))
        return self._observed(seen, info)

    def step(self, action: Any) -> tuple[dict[str, Any], float, bool, bool, Info]:  # noqa: ANN401 - the base class's
        """Take an action of the space."""
        seen, reward, terminated, truncated, info = self.env.step(int(action))
        observation, info = self._observed(seen, {"duration": 1.0} | info)
        return observation, float(reward), bool(terminated), bool(truncated), info

    def decision(self) -> Decision:
        """Return the objects and the available ground actions of the present state."""
        if self._decision is None:
            raise InputError("no episode has begun: call reset() first")
        return self._decision

    def render(self) -> Any:  # noqa: ANN401 - whatever the environment renders
        """Return what the environment renders."""
        return self.env.render()

    def close(self) -> None:
        """Close the environment."""
        self.env.close()

    def _observed(self, seen: Any, info: Info) -> tuple[dict[str, Any], Info]:  # noqa: ANN401 - any observation
        rows = self._rows(seen)
        mask = np.asarray(info.get("action_mask", np.ones(len(self.action_types))), dtype=np.int8)
        available, arity = np.flatnonzero(mask), self.action_types[0].arity
        arguments = np.tile(np.arange(arity), (len(available), 1))
        self._decision = Decision(rows, available, arguments, available)
        scene = Scenes(self.schema, rows, np.arange(len(rows)), np.zeros(1, np.int64), np.array([len(rows)]))
        padded = np.zeros((self.slots, rows.shape[1]))
        padded[: len(rows)] = np.nan_to_num(rows)
        observation: dict[str, Any] = {
            each.name: padded[:, self.schema.columns(each.name)].copy() for each in self.schema.attributes
        }
        observation["mask"] = (np.arange(self.slots) < len(rows)).astype(np.int8)
        return observation, {**info, "scene": scene, "action_mask": mask}

    def _rows(self, seen: Any) -> NDArray[np.float64]:  # noqa: ANN401 - any observation
        rows = np.array(self.objects(seen), dtype=np.float64)
        least, most, width = self.action_types[0].arity, self.slots, self.schema.width
        if rows.ndim != 2 or rows.shape[1] != width or not least <= len(rows) <= most:
            raise InputError(
                f"objects must return {least} to {most} objects in rows of {width} numbers, got an array of "
                f"the shape {rows.shape}: raise slots=, or leave objects out"
            )
        return rows
