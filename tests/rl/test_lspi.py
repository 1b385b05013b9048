from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest

from relforest.rl.lspi import LSPIResult, lspi
from relforest.rl.lstdq import LSTDQ
from relforest.rl.settings import LSPISettings
from relforest.scenes.arrays import FloatArray
from relforest.support.errors import InputError
from rl.linear_problems import Problem, four_states, random_problem, transitions_of

LIMIT = 1e5


def learned(
    problem: Problem, weights: Sequence[FloatArray], settings: LSPISettings | None = None
) -> LSPIResult:
    return lspi(LSTDQ.of(*problem, LIMIT), weights, settings)


ZERO = (np.zeros(4), np.zeros(4))


def test_the_best_policy_of_four_states() -> None:
    problem = four_states()
    result = learned(problem, ZERO)
    # To stay in the middle pays 1 for ever, 1 / (1 - 0.9) = 10; a step that misses it pays 0.9 * 10.
    np.testing.assert_allclose(result.weights[0], [9.0, 9.0, 10.0, 10.0], atol=1e-9)
    np.testing.assert_allclose(result.weights[1], [10.0, 10.0, 9.0, 9.0], atol=1e-9)
    np.testing.assert_allclose(result.lookahead.errors, 0.0, atol=1e-9)
    assert result.reason == "converged"
    assert result.n_features == 8


def test_beginning_with_the_result_takes_one_iteration() -> None:
    problem = four_states()
    first = learned(problem, ZERO)
    again = learned(problem, first.weights)
    assert again.iterations == 1
    np.testing.assert_array_equal(again.weights, first.weights)


def alternating() -> Problem:
    """One feature, value 1 in the observed pair; two next pairs with the values 3 and -1; discount 1/2.

    A positive weight prefers 3, and then A = 1 - 1.5 and w = -2. A negative weight prefers -1, and then
    A = 1 + 0.5 and w = 2/3. So the two policies follow each other for ever.
    """
    features = np.array([[1.0], [3.0], [-1.0]])
    return Problem((features,), transitions_of([((0, 0), 1.0, 0.5, [(0, 1), (0, 2)])]))


def test_policies_that_alternate_end_with_the_smaller_residual() -> None:
    problem = alternating()
    result = learned(problem, [np.zeros(1)])
    # w = -2: 1 + 0.5 * 2 + 2 = 4. w = 2/3: 1 + 0.5 * 2 - 2/3 = 4/3.
    assert result.reason == "cycle"
    assert result.iterations == 2
    assert result.weights[0] == pytest.approx([2 / 3])
    assert result.lookahead.errors == pytest.approx([4 / 3])


@pytest.mark.parametrize("start", [1.0, -1.0])
def test_the_end_of_a_cycle_does_not_depend_on_its_beginning(start: float) -> None:
    problem = alternating()
    result = learned(problem, [np.array([start])])
    assert result.weights[0] == pytest.approx([2 / 3])


def test_too_few_iterations_are_said() -> None:
    problem = alternating()
    settings = LSPISettings(max_iterations=1)
    result = learned(problem, [np.zeros(1)], settings)
    assert (result.reason, result.iterations) == ("limit", 1)
    assert result.weights[0] == pytest.approx([-2.0])


def test_a_small_change_of_the_weights_ends_it() -> None:
    problem = alternating()
    settings = LSPISettings(epsilon=3.0)
    # From 0 to -2 is less than 3.
    result = learned(problem, [np.zeros(1)], settings)
    assert (result.reason, result.iterations) == ("converged", 1)


@pytest.mark.parametrize("seed", range(5))
def test_a_converged_policy_is_greedy_for_its_own_values(seed: int) -> None:
    problem = random_problem(np.random.default_rng(seed))
    start = [np.zeros(table.shape[1]) for table in problem.features]
    result = learned(problem, start)
    again = learned(problem, result.weights)
    if result.reason == "converged":
        np.testing.assert_allclose(
            np.concatenate(again.weights), np.concatenate(result.weights), rtol=1e-9, atol=1e-12
        )
    else:
        assert again.lookahead.squared_error == pytest.approx(result.lookahead.squared_error)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"epsilon": 0.0}, "epsilon of LSPI must be a finite number above 0"),
        ({"max_iterations": 0}, "max_iterations of LSPI must be an integer of at least 1"),
        ({"max_condition": 1.0}, "max_condition of LSPI must be a finite number above 1"),
    ],
)
def test_options_are_checked(options: dict[str, float], message: str) -> None:
    with pytest.raises(InputError, match=message):
        LSPISettings(**options)  # type: ignore[arg-type]
