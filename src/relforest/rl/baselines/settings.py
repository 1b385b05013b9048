"""The options of Sarsa(lambda), checked once, and their JSON form."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields
from typing import Any, Final, Literal, final

from relforest.support.errors import InputError, ModelFormatError
from relforest.support.options import in_range, one_of

Traces = Literal["replacing", "accumulating"]

TRACES: Final = ("replacing", "accumulating")


@final
@dataclass(frozen=True, slots=True)
class SarsaSettings:
    """Options of Sarsa(lambda); the defaults are those of the keepaway benchmark.

    Parameters
    ----------
    alpha : float
        Step size, above 0; each active feature gets ``alpha / n_active`` of the error.
    gamma : float
        Discount per unit of duration, 0 to 1.
    epsilon : float
        Probability of a uniformly random action while learning, 0 to 1.
    trace_decay : float
        Lambda, 0 to 1: the factor by which traces decay per decision, in addition to the discount.
    traces : {"replacing", "accumulating"}
        Whether the trace of a feature that is active again is set to its value, or increased by it. Replacing
        traces also clear features that are active for the other actions of the state.
    min_trace : float
        Traces below this are dropped, at least 0; 0 keeps them all, which is slow with many features.

    Raises
    ------
    InputError
        If an option is out of its range.

    References
    ----------
    Stone, Sutton and Kuhlmann (2005); Singh and Sutton (1996) for replacing traces.
    """

    alpha: float = 0.125
    gamma: float = 1.0
    epsilon: float = 0.01
    trace_decay: float = 0.0
    traces: Traces = "replacing"
    min_trace: float = 0.01

    def __post_init__(self) -> None:
        in_range("alpha", self.alpha, 0.0, math.inf, open_low=True, open_high=True)
        for name in ("gamma", "epsilon", "trace_decay"):
            in_range(name, getattr(self, name), 0.0, 1.0)
        one_of("traces", self.traces, TRACES)
        in_range("min_trace", self.min_trace, 0.0, math.inf, open_high=True)

    def to_dict(self) -> dict[str, Any]:
        """Return the options as plain JSON values."""
        return asdict(self)

    @classmethod
    def from_dict(cls, document: object) -> SarsaSettings:
        """Read what `to_dict` returned.

        Raises
        ------
        ModelFormatError
            If an option is missing, unknown or out of its range.
        """
        names = {entry.name for entry in fields(cls)}
        if not isinstance(document, Mapping) or set(document) != names:
            raise ModelFormatError(
                f"malformed options of Sarsa: expected {', '.join(sorted(names))}, got {document!r:.200}"
            )
        try:
            return cls(**document)
        except InputError as error:
            raise ModelFormatError(f"malformed options of Sarsa: {error}") from error
