"""Linear values: the value of the first action that a state offers, and the advantage of each other one.

Both are sums of piecewise linear curves of single numbers of a vector, with knots at their quantiles. In
keepaway the first action is to hold the ball. Letters: c actions, n transitions, w numbers of a vector.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Any, ClassVar, Final, NamedTuple, final

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_factor, cho_solve

from relforest.rl.fitted.evidence import Evidence, check_values
from relforest.rl.fitted.questions import N_KNOTS, curves, hats, knots_of
from relforest.rl.lspi import lspi
from relforest.rl.samples import Transitions
from relforest.rl.settings import LSPISettings
from relforest.rl.vectors.approximator import Model, Rows
from relforest.rl.vectors.sweeps import swept
from relforest.scenes.arrays import FloatArray, IntArray
from relforest.support.documents import LARGEST_NUMBER
from relforest.support.errors import ModelFormatError
from relforest.support.options import at_least, in_range

# As in `relforest.rl.fitted.additive`: constants are hardly penalised, flat features not blown up.
_NEARLY_FREE: Final = (1e-3, 0.3)
_LEAST_SPREAD: Final = 1e-3


@final
@dataclass(frozen=True, slots=True, eq=False)
class Curves:
    """Curves of the numbers of a vector.

    Parameters
    ----------
    knots : (w, N_KNOTS) float64
        In ascending order; beyond the ends, curves are flat.
    heights : (2, w, N_KNOTS) float64
        What they add at the knots, to the value of the first action and to the advantage of others.
    constants : (2,) float64
    """

    knots: FloatArray
    heights: FloatArray
    constants: FloatArray

    fields: ClassVar[tuple[str, ...]] = ("knots", "heights", "constants")

    def values(self, rows: Rows) -> FloatArray:
        """Return the values of actions, (c,)."""
        of_first, advantage = np.empty(len(rows.base)), np.empty(len(rows.base))
        curves(rows.vectors, self.knots, self.heights[0], of_first)
        curves(rows.vectors, self.knots, self.heights[1], advantage)
        is_first = rows.base == np.arange(len(rows.base))
        out: FloatArray = (of_first + self.constants[0])[rows.base]
        return out + np.where(is_first, 0.0, advantage + self.constants[1])

    def arrays(self) -> Mapping[str, NDArray[Any]]:
        """Return knots, heights and constants."""
        return {name: getattr(self, name) for name in self.fields}

    @classmethod
    def of(cls, arrays: Mapping[str, NDArray[Any]], width: int, *, origin: str) -> Curves:
        """Return curves of `width` numbers; `ModelFormatError` if the arrays are not such curves."""
        shapes = {"knots": (width, N_KNOTS), "heights": (2, width, N_KNOTS), "constants": (2,)}
        for name, shape in shapes.items():
            array = arrays[name]
            # The negated test also catches NaN.
            if array.shape != shape or array.dtype != np.float64 or not (abs(array) <= LARGEST_NUMBER).all():
                raise ModelFormatError(f"{origin}: {name} must be finite numbers in the shape {shape}")
        if not (np.diff(arrays["knots"]) > 0.0).all():
            raise ModelFormatError(f"{origin}: knots must be in ascending order")
        return cls(**{name: arrays[name] for name in cls.fields})


@final
@dataclass(frozen=True, slots=True)
class LinearQ:
    """Fitted Q iteration by one ridge regression.

    Parameters
    ----------
    ridge : float
        Penalty on the standardised weights, above 0.
    sweeps : int
        Most times that returns and weights are computed in turn.
    """

    ridge: float = 30.0
    sweeps: int = 15

    model: ClassVar[type[Model]] = Curves

    def __post_init__(self) -> None:
        in_range("ridge", self.ridge, 0.0, 1e9, open_low=True)
        at_least("sweeps", self.sweeps, 1)

    def improved(
        self,
        before: Curves | None,
        evidence: Evidence,
        rows: Rows,
        rng: np.random.Generator,  # noqa: ARG002 - the protocol's
    ) -> Curves:
        """Return curves of the returns of their own policy."""
        shares = _Shares.of(rows)
        matrix = shares.features(evidence.taken)
        n_own = (matrix.shape[1] - 2) // 2
        is_other = matrix[:, 1] > 0.0
        counted = np.ones(len(matrix), dtype=np.bool_), is_other
        blocks = [slice(2, 2 + n_own), slice(2 + n_own, None)]
        mean, spread = np.zeros(matrix.shape[1]), np.ones(matrix.shape[1])
        for block, own in zip(blocks, counted, strict=True):
            if own.any():
                mean[block] = matrix[own, block].mean(axis=0)
                spread[block] = matrix[own, block].std(axis=0) + _LEAST_SPREAD
            matrix[own, block] = (matrix[own, block] - mean[block]) / spread[block]
        penalty = np.concatenate([_NEARLY_FREE, np.full(2 * n_own, self.ridge)])
        factor = cho_factor(matrix.T @ matrix + np.diag(penalty))

        def fit(targets: FloatArray) -> Curves:
            middle = targets.mean()
            weights = cho_solve(factor, matrix.T @ (targets - middle)) / spread
            weights[0] += middle - weights[blocks[0]] @ mean[blocks[0]]
            weights[1] -= weights[blocks[1]] @ mean[blocks[1]]
            return shares.curves(weights)

        return swept(before, evidence, rows, fit, self.sweeps)

    def to_dict(self) -> dict[str, Any]:
        """Return the name of the learner and its options."""
        return {"name": "linear-q", **asdict(self)}


@final
@dataclass(frozen=True, slots=True)
class LSPI:
    """Least-squares policy iteration with the same features.

    Parameters
    ----------
    settings : LSPISettings
    """

    settings: LSPISettings = field(default_factory=LSPISettings)

    model: ClassVar[type[Model]] = Curves

    def improved(
        self,
        before: Curves | None,
        evidence: Evidence,
        rows: Rows,
        rng: np.random.Generator,  # noqa: ARG002 - the protocol's
    ) -> Curves:
        """Return curves whose policy LSPI ends with; it begins with that of the earlier ones.

        Before, there is a value of 0: the first policy takes the first action of each state.
        """
        shares = _Shares.of(rows)
        features = shares.features(np.arange(len(rows.base)))
        values = np.zeros(len(features)) if before is None else before.values(rows)
        # In terms of the new knots, by least squares.
        weights: FloatArray = np.asarray(np.linalg.lstsq(features, values, rcond=None)[0], dtype=np.float64)
        found = lspi([features], _transitions(evidence), [weights], settings=self.settings)
        learned = shares.curves(found.weights[0])
        check_values(learned.values(rows), evidence)
        return learned

    def to_dict(self) -> dict[str, Any]:
        """Return the name of the learner and its options."""
        return {"name": "lspi", **asdict(self.settings)}


class _Shares(NamedTuple):
    """The share of each knot in the numbers of all actions."""

    knots: FloatArray  # (w, N_KNOTS)
    shares: FloatArray  # (c, w * N_KNOTS)
    base: IntArray  # (c,)

    @classmethod
    def of(cls, rows: Rows) -> _Shares:
        """Place the knots at quantiles of the numbers of all actions."""
        columns = np.ascontiguousarray(rows.vectors.T)
        # Of fewer actions than knots, nothing can be learned anyway.
        knots = np.array([knots_of(each) or range(N_KNOTS) for each in columns], dtype=np.float64)
        shares = np.empty((len(rows.vectors), knots.size))
        hats(rows.vectors, knots, shares)
        return cls(knots, shares, rows.base)

    def features(self, chosen: IntArray) -> FloatArray:
        """Return the features of some actions (n,), two constants first, (n, 2 + 2 * w * N_KNOTS)."""
        is_other = (self.base[chosen] != chosen)[:, None]
        first = np.hstack([np.ones_like(is_other, dtype=np.float64), is_other])
        return np.hstack([first, self.shares[self.base[chosen]], self.shares[chosen] * is_other])

    def curves(self, weights: FloatArray) -> Curves:
        """Return the curves with weights of these features."""
        return Curves(self.knots, weights[2:].reshape(2, *self.knots.shape).copy(), weights[:2].copy())


def _transitions(evidence: Evidence) -> Transitions:
    """Return the transitions with all actions in one table, as if of one type."""
    follows = evidence.discounts > 0.0
    starts = evidence.starts[evidence.next_states]
    counts = np.where(follows, evidence.starts[evidence.next_states + 1] - starts, 0)
    ends = np.cumsum(counts)
    following = np.arange(ends[-1]) + np.repeat(starts - (ends - counts), counts)
    return Transitions(
        np.zeros_like(evidence.taken),
        evidence.taken,
        evidence.rewards,
        evidence.discounts,
        np.append(0, ends),
        np.zeros_like(following),
        following,
    )
