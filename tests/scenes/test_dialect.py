from __future__ import annotations

from typing import Any

import pytest

from relforest.scenes.dialect import Dialect, detected_separator
from relforest.support.errors import InputError


@pytest.mark.parametrize(
    ("text", "separator"),
    [
        ("a,b\n1,2\n", ","),
        ("a;b\n0,5;1,5\n", ";"),
        ("a\tb\n1,2\t3\n", "\t"),
        ("\n\na|b\n1|2\n", "|"),
        ('"a,b";c\n1;2\n', ";"),
        # Both split the first line, but only one the second.
        ("a (x,y);b\n1;2\n", ";"),
        ("a,b;c\n1,2\n", ","),
        # Both split all lines: a comma is what the name of the format says.
        ("a,b;c\n1,2;3\n", ","),
        # None fits all lines: the row that does not is to be named.
        ("a;b,c\n1;2;3\n", ","),
        ("a\n1\n", ","),
        ("", ","),
        ('"a;b', ","),
        ("a;b\n" + "1;2\n" * 40_000, ";"),
    ],
)
def test_the_separator_is_found_out(text: str, separator: str) -> None:
    assert detected_separator(text) == separator


@pytest.mark.parametrize("name", ["\t", "\\t", "tab"])
def test_a_tab_can_be_named(name: str) -> None:
    assert Dialect(separator=name).separator == "\t"


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"separator": ";;"}, "separator must be one character, such as ',' or ';' or 'tab', got ';;'"),
        ({"separator": ""}, "separator must be one character"),
        ({"separator": '"'}, "separator must be one character"),
        ({"separator": "\n"}, "separator must be one character"),
        ({"separator": "é"}, "separator must be one character"),
        ({"separator": 1}, "separator must be one character"),
        ({"decimal": ";"}, "decimal must be one of '.', ',', got ';'"),
        ({"decimal": ",", "separator": ","}, "separator and decimal are both ','"),
        ({"encoding": 8}, "encoding must be the name of an encoding, got 8"),
    ],
)
def test_other_options_are_refused(options: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        Dialect(**options)
