"""The tests, the sizes of the scenes, and how many scene sets each is tried on."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, final

from relforest.trees.settings import Test

LIKELIHOOD_RATIO: Final[Test] = "likelihood-ratio"
PERMUTATION: Final[Test] = "permutation"

ALPHA: Final = 0.05
"""The level that a test should keep."""
STRICT_ALPHA: Final = 1e-3
"""A nominal level for the likelihood ratio test; see the study ``concepts`` for what it is good for."""


@final
@dataclass(frozen=True, slots=True)
class CalibrationSetting:
    """A number of scene sets on which one test is tried."""

    test: Test  # how an expansion must prove itself
    fewest: int
    most: int
    """Objects of a scene (uniform in between)."""
    block: int  # number of this setting among those of the same test and size
    n_sets: int = 25  # scene sets
    n_scenes: int = 100  # scenes in each set, half of them labelled positive
    alpha: float = ALPHA  # nominal level of the test
    permutations: int = 99  # shuffles of the permutation test

    @property
    def label(self) -> str:
        """The test, with its nominal level where that is not `ALPHA`."""
        return self.test if self.alpha == ALPHA else f"{self.test} at {self.alpha:g}"

    @property
    def objects(self) -> str:
        """The number of objects as text."""
        return str(self.fewest) if self.fewest == self.most else f"{self.fewest}-{self.most}"

    def __str__(self) -> str:
        """Return test, size and block."""
        return f"{self.label}, scenes of {self.objects}, block {self.block}"


N_BLOCKS: Final = 16
SIZES: Final = ((1, 1), (3, 5))
"""Objects of a scene; the more there are, the more points covariant aggregation may choose from."""
LARGER: Final = SIZES[-1]

# The permutation test repeats the whole search, so it is tried on the larger size only.
_CELLS: Final[tuple[tuple[Test, float, int, int], ...]] = (
    *((LIKELIHOOD_RATIO, ALPHA, *size) for size in SIZES),
    (LIKELIHOOD_RATIO, STRICT_ALPHA, *LARGER),
    (PERMUTATION, ALPHA, *LARGER),
)

SETTINGS: Final = tuple(
    CalibrationSetting(test, fewest, most, block, alpha=alpha)
    for test, alpha, fewest, most in _CELLS
    for block in range(N_BLOCKS)
)
SMOKE: Final = tuple(
    CalibrationSetting(test, 1, 1, 0, n_sets=2, n_scenes=12, permutations=19)
    for test in (LIKELIHOOD_RATIO, PERMUTATION)
)
