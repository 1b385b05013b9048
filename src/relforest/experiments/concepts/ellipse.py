"""How well one ellipse can stand for the box of the concept "between": the ceiling of a single question."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product
from typing import Final, final

import numpy as np
from numpy.typing import NDArray

from relforest.mappings import Mapping
from relforest.metrics import peirce_skill_score
from relforest.scenes import Scenes

_CENTRE: Final = (0.5, 0.0)
_ALONG: Final = np.arange(0.26, 0.45, 0.01)
_ACROSS: Final = np.arange(0.12, 0.24, 0.005)


@final
@dataclass(frozen=True, slots=True)
class CentredEllipse:
    """An ellipse around the middle between A and B, in the scaled reframe of A and B."""

    along: float
    across: float
    """Semi-axes in the direction from A to B and at right angles to it, in distances from A to B."""

    @classmethod
    def best(cls, scenes: Scenes, labels: NDArray[np.bool_]) -> CentredEllipse:
        """Return the ellipse, from a grid of semi-axes, that separates these scenes best.

        The box .2 < u < .8, abs(v) < .15 of the concept has the same centre and axes by symmetry.
        """
        offsets, starts = _offsets(scenes)

        def score(ellipse: CentredEllipse) -> float:
            return peirce_skill_score(labels, ellipse._holds(offsets, starts))

        return max((cls(float(a), float(b)) for a, b in product(_ALONG, _ACROSS)), key=score)

    def predict(self, scenes: Scenes) -> NDArray[np.bool_]:
        """Tell which scenes have an object inside, (n_scenes,)."""
        return self._holds(*_offsets(scenes))

    def _holds(self, offsets: NDArray[np.float64], starts: NDArray[np.int64]) -> NDArray[np.bool_]:
        squared = ((offsets / (self.along, self.across)) ** 2).sum(axis=1)
        inside: NDArray[np.bool_] = np.minimum.reduceat(squared, starts) <= 1.0
        return inside


def _offsets(scenes: Scenes) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Where every third object lies from the middle between A and B, and where each scene begins."""
    scene = np.repeat(np.arange(len(scenes)), scenes.counts)
    rows = np.column_stack([scenes.arguments[scene], scenes.rows])
    third = (rows[:, 2] != rows[:, 0]) & (rows[:, 2] != rows[:, 1])
    framed = Mapping("scaled_reframe", scenes.schema["location"])
    points = framed.evaluate(scenes.schema, scenes.matrix, rows[third])
    return points - _CENTRE, np.searchsorted(scene[third], np.arange(len(scenes)))
