"""The Color bags of Palmer (2015), section 3.3.1, with distributions of our own: find yellow by its RGB."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from relforest.datasets.bag_set import BagSet
from relforest.datasets.synthetic_bags import plant
from relforest.support.options import at_least

_NEGATIVE_MEANS: Final = np.array(
    [
        [0.52, 0.16, 0.18],  # red
        [0.21, 0.44, 0.22],  # green
        [0.17, 0.18, 0.44],  # blue
    ]
)
_YELLOW_MEAN: Final = np.array([0.70, 0.60, 0.15])
_LIGHT: Final = 0.2
_NOISE: Final = 0.06
_SIZE: Final = 5


def color(rng: np.random.Generator, *, n_bags: int = 100) -> BagSet:
    """Draw bags (5, 3) of colors in RGB space: yellow is positive; red, green and blue are negative.

    Parameters and errors are those of `covariant1`. Colors are in [0, 1].

    Notes
    -----
    The source measured printed colors in photographs and did not publish the numbers, so **the numbers here
    are ours**; scores can be compared with the source's in order, not in value. A print with the mean color m
    is seen under light of changing strength by a camera with noise:

        x = m (1 + 0.2 a) + 0.06 e,  clipped to [0, 1],

    a from N(0, 1), e from N(0, I). Its covariance, clipping aside, is .04 m m' + .06^2 I: the standard
    deviation along m is .2 times its length and more, across it .06. The means, near those of the patches of
    a color chart in moderate light, are

        red (.52, .16, .18), green (.21, .44, .22), blue (.17, .18, .44), yellow (.70, .60, .15).

    Light moves red and green of yellow together (correlation .8), so that no ball holds the bright and the
    dim yellows without greens and reds. Each negative point is red, green or blue with equal probability; a
    positive bag holds exactly one yellow. The strengths .2 and .06 were chosen so that covariant
    aggregation and an optimal ball do as well as in Table 3.2: over 100 draws of a training and a test set we
    found Peirce skill scores of .93 +- .01 and .88 +- .01, as the table has.

    References
    ----------
    Palmer (2015), section 3.3.1, Tables 3.1 and 3.2.
    """
    n_bags = at_least("n_bags", n_bags, 2)
    hues = _NEGATIVE_MEANS[rng.integers(len(_NEGATIVE_MEANS), size=(n_bags, _SIZE))]
    negatives = _photographs(rng, hues)
    return plant(rng, _photographs(rng, np.broadcast_to(_YELLOW_MEAN, (n_bags, 3))), negatives)


def _photographs(rng: np.random.Generator, means: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return what a camera sees of prints with these mean colors, (..., 3)."""
    light = 1 + _LIGHT * rng.standard_normal((*means.shape[:-1], 1))
    seen: NDArray[np.float64] = np.clip(means * light + _NOISE * rng.standard_normal(means.shape), 0, 1)
    return seen
