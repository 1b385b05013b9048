from __future__ import annotations

import pytest

from relforest.experiments.mil.published import Published
from relforest.experiments.mil.sheets import (
    Sheet,
    published_score,
    published_time,
    score_text,
    time_decimals,
    time_text,
)
from relforest.metrics import Moments


def test_scores_are_printed_as_in_the_source() -> None:
    # t(.975; 9) = 2.2622; .3 / sqrt 10 * 2.2622 = .2146
    assert score_text(Moments(0.456, 0.3, 10), ">") == "> 0.46 \u00b1 0.21"
    assert score_text(Moments(0.0, 0.0, 10), ">") == "> 0.00"
    assert score_text(Moments(-0.001, 0.0, 10)) == "0.00"
    assert score_text(None, ">") == "-"
    assert published_score(Published(-0.06, 0.08, ">")) == "> -0.06 \u00b1 0.08"
    assert published_score(Published(None)) == "-"
    assert published_score(None) == ""
    # An interval that is 0.00 when rounded is not one without variance.
    assert published_score(Published(0.19, 0.0, ">")) == "> 0.19 \u00b1 0.00"
    assert published_score(Published(0.0, None, ">")) == "> 0.00"


@pytest.mark.parametrize(
    ("seconds", "decimals"),
    [(1358, 0), (36.0, 1), (10.2, 1), (4.21, 2), (0.47, 2), (0.047, 3), (1e-7, 4), (0, 2)],
)
def test_times_have_as_many_digits_as_in_the_source(seconds: float, decimals: int) -> None:
    assert time_decimals(seconds) == decimals


def test_times_are_printed_as_in_the_source() -> None:
    assert published_time(Published(4157.0, 1244.0, "<")) == "< 4157 \u00b1 1244"
    assert published_time(Published(32.6, 5.2)) == "32.6 \u00b1 5.2"
    # t(.975; 99) = 1.98422; .0008 / 10 * 1.98422 = .00016
    assert time_text(Moments(0.0041, 0.0008, 100)) == "0.0041 \u00b1 0.0002"
    assert time_text(None) == "-"


def test_a_sheet_is_text_and_markdown() -> None:
    sheet = Sheet("Scores", ("", "one"), (("a", "< 0.10 \u00b1 0.20"), ("b", "-")))

    assert sheet.to_text() == "Scores\n              one\na  < 0.10 +- 0.20\nb               -"
    assert sheet.to_markdown() == (
        "Scores\n\n|  | one |\n| --- | ---: |\n| a | &lt; 0.10 \u00b1 0.20 |\n| b | - |"
    )
