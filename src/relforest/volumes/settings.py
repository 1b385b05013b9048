"""The parameters of covariant aggregation, checked once."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, Literal, final

from relforest.support.options import at_least, in_range, one_of

Shape = Literal["full", "diagonal", "axis"]
VolumeLearner = Literal["covagg", "diverse-density"]

# With these no product of the search overflows or vanishes, whatever the points.
_LARGEST_WEIGHT: Final = 1e6
_LARGEST_CONDITION: Final = 1e7


@final
@dataclass(frozen=True, slots=True)
class CovAggSettings:
    """Parameters of covariant aggregation; the defaults are those of section 3.3.

    Parameters
    ----------
    window : int
        A, the number of aggregation steps over which progress is judged.
    prior_weight : float
        w of eq. 3.5, at most 1e6.
    max_condition : float
        c of eq. 3.6, at most 1e7: beyond, rounding would decide who is inside.
    restarts : int
        N, the number of positive bags to start from.
    sampled : int
        M, the number of bags tried at each aggregation step.
    shape : {"full", "diagonal", "axis"}
        What ellipsoids may be learned: any; those along the axes, whose covariance is diagonal; or
        intervals of one coordinate, as in TILDE (`Slab`), of which the best is taken. The shape matters only
        in Euclidean spaces of two dimensions or more. The source has "full".
    learner : {"covagg", "diverse-density"}
        Covariant aggregation, or the learner of 2012 (section 5.2.1), see
        `relforest.volumes.diverse_density`. It ranks the points of N positive bags as centres, refines
        the M best of them, and has no use for `window`. Categories are always tried one by one.

    Raises
    ------
    InputError
        If a value is outside its range.
    """

    window: int = 8
    prior_weight: float = 0.1
    max_condition: float = 1e5
    restarts: int = 4
    sampled: int = 4
    shape: Shape = "full"
    learner: VolumeLearner = "covagg"

    def __post_init__(self) -> None:
        at_least("window", self.window, 2)
        in_range("prior_weight", self.prior_weight, 0.0, _LARGEST_WEIGHT, open_low=True)
        in_range("max_condition", self.max_condition, 1.0, _LARGEST_CONDITION, open_low=True)
        at_least("restarts", self.restarts, 1)
        at_least("sampled", self.sampled, 1)
        one_of("shape", self.shape, ("full", "diagonal", "axis"))
        one_of("learner", self.learner, ("covagg", "diverse-density"))
