"""Compiled inner loops of tile coding and Sarsa(lambda).

In the parameters, `indices` and `values` are the two fields of `relforest.rl.baselines.feature_map.Features`,
both (n_actions, k).
"""

from __future__ import annotations

import math
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from relforest.support.jit import kernel

LIMIT: Final = 1e100
"""Larger values count as divergence: far above any meaningful value, far below overflow."""

WIDTH_IN_SIGMAS: Final = 8.0
"""Width of a tile in standard deviations of its bell: at its edges, the bell is down to e**-8."""

HEIGHT: Final = math.sqrt(WIDTH_IN_SIGMAS / math.sqrt(math.pi))
"""Of a bell: its square is 1 on average over the tile, so that steps are as large as those of plain tiles."""

DIVERGED: Final = -1
NO_FEATURE: Final = -2


@kernel
def active_tiles(
    widths: NDArray[np.float64],
    lower: NDArray[np.float64],
    upper: NDArray[np.float64],
    first: NDArray[np.int64],
    tilings: int,
    stride: int,
    observation: NDArray[np.float64],
    out: NDArray[np.int64],
) -> int:
    """Write the active tiles of each action to `out` (n_actions, n_variables * tilings).

    The first four describe the variables: width of a tile, range, and the feature of the first tile at the
    lower bound minus that bound's number of steps. `stride` is the number of features of one action.
    Returns the first variable that is not finite, or -1.
    """
    for i in range(len(observation)):
        number = observation[i]
        if not math.isfinite(number):
            return i
        number = min(max(number, lower[i]), upper[i])
        start = first[i] + math.floor(number / widths[i] * tilings)
        for action in range(len(out)):
            for j in range(tilings):
                out[action, i * tilings + j] = action * stride + start + j
    return -1


@kernel
def bells(
    widths: NDArray[np.float64],
    lower: NDArray[np.float64],
    upper: NDArray[np.float64],
    tilings: int,
    observation: NDArray[np.float64],
    out: NDArray[np.float64],
) -> None:
    """Write the values of the tiles that `active_tiles` finds to `out` (n_actions, n_variables * tilings).

    A bell stands in the middle of each tile; `WIDTH_IN_SIGMAS` and `HEIGHT` describe it.
    """
    for i in range(len(observation)):
        place = min(max(observation[i], lower[i]), upper[i]) / widths[i] * tilings
        beyond = place - math.floor(place)
        for j in range(tilings):
            # The j-th active tile began tilings - 1 - j steps and this remainder ago.
            off = ((beyond + tilings - 1 - j) / tilings - 0.5) * WIDTH_IN_SIGMAS
            bell = HEIGHT * math.exp(-0.5 * off * off)
            for action in range(len(out)):
                out[action, i * tilings + j] = bell


class Memory(NamedTuple):
    """The state that an agent changes while learning; n = number of features."""

    weights: NDArray[np.float64]  # (n,)
    traces: NDArray[np.float64]  # (n,)
    listed: NDArray[np.bool_]  # (n,): which features are on the list
    active: NDArray[np.int64]  # (n,): the list; its first entries are the features with a trace
    length: NDArray[np.int64]  # (1,): how many these are


class Rates(NamedTuple):
    """The options of an agent as the kernels need them."""

    step: float  # alpha / n_active
    trace_decay: float
    min_trace: float
    epsilon: float
    replacing: bool


@kernel
def action_values(
    weights: NDArray[np.float64],
    indices: NDArray[np.int64],
    values: NDArray[np.float64],
    out: NDArray[np.float64],
) -> int:
    """Write the value of each action to `out` (n_actions,); returns 0, `DIVERGED` or `NO_FEATURE`."""
    n_features = len(weights)
    for action in range(len(out)):
        total = 0.0
        for j in range(indices.shape[1]):
            feature = indices[action, j]
            if feature < 0 or feature >= n_features:
                return NO_FEATURE
            total += weights[feature] * values[action, j]
        if not abs(total) <= LIMIT:
            return DIVERGED
        out[action] = total
    return 0


@kernel
def pick(values: NDArray[np.float64], epsilon: float, draw: float) -> int:
    """Return an action, epsilon-greedy with random ties; `draw` is uniform in [0, 1) and decides everything.

    The share of [0, 1) below `epsilon` is divided equally among all actions, the rest among the best.
    """
    n_actions = len(values)
    if draw < epsilon:
        return min(int(draw / epsilon * n_actions), n_actions - 1)
    best, ties = 0, 0
    for action in range(n_actions):
        if values[action] > values[best]:
            best, ties = action, 1
        elif values[action] == values[best]:
            ties += 1
    skipped = min(int((draw - epsilon) / (1.0 - epsilon) * ties), ties - 1)
    for action in range(best + 1, n_actions):
        if skipped > 0 and values[action] == values[best]:
            skipped -= 1
            if skipped == 0:
                return action
    return best


@kernel
def choose(
    weights: NDArray[np.float64],
    indices: NDArray[np.int64],
    values: NDArray[np.float64],
    epsilon: float,
    draw: float,
) -> int:
    """Return an action as `pick` does, or the error of `action_values`."""
    q = np.empty(len(indices))
    failure = action_values(weights, indices, values, q)
    return failure if failure < 0 else pick(q, epsilon, draw)


@kernel
def mark(
    memory: Memory, rates: Rates, indices: NDArray[np.int64], values: NDArray[np.float64], action: int
) -> None:
    """Enter the features of the chosen action into the traces.

    Replacing traces take the feature's value, and features of the other actions lose theirs; accumulating
    ones add it up. Without decay there is nothing to keep: `learn` then looks at the last action alone.
    """
    if rates.trace_decay == 0.0:
        return
    if rates.replacing:
        for other in range(len(indices)):
            if other != action:
                for j in range(indices.shape[1]):
                    if values[other, j] != 0.0:
                        memory.traces[indices[other, j]] = 0.0
    for j in range(indices.shape[1]):
        value = values[action, j]
        if value != 0.0:
            feature = indices[action, j]
            memory.traces[feature] = value if rates.replacing else memory.traces[feature] + value
            if not memory.listed[feature]:
                memory.listed[feature] = True
                memory.active[memory.length[0]] = feature
                memory.length[0] += 1


@kernel
def fade(memory: Memory, factor: float, smallest: float) -> None:
    """Multiply all traces by `factor` and drop those below `smallest` in size."""
    kept = 0
    for i in range(memory.length[0]):
        feature = memory.active[i]
        trace = memory.traces[feature] * factor
        if trace == 0.0 or abs(trace) < smallest:
            memory.traces[feature] = 0.0
            memory.listed[feature] = False
        else:
            memory.traces[feature] = trace
            memory.active[kept] = feature
            kept += 1
    memory.length[0] = kept


@kernel
def learn(
    memory: Memory, rates: Rates, past: tuple[NDArray[np.int64], NDArray[np.float64]], error: float
) -> None:
    """Move the weights along the traces; `past` are the features of the last action, (1, k) each."""
    amount = rates.step * error
    if rates.trace_decay == 0.0:
        for j in range(past[0].shape[1]):
            memory.weights[past[0][0, j]] += amount * past[1][0, j]
    for i in range(memory.length[0]):
        feature = memory.active[i]
        memory.weights[feature] += amount * memory.traces[feature]


@kernel
def begin(
    memory: Memory, rates: Rates, indices: NDArray[np.int64], values: NDArray[np.float64], draw: float
) -> int:
    """Return the first action of an episode, or the error of `action_values`."""
    fade(memory, 0.0, 0.0)
    action = choose(memory.weights, indices, values, rates.epsilon, draw)
    if action >= 0:
        mark(memory, rates, indices, values, action)
    return action


@kernel
def advance(
    memory: Memory,
    rates: Rates,
    past: tuple[NDArray[np.int64], NDArray[np.float64]],
    indices: NDArray[np.int64],
    values: NDArray[np.float64],
    reward: float,
    discount: float,
    draw: float,
) -> int:
    """Learn from one decision and return the next action; on an error, nothing changes.

    `past` are the features of the previous action, each (1, k).
    """
    before, q = np.empty(1), np.empty(len(indices))
    failure = action_values(memory.weights, past[0], past[1], before)
    if failure == 0:
        failure = action_values(memory.weights, indices, values, q)
    if failure < 0:
        return failure
    action = pick(q, rates.epsilon, draw)
    error = reward - before[0] + discount * q[action]
    if not abs(error) <= LIMIT:
        return DIVERGED
    learn(memory, rates, past, error)
    fade(memory, discount * rates.trace_decay, rates.min_trace)
    mark(memory, rates, indices, values, action)
    return action


@kernel
def finish(
    memory: Memory, rates: Rates, past: tuple[NDArray[np.int64], NDArray[np.float64]], reward: float
) -> int:
    """Learn from the last decision of an episode; returns 0 or an error."""
    before = np.empty(1)
    failure = action_values(memory.weights, past[0], past[1], before)
    if failure < 0:
        return failure
    error = reward - before[0]
    if not abs(error) <= LIMIT:
        return DIVERGED
    learn(memory, rates, past, error)
    fade(memory, 0.0, 0.0)
    return 0
