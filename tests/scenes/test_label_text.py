from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from relforest.scenes.label_text import parsed_label, parsed_labels


@pytest.mark.parametrize(
    ("texts", "expected"),
    [
        (["1", "0", "1"], [1, 0, 1]),
        (["-1", "12"], [-1, 12]),
        (["true", "false"], [True, False]),
        (["TRUE", "TRUE"], [True, True]),
        (["0.5", "1", "-2.0"], [0.5, 1.0, -2.0]),
    ],
)
def test_labels_that_are_written_as_usual_become_values(texts: list[str], expected: list[Any]) -> None:
    found = parsed_labels(np.array(texts, dtype=object)).tolist()

    assert found == expected
    assert list(map(type, found)) == list(map(type, expected))


@pytest.mark.parametrize(
    "texts",
    [
        ["01", "1"],
        ["1", "1.0"],
        ["0.0", "-0.0"],
        ["1e3", "1000"],
        ["+1", "-1"],
        ["true", "True"],
        ["1", "true"],
        ["yes", "no"],
        ["nan", "0.5"],
        ["1" * 30, "2"],
        [],
    ],
)
def test_labels_from_which_something_would_be_lost_stay_text(texts: list[str]) -> None:
    assert parsed_labels(np.array(texts, dtype=object)).tolist() == texts


def test_other_labels_stay_as_they_are() -> None:
    assert parsed_labels(np.array(["1", 2], dtype=object)).tolist() == ["1", 2]
    assert parsed_label("1") == 1
    assert parsed_label("01") == "01"
