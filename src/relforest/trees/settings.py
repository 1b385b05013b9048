"""How a SMRF tree is grown: the options, checked once."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Literal, final

from relforest.support.errors import InputError
from relforest.support.options import at_least, in_range, one_of
from relforest.volumes.settings import CovAggSettings

Test = Literal["likelihood-ratio", "permutation"]
SearchName = Literal["screened", "exhaustive"]


@final
@dataclass(frozen=True, slots=True)
class TreeSettings:
    """How a tree is grown.

    Parameters
    ----------
    test : {"likelihood-ratio", "permutation"}
        The test that an expansion must pass. The source uses the likelihood ratio test with Sidak
        correction. It is anti-conservative, because the volume was fitted to the same scenes: on pure noise
        it accepts questions far more often than `alpha`. The permutation test repeats the whole search on
        shuffled labels and keeps its level, at up to `permutations` times the cost.
    alpha : float
        Significance level.
    search : {"screened", "exhaustive"}
        How the best question is found, see `relforest.trees.search`. The source searches exhaustively. The
        screened search tries every expansion on few scenes and the best of them on all.
    attempts : int
        Tries for each expansion (in the screened search for the best of them, but it corrects for as many
        comparisons); covariant aggregation samples differently each time.
    permutations : int
        Shuffles of the permutation test.
    max_points : int
        Of expansions with more instantiation sequences than this, the screened search sees only a sample of
        so many (`Growth.n_sampled`), and leaves out those with over a hundred times more; the exhaustive
        search leaves all of them out (`Growth.n_left_out`).
    covagg : CovAggSettings
        Parameters of covariant aggregation.

    Raises
    ------
    InputError
        If a value is outside its range.
    """

    test: Test = "likelihood-ratio"
    search: SearchName = "screened"
    alpha: float = 0.05
    attempts: int = 3
    permutations: int = 99
    max_points: int = 100_000
    covagg: CovAggSettings = field(default_factory=CovAggSettings)

    def __post_init__(self) -> None:
        one_of("test", self.test, ("likelihood-ratio", "permutation"))
        one_of("search", self.search, ("screened", "exhaustive"))
        in_range("alpha", self.alpha, 0.0, 1.0, open_low=True, open_high=True)
        at_least("attempts", self.attempts, 1)
        at_least("permutations", self.permutations, 1)
        at_least("max_points", self.max_points, 1)
        # The slack allows for an alpha such as 1 / 49: its product with 49 is rounded below 1.
        if self.test == "permutation" and self.alpha * (self.permutations + 1) < 1.0 - 1e-9:
            raise InputError(
                f"permutations={self.permutations} can never reach alpha={self.alpha}: "
                f"use at least {math.ceil(1 / self.alpha - 1e-9) - 1}"
            )
