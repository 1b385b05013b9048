from __future__ import annotations

import numpy as np
import pytest

from relforest.volumes.aggregation import has_prospects


@pytest.mark.parametrize(
    ("recent", "n_remaining", "best", "expected"),
    [
        # The line ends at 4 and gains 1 a step: 6 after 2 more.
        ([1, 2, 3, 4], 2, 5.9, True),
        ([1, 2, 3, 4], 2, 6.0, False),
        ([1, 2, 3, 4], 0, 3.9, True),
        ([1, 2, 3, 4], 0, 4.0, False),
        # Slope (-1 * 0 + 0 * 3 + 1 * 3) / 2 = 1.5 through the mean 2: fitted end 3.5, not the last score 3.
        ([0, 3, 3], 0, 3.4, True),
        ([0, 3, 3], 2, 6.4, True),
        ([0, 3, 3], 2, 6.5, False),
        # Constant and falling scores promise nothing, however many bags are left.
        ([7, 7, 7], 1000, 0.0, False),
        ([3, 2, 1], 1000, 0.0, False),
        ([4, 3, 4, 3], 1000, 0.0, False),
        # Log likelihoods are negative.
        ([-10, -8], 3, -2.5, True),
        ([-10, -8], 3, -2.0, False),
    ],
)
def test_the_trend_is_continued_to_the_last_bag(
    recent: list[float], n_remaining: int, best: float, *, expected: bool
) -> None:
    assert bool(has_prospects(np.array(recent, dtype=np.float64), n_remaining, best)) is expected


def test_rounding_is_no_progress() -> None:
    scores = np.array([0.1 + 0.2, 0.3, 0.1 + 0.2, 0.1 + 0.2])

    assert not has_prospects(scores, 10**6, -1.0)
