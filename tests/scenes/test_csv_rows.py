from __future__ import annotations

import pytest

from relforest.scenes.csv_rows import csv_rows
from relforest.support.errors import InputError

TEXT = 'a,b\r\n\n"1\n2", "x, y"\né,4'.encode()


def test_rows_know_their_lines() -> None:
    assert list(csv_rows(TEXT, ",", "t.csv", skip_blanks=True)) == [
        (1, 1, ["a", "b"]),
        (3, 4, ["1\n2", "x, y"]),
        (5, 5, ["é", "4"]),
    ]


def test_fields_of_boundless_length_are_refused() -> None:
    with pytest.raises(
        InputError, match=r"t\.csv, line 2: a field is longer than 131072 characters: close each"
    ):
        list(csv_rows(b"a\n" + b"x" * 200_000, ",", "t.csv"))
