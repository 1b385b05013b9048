"""The tables behind the picture of what was learned in the corridor: values, errors and leaves over x."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import final

import numpy as np
from matplotlib.figure import Figure

from relforest.reports.corridor_figure import BellmanErrors, LeafBand, corridor_figure
from relforest.rl.bellman import look_ahead
from relforest.rl.rollout import Environment, world_of
from relforest.rl.rpi import SMRFRPI
from relforest.rl.samples import draw_samples
from relforest.rl.value import action_schemas, forest_features
from relforest.scenes import Scenes, Schema
from relforest.scenes.arrays import FloatArray
from relforest.trees import query

_N_X = 401


@final
@dataclass(frozen=True, slots=True, eq=False)
class Curves:
    """What an agent has learned in a world with one variable."""

    x: FloatArray  # (n_x,) values of the variable
    q_values: FloatArray  # (n_actions, n_x) value of each action type there
    bands: tuple[LeafBand, ...]  # the active leaf of each tree there
    errors: BellmanErrors  # of the last batch of training examples


def curves(agent: SMRFRPI) -> Curves:
    """Return what an agent learned in the corridor.

    It has learned for at least one iteration in a world with one object and one 1-D attribute from 0 to 1.
    """
    x = np.linspace(0.0, 1.0, _N_X)
    value = agent.value_
    grids = [_grid(x, schema) for schema in action_schemas(value.schema, value.action_types)]
    q_values = np.array([value.scene_values(number, grid) for number, grid in enumerate(grids)])
    bands = tuple(
        LeafBand(number, query(tree, grids[number]).leaf)
        for number, trees in enumerate(value.forests)
        for tree in trees
    )
    return Curves(x, q_values, bands, _errors(agent))


def q_function_picture(folder: Path, env: Environment) -> Figure:
    """Draw `q_function_figure` of the agent in a run folder, for a corridor."""
    return q_function_figure(SMRFRPI.load(folder, env))


def q_function_figure(agent: SMRFRPI) -> Figure:
    """Draw what an agent learned in the corridor: Q values, Bellman errors of the last batch, active leaves.

    References
    ----------
    Palmer (2015), Figure 7.1.
    """
    found, value, n = curves(agent), agent.value_, len(agent.experience_)
    title = f"iteration {n}, trees: {value.n_trees}, leaves: {value.n_leaves}"
    names = [action_type.name for action_type in value.action_types]
    return corridor_figure(found.x, found.q_values, names, found.errors, found.bands, title=title)


def _errors(agent: SMRFRPI) -> BellmanErrors:
    value, batch = agent.value_, agent.experience_[-1]
    samples = draw_samples(
        [batch],
        action_schemas(value.schema, value.action_types),
        discount=world_of(agent.env).discount,
        max_samples=1,
        bootstrap_on_truncation=agent.settings.bootstrap_on_truncation,
        seed=np.random.SeedSequence(0),
    )
    tables = [
        forest_features(trees, scenes, value.features)
        for trees, scenes in zip(value.forests, samples.scenes, strict=True)
    ]
    errors = look_ahead(tables, value.weights, samples.latest).errors
    return BellmanErrors(batch.matrix[batch.objects[batch.states], 0], samples.latest.types, errors)


def _grid(x: FloatArray, schema: Schema) -> Scenes:
    numbers = np.arange(len(x))
    arguments = np.empty((len(x), 0), dtype=np.int64)
    return Scenes(schema, x[:, None].copy(), numbers, numbers, np.ones(len(x), dtype=np.int64), arguments)
