from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from relforest.scenes.color import srgb_to_lab
from relforest.worlds.blocks.color import ciede2000

# L1 a1 b1 L2 a2 b2 difference: the 34 pairs of Sharma, Wu, and Dalal (2005), table 1.
PUBLISHED = np.array(
    [
        (50.0000, 2.6772, -79.7751, 50.0000, 0.0000, -82.7485, 2.0425),
        (50.0000, 3.1571, -77.2803, 50.0000, 0.0000, -82.7485, 2.8615),
        (50.0000, 2.8361, -74.0200, 50.0000, 0.0000, -82.7485, 3.4412),
        (50.0000, -1.3802, -84.2814, 50.0000, 0.0000, -82.7485, 1.0000),
        (50.0000, -1.1848, -84.8006, 50.0000, 0.0000, -82.7485, 1.0000),
        (50.0000, -0.9009, -85.5211, 50.0000, 0.0000, -82.7485, 1.0000),
        (50.0000, 0.0000, 0.0000, 50.0000, -1.0000, 2.0000, 2.3669),
        (50.0000, -1.0000, 2.0000, 50.0000, 0.0000, 0.0000, 2.3669),
        (50.0000, 2.4900, -0.0010, 50.0000, -2.4900, 0.0009, 7.1792),
        (50.0000, 2.4900, -0.0010, 50.0000, -2.4900, 0.0010, 7.1792),
        (50.0000, 2.4900, -0.0010, 50.0000, -2.4900, 0.0011, 7.2195),
        (50.0000, 2.4900, -0.0010, 50.0000, -2.4900, 0.0012, 7.2195),
        (50.0000, -0.0010, 2.4900, 50.0000, 0.0009, -2.4900, 4.8045),
        (50.0000, -0.0010, 2.4900, 50.0000, 0.0010, -2.4900, 4.8045),
        (50.0000, -0.0010, 2.4900, 50.0000, 0.0011, -2.4900, 4.7461),
        (50.0000, 2.5000, 0.0000, 50.0000, 0.0000, -2.5000, 4.3065),
        (50.0000, 2.5000, 0.0000, 73.0000, 25.0000, -18.0000, 27.1492),
        (50.0000, 2.5000, 0.0000, 61.0000, -5.0000, 29.0000, 22.8977),
        (50.0000, 2.5000, 0.0000, 56.0000, -27.0000, -3.0000, 31.9030),
        (50.0000, 2.5000, 0.0000, 58.0000, 24.0000, 15.0000, 19.4535),
        (50.0000, 2.5000, 0.0000, 50.0000, 3.1736, 0.5854, 1.0000),
        (50.0000, 2.5000, 0.0000, 50.0000, 3.2972, 0.0000, 1.0000),
        (50.0000, 2.5000, 0.0000, 50.0000, 1.8634, 0.5757, 1.0000),
        (50.0000, 2.5000, 0.0000, 50.0000, 3.2592, 0.3350, 1.0000),
        (60.2574, -34.0099, 36.2677, 60.4626, -34.1751, 39.4387, 1.2644),
        (63.0109, -31.0961, -5.8663, 62.8187, -29.7946, -4.0864, 1.2630),
        (61.2901, 3.7196, -5.3901, 61.4292, 2.2480, -4.9620, 1.8731),
        (35.0831, -44.1164, 3.7933, 35.0232, -40.0716, 1.5901, 1.8645),
        (22.7233, 20.0904, -46.6940, 23.0331, 14.9730, -42.5619, 2.0373),
        (36.4612, 47.8580, 18.3852, 36.2715, 50.5065, 21.2231, 1.4146),
        (90.8027, -2.0831, 1.4410, 91.1528, -1.6435, 0.0447, 1.4441),
        (90.9257, -0.5406, -0.9208, 88.6381, -0.8985, -0.7239, 1.5381),
        (6.7747, -0.2908, -2.4247, 5.8714, -0.0985, -2.2286, 0.6377),
        (2.0776, 0.0795, -1.1350, 0.9033, -0.0636, -0.5514, 0.9082),
    ]
)

labs = arrays(np.float64, 3, elements=st.floats(-100.0, 100.0))


def test_the_published_pairs_differ_as_published() -> None:
    found = ciede2000(PUBLISHED[:, :3], PUBLISHED[:, 3:6])
    np.testing.assert_allclose(found, PUBLISHED[:, 6], atol=5.1e-5, rtol=0.0)


def test_scikit_image_agrees() -> None:
    peer = pytest.importorskip("skimage.color")
    rgb = np.random.default_rng(0).random((500, 3))
    rgb[:4] = (0.0, 0.0, 0.0), (1.0, 1.0, 1.0), (0.04, 0.04045, 0.041), (1.0, 0.0, 0.0)
    lab = srgb_to_lab(rgb)
    # It rounds the constants of the linear part near black.
    np.testing.assert_allclose(lab, peer.rgb2lab(rgb), atol=2e-4)
    np.testing.assert_allclose(ciede2000(lab, lab[::-1]), peer.deltaE_ciede2000(lab, lab[::-1]), atol=1e-9)


@given(labs, labs)
def test_the_difference_is_symmetric_and_not_negative(one: np.ndarray, other: np.ndarray) -> None:
    there, back = ciede2000(one, other), ciede2000(other, one)
    assert there >= 0.0
    assert there == pytest.approx(back, rel=1e-9, abs=1e-9)
    assert ciede2000(one, one) == 0.0


def test_leading_dimensions_are_broadcast() -> None:
    lab = srgb_to_lab(np.random.default_rng(1).random((4, 3)))
    table = ciede2000(lab[:, np.newaxis], lab)
    assert table.shape == (4, 4)
    assert table[1, 3] == ciede2000(lab[1], lab[3])


def test_random_colors_differ_as_the_thresholds_of_the_task_presume() -> None:
    # Uniform RGB: a distance of 30 is near the 25th percentile, the median near 45, 120 out of reach.
    rgb = np.random.default_rng(2).random((20_000, 2, 3))
    lab = srgb_to_lab(rgb)
    found = ciede2000(lab[:, 0], lab[:, 1])
    assert np.quantile(found, (0.25, 0.5)) == pytest.approx((28.1, 43.0), abs=0.6)
    assert 100.0 < found.max() < 120.0
