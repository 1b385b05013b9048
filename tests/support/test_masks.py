from __future__ import annotations

import numpy as np
import pytest

from relforest.support.errors import InputError
from relforest.support.masks import refuse_masked

PARTLY = np.ma.masked_equal([1.0, 2.0], 2.0)


@pytest.mark.parametrize("values", [PARTLY, [PARTLY], [[0.0], (PARTLY,)], [[1.0, np.ma.masked]]])
def test_masked_values_are_refused_wherever_they_are(values: object) -> None:
    with pytest.raises(InputError, match="bag 3 has masked values: leave them out or fill them in"):
        refuse_masked(values, "bag 3")


@pytest.mark.parametrize("values", [np.ma.masked_array([1.0]), [[1.0]], np.array([1.0]), "text", None])
def test_anything_else_is_not(values: object) -> None:
    refuse_masked(values, "bag 3")
