"""Sarsa(lambda) as the books write it: one dictionary of weights, one of traces, no kernels."""

from __future__ import annotations

from typing import final

import numpy as np

from relforest.rl.baselines import SarsaSettings
from relforest.scenes.arrays import FloatArray


@final
class PlainSarsa:
    """The slow twin of `relforest.rl.baselines.SarsaLambda`; observations are rows of numbers per action."""

    def __init__(self, n_active: int, settings: SarsaSettings, seed: int) -> None:
        self.settings = settings
        self.step_size = settings.alpha / n_active
        self.weights: dict[int, float] = {}
        self.traces: dict[int, float] = {}
        self.last: dict[int, float] = {}
        self.rng = np.random.Generator(np.random.PCG64(np.random.SeedSequence(seed)))

    def start(self, rows: FloatArray) -> int:
        self.traces = {}
        return self._take(rows, self._choose(rows))

    def step(self, reward: float, duration: float, rows: FloatArray) -> int:
        discount = self.settings.gamma**duration
        action = self._choose(rows)
        following = self._value(dict(enumerate(rows[action].tolist())))
        self._learn(reward + discount * following - self._value(self.last))
        factor = discount * self.settings.trace_decay
        faded = {feature: trace * factor for feature, trace in self.traces.items()}
        self.traces = {k: e for k, e in faded.items() if e != 0 and abs(e) >= self.settings.min_trace}
        return self._take(rows, action)

    def end(self, reward: float) -> None:
        self._learn(reward - self._value(self.last))

    def _take(self, rows: FloatArray, action: int) -> int:
        chosen = {k: x for k, x in enumerate(rows[action].tolist()) if x != 0}
        if self.settings.traces == "replacing":
            others = {k for a, row in enumerate(rows) if a != action for k in np.flatnonzero(row).tolist()}
            self.traces = {k: e for k, e in self.traces.items() if k not in others} | chosen
        else:
            for feature, value in chosen.items():
                self.traces[feature] = self.traces.get(feature, 0.0) + value
        self.last = chosen
        return action

    def _choose(self, rows: FloatArray) -> int:
        draw, epsilon = self.rng.random(), self.settings.epsilon
        if draw < epsilon:
            return int(draw / epsilon * len(rows))
        values = [self._value(dict(enumerate(row.tolist()))) for row in rows]
        best = [action for action, value in enumerate(values) if value == max(values)]
        return best[int((draw - epsilon) / (1 - epsilon) * len(best))]

    def _value(self, features: dict[int, float]) -> float:
        return sum(self.weights.get(feature, 0.0) * value for feature, value in features.items())

    def _learn(self, error: float) -> None:
        for feature, trace in self.traces.items():
            self.weights[feature] = self.weights.get(feature, 0.0) + self.step_size * error * trace
