from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from relforest.rl.baselines import DenseFeatures, SarsaSettings, make_team
from relforest.support.errors import InputError


def one_state(n_actions: int) -> DenseFeatures[int]:
    return DenseFeatures(lambda _: np.eye(n_actions), n_actions, n_active=1)


@pytest.mark.parametrize(("shared", "expected"), [(False, [2.0, 2.0]), (True, [3.0, 3.0])])
def test_a_team_learns_alone_or_together(*, shared: bool, expected: list[float]) -> None:
    settings = SarsaSettings(alpha=0.5)
    first, second = make_team(one_state(1), 2, settings, shared=shared, random_state=0)
    first.start(0)
    second.start(0)
    second.end(4.0)  # error 4: 2
    first.end(4.0)  # error 4 - 0: 2 if alone; 4 - 2, so 2 + 1 if together
    assert [first.values(0)[0], second.values(0)[0]] == expected
    assert (first.weights is second.weights) == shared


def test_the_agents_of_a_team_have_random_streams_of_their_own() -> None:
    first, second = make_team(one_state(2), 2, random_state=0)
    assert [first.start(0) for _ in range(30)] != [second.start(0) for _ in range(30)]


@pytest.mark.parametrize("n_agents", [0, 1.0, None])
def test_a_team_needs_agents(n_agents: Any) -> None:
    with pytest.raises(InputError, match="n_agents must be an integer of at least 1"):
        make_team(one_state(1), n_agents)


def test_shared_is_a_plain_choice() -> None:
    with pytest.raises(InputError, match="shared must be True or False"):
        make_team(one_state(1), 2, shared="hive")  # type: ignore[arg-type]
