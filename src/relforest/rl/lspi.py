"""Least-squares policy iteration on a fixed batch of experience (Palmer (2015), Algorithm 2.2)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from hashlib import blake2b
from typing import Literal, final

import numpy as np

from relforest.rl.bellman import Lookahead
from relforest.rl.lstdq import LSTDQ
from relforest.rl.settings import LSPISettings
from relforest.scenes.arrays import FloatArray, IntArray
from relforest.support.progress import report

Reason = Literal["converged", "cycle", "limit"]


@final
@dataclass(frozen=True, slots=True, eq=False)
class LSPIResult:
    """A policy learned by LSPI."""

    weights: tuple[FloatArray, ...]  # for each action type the weights of its features
    lookahead: Lookahead  # values, greedy actions and Bellman errors of these weights on the samples
    n_features: int  # number of features in use (with data), over all action types
    iterations: int  # number of policies evaluated
    reason: Reason
    """Why it stopped: the weights converged, a policy recurred, or the limit was reached. In the last two
    cases the result is the policy with the smallest sum of squared Bellman errors."""
    problem: LSTDQ  # that of the policy evaluated last


def lspi(problem: LSTDQ, weights: Sequence[FloatArray], settings: LSPISettings | None = None) -> LSPIResult:
    """Learn the weights of a greedy policy.

    The problem may be that of any policy. The policy that is evaluated first is greedy for the initial
    weights, (k_a,) for each action type.

    References
    ----------
    Palmer (2015), Algorithm 2.2; Lagoudakis and Parr (2003). The source does not say
    what to do when policies alternate forever; keeping the one with the smallest residual is our choice.
    """
    settings = settings or LSPISettings()
    current = tuple(weights)
    ahead = problem.look_ahead(current)
    best: tuple[tuple[FloatArray, ...], Lookahead] | None = None
    seen: set[bytes] = set()
    reason: Reason = "limit"
    while len(seen) < settings.max_iterations:
        report("policy iteration", len(seen), settings.max_iterations)
        policy = _fingerprint(ahead.chosen)
        seen.add(policy)
        problem = problem.with_policy(ahead.chosen)
        improved = problem.weights()
        change = _distance(improved, current)
        current, ahead = improved, problem.look_ahead(improved)
        if best is None or ahead.squared_error < best[1].squared_error:
            best = (current, ahead)
        following = _fingerprint(ahead.chosen)
        # The weights depend only on the policy, so evaluating the same policy again would change nothing.
        if change < settings.epsilon or following == policy:
            return LSPIResult(current, ahead, problem.n_features, len(seen), "converged", problem)
        if following in seen:
            reason = "cycle"
            break
    return LSPIResult(*(best or (current, ahead)), problem.n_features, len(seen), reason, problem)


def _fingerprint(chosen: IntArray) -> bytes:
    return blake2b(chosen.tobytes(), digest_size=16).digest()


def _distance(left: Sequence[FloatArray], right: Sequence[FloatArray]) -> float:
    return float(np.sqrt(sum(float(np.sum((a - b) ** 2)) for a, b in zip(left, right, strict=True))))
