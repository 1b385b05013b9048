from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from relforest.smdp import Decision, Decisions
from relforest.support.errors import InputError
from relforest.worlds.keepaway.decisions.scene import decision, objects
from relforest.worlds.keepaway.decisions.variables import by_distance, n_variables, state_variables
from relforest.worlds.keepaway.decisions.vectors import ActionObjects, ActionVariables

Floats = NDArray[np.float64]

PLAYERS = [(3.0, 4.0), (3.0, -4.0), (-9.0, 4.0), (3.0, 0.0), (0.0, 4.0)]


def asked(players: Any, keepers: int, actor: int = 0) -> Decision:
    """Return what a keeper must decide among players at (x, y)."""
    places = np.array(players, dtype=np.float64)
    matrix, receivers = objects(keepers, len(places) - keepers), np.empty(keepers - 1, dtype=np.int64)
    matrix[:, :2] = places
    by_distance(places, actor, 0, receivers)
    return decision(matrix, actor, receivers)


def test_variables_seen_from_the_receiver_by_hand() -> None:
    # The numbers of `test_variables.py`; keeper 2 is the second nearest teammate.
    found = ActionVariables(3, 2).vectors(Decisions.of([asked(PLAYERS, 3)]))
    far = math.sqrt(97.0)
    hold = [0.0, 5.0, 8.0, 12.0, 3.0, 4.0, 5.0, far, 4.0, 3.0, 4.0, 9.0, 0.0, 0.0]
    second = [1.0, 5.0, 12.0, 8.0, 3.0, 4.0, far, 5.0, 4.0, 3.0, 9.0, 4.0, 0.0, 0.0]
    assert found == pytest.approx(np.array([hold, [1.0, *hold[1:]], second]), abs=1e-12)


def test_the_receiver_comes_first_wherever_teammates_are_listed() -> None:
    rng, keepers, takers = np.random.default_rng(0), 4, 3
    states = [asked(rng.uniform(-10, 10, (keepers + takers, 2)), keepers, actor) for actor in (0, 3, 1)]
    found = ActionVariables(keepers, takers).vectors(Decisions.of(states))
    expected = []
    for state in states:
        places, actor = state.objects[:, :2].copy(), state.arguments[0, 0]
        variables = np.empty(n_variables(keepers, takers))
        state_variables(places, places[actor], keepers, variables)
        parts = np.split(variables, [1, 4, 7, 10, 13, 16])
        expected.append([0.0, *variables])
        for rank in range(keepers - 1):
            order = [rank, *(i for i in range(keepers - 1) if i != rank)]
            turned = [part[order] if i in (1, 3, 5, 6) else part for i, part in enumerate(parts)]
            expected.append([1.0, *np.concatenate(turned)])
    np.testing.assert_array_equal(found, expected)


def test_players_as_rows_by_hand() -> None:
    shape = ActionObjects(3, 2)
    found = shape.vectors(Decisions.of([asked(PLAYERS, 3)])).reshape(3, shape.n_rows, -1)
    holder: list[float] = [1, 1, 0, 1, 0.3, 0.4, 0, 0]
    first, second = [1.0, 0, 0, 1, 0.3, -0.4, 0, -0.8], [1.0, 0, 0, 1, -0.9, 0.4, -1.2, 0]
    takers: list[list[float]] = [[1, 0, 0, 0, 0.0, 0.4, -0.3, 0], [1, 0, 0, 0, 0.3, 0.0, 0, -0.4]]
    nobody = [0.0] * 8
    np.testing.assert_allclose(found[0], [holder, nobody, first, second, *takers], atol=1e-12)
    receives = [1.0, 0, 1, *second[3:]]
    np.testing.assert_allclose(found[2], [holder, receives, first, nobody, *takers], atol=1e-12)


@pytest.mark.parametrize("vector_map", [ActionVariables(3, 2), ActionObjects(3, 2)])
def test_other_numbers_of_players_are_refused(vector_map: ActionVariables | ActionObjects) -> None:
    larger = asked([*PLAYERS, (1.0, 1.0), (2.0, 2.0)], 4)
    with pytest.raises(InputError, match="learned with 5 players, not 7"):
        vector_map.vectors(Decisions.of([larger]))
    nothing = Decision(larger.objects[:5], larger.types[:0], larger.arguments[:0], larger.indices[:0])
    assert vector_map.vectors(Decisions.of([nothing])).shape == (0, vector_map.width)
