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
from relforest.rl.lstdq import LSTDQ
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
    """Curves of the numbers of a vector."""

    knots: FloatArray  # (w, N_KNOTS) in ascending order; beyond the ends, curves are flat
    heights: FloatArray
    """(2, w, N_KNOTS): what they add at the knots, to the value of the first action and to the advantage of
    others."""
    constants: FloatArray  # (2,)

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
        design = _Design.of(rows, evidence.taken)
        matrix = design.features(evidence.taken)
        factor = cho_factor(matrix.T @ matrix + np.diag(design.penalty(self.ridge)))

        def fit(targets: FloatArray) -> Curves:
            middle = targets.mean()
            weights = cho_solve(factor, matrix.T @ (targets - middle))
            weights[0] += middle
            return design.curves(weights)

        return swept(before, evidence, rows, fit, self.sweeps)

    def to_dict(self) -> dict[str, Any]:
        """Return the name of the learner and its options."""
        return {"name": "linear-q", **asdict(self)}


@final
@dataclass(frozen=True, slots=True)
class LSPI:
    """Least-squares policy iteration with the same features and penalty.

    Parameters
    ----------
    ridge : float
        As of `LinearQ`.
    settings : LSPISettings
    """

    ridge: float = 30.0
    settings: LSPISettings = field(default_factory=LSPISettings)

    model: ClassVar[type[Model]] = Curves

    def __post_init__(self) -> None:
        in_range("ridge", self.ridge, 0.0, 1e9, open_low=True)

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
        design = _Design.of(rows, evidence.taken)
        features = design.features(np.arange(len(rows.base)))
        values = np.zeros(len(features)) if before is None else before.values(rows)
        # In terms of the new knots, by least squares.
        weights = np.asarray(np.linalg.lstsq(features, values, rcond=None)[0], dtype=np.float64)
        # A ridge is so many transitions with a single feature that earn nothing and end.
        table = np.vstack([features, np.diag(np.sqrt(design.penalty(self.ridge)))])
        transitions = _transitions(evidence, np.arange(len(features), len(table)))
        found = lspi(LSTDQ.of([table], transitions, self.settings.max_condition), [weights], self.settings)
        learned = design.curves(found.weights[0])
        check_values(learned.values(rows), evidence)
        return learned

    def to_dict(self) -> dict[str, Any]:
        """Return the name of the learner and its options."""
        return {"name": "lspi", "ridge": self.ridge, **asdict(self.settings)}


class _Design(NamedTuple):
    """The features of all actions: two constants, and the share of each knot, standardised.

    The latter stand there for the first action of the state and, for other actions, once more for themselves.
    """

    knots: FloatArray  # (w, N_KNOTS)
    shares: FloatArray  # (c, w * N_KNOTS)
    base: IntArray  # (c,)
    mean: FloatArray  # (2, w * N_KNOTS): where actions were taken
    spread: FloatArray

    @classmethod
    def of(cls, rows: Rows, taken: IntArray) -> _Design:
        """Place the knots at quantiles of the numbers of all actions."""
        columns = np.ascontiguousarray(rows.vectors.T)
        # Of fewer actions than knots, nothing can be learned anyway.
        knots = np.array([knots_of(each) or range(N_KNOTS) for each in columns], dtype=np.float64)
        shares = np.empty((len(rows.vectors), knots.size))
        hats(rows.vectors, knots, shares)
        seen = shares[rows.base[taken]], shares[taken[rows.base[taken] != taken]]
        mean, spread = np.zeros((2, knots.size)), np.ones((2, knots.size))
        for number, own in enumerate(seen):
            if len(own):
                mean[number], spread[number] = own.mean(axis=0), own.std(axis=0) + _LEAST_SPREAD
        return cls(knots, shares, rows.base, mean, spread)

    def penalty(self, ridge: float) -> FloatArray:
        """Return the penalties of the features: constants are hardly penalised."""
        return np.concatenate([_NEARLY_FREE, np.full(2 * self.knots.size, ridge)])

    def features(self, chosen: IntArray) -> FloatArray:
        """Return the features of some actions (n,), (n, 2 + 2 * w * N_KNOTS)."""
        is_other = (self.base[chosen] != chosen)[:, None].astype(np.float64)
        both = self.shares[self.base[chosen]], self.shares[chosen]
        of_first, own = ((each - m) / s for each, m, s in zip(both, self.mean, self.spread, strict=True))
        return np.hstack([np.ones_like(is_other), is_other, of_first, own * is_other])

    def curves(self, weights: FloatArray) -> Curves:
        """Return the curves with weights of these features."""
        heights = weights[2:].reshape(2, -1) / self.spread
        constants = weights[:2] - (heights * self.mean).sum(axis=1)
        return Curves(self.knots, heights.reshape(2, *self.knots.shape), constants)


def _transitions(evidence: Evidence, others: IntArray) -> Transitions:
    """Return the transitions with all actions in one table, as if of one type.

    The `others` are further rows of the table, after which nothing follows.
    """
    follows = evidence.discounts > 0.0
    starts = evidence.starts[evidence.next_states]
    counts = np.where(follows, evidence.starts[evidence.next_states + 1] - starts, 0)
    ends = np.cumsum(counts)
    following = np.arange(ends[-1]) + np.repeat(starts - (ends - counts), counts)
    rows, nothing = np.append(evidence.taken, others), np.zeros(len(others))
    return Transitions(
        np.zeros_like(rows),
        rows,
        np.append(evidence.rewards, nothing),
        np.append(evidence.discounts, nothing),
        np.concatenate([[0], ends, np.full(len(others), ends[-1])]),
        np.zeros_like(following),
        following,
    )
