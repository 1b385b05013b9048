"""The tests, the sizes of the scenes, and how many scene sets each is tried on."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, Literal, final

Test = Literal["likelihood-ratio", "permutation"]

LIKELIHOOD_RATIO: Final[Test] = "likelihood-ratio"
PERMUTATION: Final[Test] = "permutation"

ALPHA: Final = 0.05


@final
@dataclass(frozen=True, slots=True)
class CalibrationSetting:
    """A number of scene sets on which one test is tried.

    Parameters
    ----------
    test : {"likelihood-ratio", "permutation"}
        How an expansion must prove itself.
    fewest, most : int
        Objects of a scene (uniform in between).
    block : int
        Number of this setting among those of the same test and size.
    n_sets : int
        Scene sets.
    n_scenes : int
        Scenes in each set, half of them labelled positive.
    """

    test: Test
    fewest: int
    most: int
    block: int
    n_sets: int = 25
    n_scenes: int = 100

    @property
    def objects(self) -> str:
        """The number of objects as text."""
        return str(self.fewest) if self.fewest == self.most else f"{self.fewest}-{self.most}"

    def __str__(self) -> str:
        """Return test, size and block."""
        return f"{self.test}, scenes of {self.objects}, block {self.block}"


N_BLOCKS: Final = 16
SIZES: Final = ((1, 1), (2, 2), (3, 5), (6, 6))
"""Objects of a scene; the more there are, the more points covariant aggregation may choose from."""

CLAIMED: Final = "3-5"
"""Objects of the scenes on which the permutation test must lie inside the interval; one claim, because of
several true ones each would be missed in one study out of twenty."""

# The permutation test repeats the whole search, so it is not tried on the largest size.
_CELLS: Final[tuple[tuple[Test, int, int], ...]] = (
    *((LIKELIHOOD_RATIO, *size) for size in SIZES),
    *((PERMUTATION, *size) for size in SIZES[:-1]),
)

SETTINGS: Final = tuple(
    CalibrationSetting(test, fewest, most, block)
    for test, fewest, most in _CELLS
    for block in range(N_BLOCKS)
)
SMOKE: Final = tuple(
    CalibrationSetting(test, 3, 5, 0, n_sets=2, n_scenes=16) for test in (LIKELIHOOD_RATIO, PERMUTATION)
)
