"""LSTDQ against hand-worked values and against Algorithm 2.1 written as the loop that is printed there."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from relforest.rl.bellman import look_ahead
from relforest.rl.lstdq import LSTDQ, well_conditioned
from relforest.rl.samples import Transitions
from relforest.scenes.arrays import FloatArray, IntArray
from rl.linear_problems import Problem, four_states, random_problem, transitions_of

LIMIT = 1e5


def printed_algorithm(problem: Problem, chosen: IntArray) -> tuple[FloatArray, FloatArray]:
    """A and b of Algorithm 2.1 with dense feature vectors over all action types."""
    widths = [table.shape[1] for table in problem.features]
    starts = np.cumsum([0, *widths])

    def phi(action_type: int, row: int) -> FloatArray:
        vector = np.zeros(sum(widths))
        vector[starts[action_type] : starts[action_type + 1]] = problem.features[action_type][row]
        return vector

    matrix, rewards = np.zeros((sum(widths), sum(widths))), np.zeros(sum(widths))
    moves = problem.transitions
    for i in range(len(moves)):
        here = phi(int(moves.types[i]), int(moves.rows[i]))
        following = np.zeros(sum(widths))
        if chosen[i] >= 0:
            following = phi(int(moves.next_types[chosen[i]]), int(moves.next_rows[chosen[i]]))
        matrix += np.outer(here, here - moves.discounts[i] * following)
        rewards += here * moves.rewards[i]
    return matrix, rewards


def evaluated(features: Sequence[FloatArray], transitions: Transitions, chosen: IntArray) -> LSTDQ:
    return LSTDQ.of(features, transitions, LIMIT).with_policy(chosen)


def test_two_states_by_hand() -> None:
    # State 0 leads to state 1 and pays nothing, state 1 to itself and pays 1; discount 1/2.
    # Q(1) = 1 + Q(1) / 2 = 2 and Q(0) = 0 + Q(1) / 2 = 1.
    transitions = transitions_of([((0, 0), 0.0, 0.5, [(0, 1)]), ((0, 1), 1.0, 0.5, [(0, 1)])])
    problem = evaluated([np.eye(2)], transitions, np.array([0, 1]))
    # A = I - 0.5 * [[0, 1], [0, 1]].
    assert problem.matrix.tolist() == [[1.0, -0.5], [0.0, 0.5]]
    (weights,) = problem.weights()
    assert weights == pytest.approx([1.0, 2.0], abs=1e-12)


def test_tabular_values_solve_the_bellman_equation_of_the_policy() -> None:
    problem = four_states()
    n = len(problem.transitions)
    always_left = 2 * np.arange(n)
    weights = evaluated(*problem, always_left).weights()
    # P Pi of section 2.1.2 for "always left", over pairs (left 0..3, right 0..3); Q = (I - 0.9 P Pi)^-1 R.
    successors = [0, 0, 1, 2, 1, 2, 3, 3]
    transition = np.zeros((8, 8))
    transition[np.arange(8), successors] = 1.0
    rewards = np.array([float(after in {1, 2}) for after in successors])
    closed_form = np.linalg.solve(np.eye(8) - 0.9 * transition, rewards)
    np.testing.assert_allclose(np.concatenate(weights), closed_form, atol=1e-12)
    # By hand: left stays in 0 for nothing, leads from 1 there, pays 1 in 2 on the way to 1, then 1 + 0.9 * 1.
    np.testing.assert_allclose(weights[0], [0.0, 0.0, 1.0, 1.9], atol=1e-12)


@pytest.mark.parametrize("seed", range(5))
def test_blocks_agree_with_the_printed_algorithm(seed: int) -> None:
    rng = np.random.default_rng(seed)
    problem = random_problem(rng)
    start: list[FloatArray] = [rng.normal(size=(table.shape[1],)) for table in problem.features]
    chosen = look_ahead(problem.features, start, problem.transitions).chosen
    matrix, rewards = printed_algorithm(problem, chosen)
    ours = evaluated(*problem, chosen)
    # Feature 2 of type 0 is 0 in all observed pairs: its row of A is 0, and it is cut out.
    used = [0, 1, 3, 4]
    assert not matrix[2].any()
    assert ours.n_features == 4
    np.testing.assert_allclose(ours.matrix, matrix[np.ix_(used, used)], atol=1e-12)
    expected = np.zeros(5)
    expected[used] = np.linalg.solve(matrix[np.ix_(used, used)], rewards[used])
    np.testing.assert_allclose(np.concatenate(ours.weights()), expected, rtol=1e-8)


@pytest.mark.parametrize("seed", range(5))
def test_more_features_and_other_policies_give_the_matrix_of_a_new_problem(seed: int) -> None:
    rng = np.random.default_rng(seed)
    features, transitions = random_problem(rng)
    starts, n = transitions.next_starts, np.diff(transitions.next_starts)

    def policy() -> IntArray:
        return np.where(n > 0, starts[:-1] + rng.integers(1_000_000, size=len(n)) % np.maximum(n, 1), -1)

    first, second = policy(), policy()
    wide = evaluated([features[0][:, :1], features[1]], transitions, first).extended(0, features[0][:, 1:])
    # The added feature comes last, after those of the other action type.
    order = [0, 2, 3, 1]
    for chosen in (first, second, first):
        wide, plain = wide.with_policy(chosen), evaluated(features, transitions, chosen)
        np.testing.assert_allclose(wide.matrix, plain.matrix[np.ix_(order, order)], atol=1e-10)
        for ours, theirs in zip(wide.weights(), plain.weights(), strict=True):
            np.testing.assert_allclose(ours, theirs, rtol=1e-6)
        seen = wide.look_ahead(wide.weights())
        expected = look_ahead(features, wide.weights(), transitions)
        np.testing.assert_array_equal(seen.chosen, expected.chosen)
        np.testing.assert_allclose(seen.errors, expected.errors, rtol=1e-9)


def test_an_action_type_never_taken_has_no_weights() -> None:
    transitions = transitions_of([((0, 0), 1.0, 0.5, [(1, 0)])])
    weights = evaluated([np.eye(1), np.eye(1)], transitions, np.array([0])).weights()
    assert [w.tolist() for w in weights] == [[1.0], [0.0]]


def test_no_features_at_all() -> None:
    transitions = transitions_of([((0, 0), 1.0, 0.0, [])])
    problem = evaluated([np.zeros((1, 2))], transitions, np.array([-1]))
    assert problem.n_features == 0
    assert problem.weights()[0].tolist() == [0.0, 0.0]


def test_a_singular_matrix_gets_the_constant_of_equation_3_6() -> None:
    # (3 - 1e5 * 0) / (1e5 - 1), and then the condition number is exactly the limit up to rounding.
    shifted = well_conditioned(np.diag([3.0, 0.0]), LIMIT)
    constant = 3.0 / 99_999.0
    assert shifted[1, 1] in {constant, 2 * constant}
    assert shifted[0, 1] == 0.0


def test_a_good_matrix_is_left_alone() -> None:
    matrix = np.array([[2.0, 1.0], [0.0, 1.0]])
    assert well_conditioned(matrix, LIMIT) is matrix


def test_a_matrix_of_zeros_becomes_the_identity() -> None:
    assert well_conditioned(np.zeros((2, 2)), LIMIT).tolist() == [[1.0, 0.0], [0.0, 1.0]]


@given(
    hnp.arrays(np.float64, (4, 4), elements=st.integers(-3, 3).map(float)),
    st.sampled_from([1.5, 10.0, 1e5]),
)
def test_the_condition_number_is_bounded(matrix: FloatArray, limit: float) -> None:
    singular = np.linalg.svd(well_conditioned(matrix, limit), compute_uv=False)
    assert singular[0] <= limit * singular[-1] * (1 + 1e-9)


def test_features_that_repeat_each_other_are_shrunk_not_blown_up() -> None:
    # A bias and the bits of a tree always add up to it, so A is singular by construction.
    bits = np.array([[1.0, 1.0, 0.0], [1.0, 0.0, 1.0]])
    transitions = transitions_of([((0, 0), 1.0, 0.0, []), ((0, 1), 3.0, 0.0, [])])
    (weights,) = evaluated([bits], transitions, np.array([-1, -1])).weights()
    assert bits @ weights == pytest.approx([1.0, 3.0], abs=1e-3)
    assert np.abs(weights).max() < 3.0
