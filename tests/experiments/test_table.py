from __future__ import annotations

import numpy as np
import pytest

from relforest.experiments.table import Row, Table
from relforest.support.errors import InputError

ROWS: list[Row] = [
    {"set": "a", "pair": 0, "score": 0.1, "done": True},
    {"set": "b", "pair": 0, "score": 0.25, "done": False},
    {"set": "a", "pair": 1, "score": None, "done": True},
]


def test_a_table_gives_its_columns_as_numbers_with_nan_for_empty_cells() -> None:
    table = Table.of(ROWS)

    np.testing.assert_array_equal(table.numbers("score"), [0.1, 0.25, np.nan])
    np.testing.assert_array_equal(table.numbers("done"), [1.0, 0.0, 1.0])
    assert len(table) == 3
    assert table.columns == ("set", "pair", "score", "done")


def test_rows_are_chosen_by_value_in_their_order() -> None:
    table = Table.of(ROWS)

    assert table.where(set="a").cells("pair") == [0, 1]
    assert table.where(set="a", pair=1).cells("score") == [None]
    assert table.distinct("set") == ["a", "b"]


def test_rows_are_grouped_by_their_values() -> None:
    table = Table.of(ROWS)

    assert {key: own.cells("pair") for key, own in table.groups("set").items()} == {
        ("a",): [0, 1],
        ("b",): [0],
    }
    assert list(table.groups("pair", "set")) == [(0, "a"), (0, "b"), (1, "a")]


def test_csv_is_read_back_exactly() -> None:
    texts: list[Row] = [{"text": 'says "so",\nthen', "number": 0.1 + 0.2, "count": 3}]
    for rows in (ROWS, texts):
        read = Table.from_csv(Table.of(rows).to_csv())
        assert list(read.rows) == rows
        assert [list(map(type, row.values())) for row in read.rows] == [
            list(map(type, row.values())) for row in rows
        ]


@pytest.mark.parametrize(
    ("action", "message"),
    [
        (lambda: Table.of([]), "at least one row"),
        (lambda: Table.of([{"a": 1}, {"b": 1}]), "row 1 has the columns b, but the first a"),
        (lambda: Table.of(ROWS).cells("pss"), "not have a column 'pss', only set, pair, score, done"),
        (lambda: Table.of(ROWS).numbers("set"), r"column 'set' contains text \('a'\)"),
        (lambda: Table.of(ROWS).where(set="c", pair=0), "no row has set = 'c', pair = 0"),
        (lambda: Table.from_csv(""), "not a table with a header"),
        (lambda: Table.from_csv('a,b\n"1'), "not a table with a header"),
        (lambda: Table.from_csv("a,b\n"), "at least one row"),
        (lambda: Table.from_csv("a,b\n1,2\n3\n"), "row 2 has 1 cells, but the header 2"),
    ],
)
def test_what_a_table_does_not_have_is_named(action: object, message: str) -> None:
    assert callable(action)
    with pytest.raises(InputError, match=message):
        action()
