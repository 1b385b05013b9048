from __future__ import annotations

import numpy as np

from relforest.scenes.color import srgb_to_lab


def test_white_black_and_red_have_their_textbook_coordinates() -> None:
    # Lindbloom's calculator gives red as 53.24, 80.09, 67.20 (sRGB, D65).
    lab = srgb_to_lab([(1.0, 1.0, 1.0), (0.0, 0.0, 0.0), (1.0, 0.0, 0.0)])
    np.testing.assert_allclose(lab, [(100, 0, 0), (0, 0, 0), (53.24, 80.09, 67.20)], atol=0.01)


def test_what_is_undefined_stays_so() -> None:
    assert np.isnan(srgb_to_lab([(np.nan, np.nan, np.nan)])).all()
