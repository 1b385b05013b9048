from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from matplotlib.figure import Figure

from relforest.experiments.corridor_picture import curves, q_function_figure
from relforest.experiments.tasks import task_named
from relforest.rl.rpi import SMRFRPI
from relforest.trees import query
from relforest.worlds.corridor.scene import scene
from relforest.worlds.corridor.state import CorridorState


@pytest.fixture(scope="module")
def agent() -> SMRFRPI:
    return SMRFRPI(task_named("corridor").make(), random_state=0).learn(1, 6, test_episodes=1)


def values_at(agent: SMRFRPI, x: float) -> list[float]:
    """Return the values that policies act on."""
    env: Any = agent.env.unwrapped
    env.reset(options={"x": x})
    return list(agent.value_.values(env.decision()))


def test_the_curves_are_the_values_that_the_agent_acts_on(agent: SMRFRPI) -> None:
    found = curves(agent)

    for place in (0, 120, 260, 400):
        expected = values_at(agent, float(found.x[place]))
        np.testing.assert_allclose(found.q_values[:, place], expected, rtol=1e-12)


def test_the_bands_are_the_deciding_leaves_of_every_tree(agent: SMRFRPI) -> None:
    found = curves(agent)
    trees = [
        (action_type, tree) for action_type, forest in enumerate(agent.value_.forests) for tree in forest
    ]

    assert [band.action for band in found.bands] == [action_type for action_type, _ in trees]
    for band, (_, tree) in zip(found.bands, trees, strict=True):
        for place in (0, 200, 399):
            state = CorridorState(float(found.x[place]))
            assert band.leaves[place] == query(tree, scene(state)).leaf[0]


def test_every_training_example_has_its_bellman_error(agent: SMRFRPI) -> None:
    found = curves(agent).errors
    (batch,) = agent.experience_

    assert len(found.errors) == len(batch)
    for number in (0, 9, len(batch) - 1):
        before, after = (
            float(batch.matrix[batch.objects[states[number]], 0])
            for states in (batch.states, batch.next_states)
        )
        action_type = int(batch.types[batch.actions[number]])
        # r + 0.9 max Q(s', a') - Q(s, a); the limit of 10 steps is no end, so it counts as well.
        error = (
            batch.rewards[number] + 0.9 * max(values_at(agent, after)) - values_at(agent, before)[action_type]
        )
        assert found.x[number] == before
        assert found.actions[number] == action_type
        assert found.errors[number] == pytest.approx(error)


def test_the_figure_shows_curves_and_bands(agent: SMRFRPI) -> None:
    figure = q_function_figure(agent)

    assert isinstance(figure, Figure)
    assert len(figure.axes) == 2
