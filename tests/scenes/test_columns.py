from __future__ import annotations

from typing import Any

import pandas as pd
import polars as pl
import pyarrow as pa
import pytest

from relforest.scenes import Scenes
from relforest.scenes.columns import check_named, listed, open_frame
from relforest.support.errors import InputError

REPEATED = pa.table([[1, 2], [0.5, 1.5], ["a", "b"], [None, "c"]], names=["s", "x", "note", "note"])


@pytest.mark.parametrize("frame", [REPEATED, REPEATED.to_pandas()], ids=["pyarrow", "pandas"])
def test_columns_that_are_not_used_may_have_the_same_name(frame: Any) -> None:
    assert Scenes.from_frame(frame, scene="s", attributes={"x": "x"}).matrix.tolist() == [[0.5], [1.5]]
    with pytest.raises(InputError, match="2 columns of the table are named 'note': rename all but one"):
        open_frame(frame, ["s", "note"])


@pytest.mark.parametrize("library", [pd.DataFrame, pl.DataFrame, pa.table])
def test_columns_that_are_not_used_may_hold_anything(library: Any) -> None:
    frame = library({"s": [1, 2], "x": [0.5, 1.5], "lists": [[1], [2, 3]]})

    assert len(Scenes.from_frame(frame, scene="s", attributes={"x": "x"})) == 2


def test_long_lists_are_cut() -> None:
    assert listed([1, "a"]) == "1, 'a'"
    assert listed(range(10)) == "0, 1, 2, 3, 4, 5, 6, 7 and 2 more"


def test_names_in_another_encoding_lead_to_a_hint() -> None:
    with pytest.raises(InputError, match=r"column 'größe' is missing from f\.csv, which has .*\(pass the"):
        check_named(["größe"], ["gr\udcf6\udcdfe"], "f.csv")
    with pytest.raises(InputError, match=r"column 'a' is missing from f\.csv, which has no columns$"):
        check_named(["a"], [], "f.csv")
