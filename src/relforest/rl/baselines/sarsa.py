"""Linear Sarsa(lambda) for semi-Markov decision processes, the learner of Stone et al. (2005).

An agent stores the features of its last decision, its traces and its random stream. All it learns is a weight
vector, so agents share experience by sharing that vector.
"""

from __future__ import annotations

from typing import Final, Generic, final

import numpy as np

from relforest.rl.baselines import kernels
from relforest.rl.baselines.feature_map import FeatureMap, Features, Observation
from relforest.rl.baselines.kernels import LIMIT, NO_FEATURE, Memory, Rates
from relforest.rl.baselines.settings import SarsaSettings
from relforest.scenes.arrays import FloatArray, IntArray
from relforest.support.errors import InputError
from relforest.support.options import in_range
from relforest.support.rng import RandomState, generator, seed_sequence

_INDEX: Final = np.dtype(np.int64)
_NUMBER: Final = np.dtype(np.float64)


@final
class SarsaLambda(Generic[Observation]):
    """One agent that learns online: `start`, then `step` at each further decision, then `end`.

    Parameters
    ----------
    features : FeatureMap
        The feature map of its observations.
    settings : SarsaSettings, optional
        Default: ``SarsaSettings()``.
    weights : (n_features,) float64, optional
        Initial weights, 0 by default. The array is used directly and modified: agents with the same array
        learn from each other's experience.
    learn : bool
        False freezes the agent: it takes the best action and learns nothing.
    random_state : int, SeedSequence, Generator or None
        Seed of exploration and ties. Each decision uses one random number.

    Raises
    ------
    InputError
        If an option or the array of weights is invalid.

    Notes
    -----
    The error of a decision is ``r + gamma**duration Q(s', a') - Q(s, a)``, with a' chosen by the weights
    before they change. Q(s, a) uses the current weights, in case another agent has changed them. An episode
    cut short by a time limit ends with `step` on its last observation: `start` discards the action that this
    returns.

    References
    ----------
    Stone, Sutton and Kuhlmann (2005), where gamma is 1; Palmer (2015), sections 2.1 (SMDPs) and 7.5.2.

    Examples
    --------
    >>> from relforest.rl.baselines import TileCoding
    >>> agent = SarsaLambda(TileCoding([1.0], 2), SarsaSettings(alpha=0.5), random_state=0)
    >>> action = agent.start([0.2])
    >>> agent.end(4.0)
    >>> float(agent.values([0.2])[action])
    2.0
    """

    def __init__(
        self,
        features: FeatureMap[Observation],
        settings: SarsaSettings | None = None,
        *,
        weights: FloatArray | None = None,
        learn: bool = True,
        random_state: RandomState = None,
    ) -> None:
        self._features = features
        self._settings = SarsaSettings() if settings is None else settings
        if not isinstance(self._settings, SarsaSettings):
            raise InputError(f"settings must be SarsaSettings(...), got {settings!r}")
        if not isinstance(learn, bool):
            raise InputError(f"learn must be True or False, got {learn!r}")
        count = features.n_features
        numbers = np.zeros(count) if weights is None else _checked_weights(weights, count)
        self._memory = Memory(
            numbers,
            np.zeros(count),
            np.zeros(count, dtype=np.bool_),
            np.zeros(count, dtype=np.int64),
            np.zeros(1, dtype=np.int64),
        )
        self._rates = Rates(
            self._settings.alpha / features.n_active,
            float(self._settings.trace_decay),
            float(self._settings.min_trace),
            float(self._settings.epsilon),
            self._settings.traces == "replacing",
        )
        self._learn = learn
        self._rng = generator(seed_sequence(random_state))
        self._past: tuple[IntArray, FloatArray] | None = None

    @property
    def features(self) -> FeatureMap[Observation]:
        """The feature map of the agent."""
        return self._features

    @property
    def settings(self) -> SarsaSettings:
        """The agent's options."""
        return self._settings

    @property
    def weights(self) -> FloatArray:
        """The learned weights, (n_features,): the array itself, not a copy."""
        return self._memory.weights

    def start(self, observation: Observation) -> int:
        """Return the first action of an episode, discarding everything before it.

        Raises
        ------
        InputError
            If the feature map rejects the observation, or the weights have diverged.
        """
        now = self._look(observation)
        self._past = None
        if not self._learn:
            return self._remember(now, self._choose(now, self._rng))
        return self._remember(now, kernels.begin(self._memory, self._rates, *now, self._rng.random()))

    def step(self, reward: float, duration: float, observation: Observation) -> int:
        """Learn from the last action and return the next one.

        Parameters
        ----------
        reward : float
            The reward of the last action, discounted to its beginning.
        duration : float
            Its duration, in the unit of `SarsaSettings.gamma`, at least 0.
        observation : object
            The current observation.

        Raises
        ------
        InputError
            If there is no previous action, reward or duration is not finite, the feature map rejects the
            observation, or the weights diverge. Nothing is learned in these cases.
        """
        past = self._last_action("step")
        gain = _number("reward", reward, -LIMIT)
        time = _number("duration", duration, 0.0)
        now = self._look(observation)
        if not self._learn:
            return self._remember(now, self._choose(now, self._rng))
        discount = float(self._settings.gamma**time)
        draw = self._rng.random()
        return self._remember(
            now, kernels.advance(self._memory, self._rates, past, *now, gain, discount, draw)
        )

    def end(self, reward: float) -> None:
        """Learn from the last action of an episode that has reached a terminal state.

        Parameters
        ----------
        reward : float
            The reward of that action, discounted to its beginning. Its duration does not matter, because
            nothing follows.

        Raises
        ------
        InputError
            As `step`.
        """
        past = self._last_action("end")
        gain = _number("reward", reward, -LIMIT)
        if self._learn:
            self._check(kernels.finish(self._memory, self._rates, past, gain))
        self._past = None

    def values(self, observation: Observation) -> FloatArray:
        """Return the value of each action, (n_actions,).

        Raises
        ------
        InputError
            As `start`.
        """
        indices, values = self._look(observation)
        out = np.empty(len(indices))
        self._check(kernels.action_values(self.weights, indices, values, out))
        return out

    def greedy(self, observation: Observation, rng: np.random.Generator) -> int:
        """Return a best action outside any episode, breaking ties at random; uses one number of `rng`.

        Raises
        ------
        InputError
            As `start`.
        """
        return self._check(self._choose(self._look(observation), rng))

    def _look(self, observation: Observation) -> Features:
        now = self._features.features(observation)
        indices, values = now
        misshapen = indices.ndim != 2 or indices.shape != values.shape or not len(indices)
        if misshapen or indices.dtype != _INDEX or values.dtype != _NUMBER:
            raise InputError(
                "a feature map must return int64 indices and float64 values of one shape (n_actions, k), at "
                f"least one action, got {indices.dtype} {indices.shape} and {values.dtype} {values.shape}"
            )
        return now

    def _choose(self, now: Features, rng: np.random.Generator) -> int:
        return kernels.choose(self.weights, *now, 0.0, rng.random())

    def _remember(self, now: Features, action: int) -> int:
        self._check(action)
        self._past = (now.indices[action : action + 1], now.values[action : action + 1])
        return action

    def _last_action(self, method: str) -> tuple[IntArray, FloatArray]:
        if self._past is None:
            raise InputError(f"{method} needs an action to learn from: call start at the first decision")
        return self._past

    def _check(self, result: int) -> int:
        """Return what a kernel returned, unless it is an error."""
        if result >= 0:
            return result
        if result == NO_FEATURE:
            raise InputError(
                f"the feature map returned an index outside 0 to {len(self.weights) - 1}; "
                "correct its features or its n_features"
            )
        raise InputError(
            f"action values beyond {LIMIT:g}: learning diverges, or a feature is not finite. Use a lower "
            f"alpha (now {self._settings.alpha:g}), features from -1 to 1, or smaller rewards"
        )


def _number(name: str, value: float, low: float) -> float:
    # Two calls of in_range would take a fifth of the time of a decision.
    if type(value) is float and low <= value <= LIMIT:
        return value
    return in_range(name, value, low, LIMIT)


def _checked_weights(weights: FloatArray, count: int) -> FloatArray:
    is_array = isinstance(weights, np.ndarray) and weights.dtype == np.float64
    if not is_array or weights.shape != (count,) or not weights.flags.carray:
        raise InputError(
            f"weights must be a writable, contiguous array of {count} float64, one per feature, "
            f"got {getattr(weights, 'dtype', type(weights).__name__)} of shape {np.shape(weights)}"
        )
    if not (np.abs(weights) <= LIMIT).all():
        raise InputError("weights must be finite")
    return weights
