"""Losses of boosting: derivatives with respect to the predicted numbers, and what these mean."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol, final

import numpy as np
from scipy.special import expit, log_softmax, softmax

from relforest.forests.kernels import Targets

if TYPE_CHECKING:
    from numpy.typing import NDArray


class Loss(Protocol):
    """What boosting needs of a loss."""

    def start(self) -> NDArray[np.float64]:
        """The best constant prediction, (n_outputs,)."""
        ...

    def targets(self, scores: NDArray[np.float64]) -> Targets:
        """First and second derivatives at the scores (n, n_outputs) of all scenes."""
        ...

    def value(self, scores: NDArray[np.float64], scenes: NDArray[np.int64]) -> float:
        """The mean loss of some scenes, by weight."""
        ...


@final
@dataclass(frozen=True, slots=True, eq=False)
class Logistic:
    """Negative log likelihood of two classes; the score is the log-odds of the second."""

    positive: NDArray[np.bool_]  # (n,)
    weights: NDArray[np.float64]  # (n,)

    def start(self) -> NDArray[np.float64]:
        """The log-odds of the weighted share of positive scenes."""
        share = float(np.average(self.positive, weights=self.weights))
        return np.array([np.log(share / (1.0 - share))])

    def targets(self, scores: NDArray[np.float64]) -> Targets:
        """Derivatives: p - y and p (1 - p), times the weight."""
        p, w = expit(scores), self.weights[:, None]
        return Targets(w * (p - self.positive[:, None]), w * p * (1.0 - p))

    def value(self, scores: NDArray[np.float64], scenes: NDArray[np.int64]) -> float:
        """Mean negative log likelihood."""
        signs = np.where(self.positive[scenes], -1.0, 1.0)
        return float(np.average(np.logaddexp(0.0, signs * scores[scenes, 0]), weights=self.weights[scenes]))


@final
@dataclass(frozen=True, slots=True, eq=False)
class Softmax:
    """Negative log likelihood of several classes."""

    classes: NDArray[np.int64]  # (n,) number of the class of each scene
    n_classes: int
    weights: NDArray[np.float64]  # (n,)

    def start(self) -> NDArray[np.float64]:
        """Logarithms of the weighted shares of the classes."""
        shares = np.bincount(self.classes, self.weights, self.n_classes) / self.weights.sum()
        return np.asarray(np.log(shares))

    def targets(self, scores: NDArray[np.float64]) -> Targets:
        """Derivatives: p - y and the diagonal p (1 - p), times the weight."""
        p, w = softmax(scores, axis=1), self.weights[:, None]
        return Targets(w * (p - np.eye(self.n_classes)[self.classes]), w * p * (1.0 - p))

    def value(self, scores: NDArray[np.float64], scenes: NDArray[np.int64]) -> float:
        """Mean negative log likelihood."""
        logs = log_softmax(scores[scenes], axis=1)[np.arange(len(scenes)), self.classes[scenes]]
        return -float(np.average(logs, weights=self.weights[scenes]))


@final
@dataclass(frozen=True, slots=True, eq=False)
class SquaredError:
    """Half of the squared error in units of the variance, so that the penalty means the same for all."""

    values: NDArray[np.float64]  # (n,) targets in units of their standard deviation
    weights: NDArray[np.float64]  # (n,)

    def start(self) -> NDArray[np.float64]:
        """The weighted mean."""
        return np.array([np.average(self.values, weights=self.weights)])

    def targets(self, scores: NDArray[np.float64]) -> Targets:
        """Derivatives: the residual and 1, times the weight."""
        w = self.weights[:, None]
        return Targets(w * (scores - self.values[:, None]), w.copy())

    def value(self, scores: NDArray[np.float64], scenes: NDArray[np.int64]) -> float:
        """Mean of half of the squared error."""
        errors = (scores[scenes, 0] - self.values[scenes]) ** 2
        return 0.5 * float(np.average(errors, weights=self.weights[scenes]))
