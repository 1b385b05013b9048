from __future__ import annotations

import math

import numpy as np
import pytest

from relforest.experiments.sheets import Entry, Estimate, Format, Sheet, Span


def written(entry: Entry, form: Format) -> str:
    """Return the last word of a table with one entry."""
    return (
        Sheet("", {"": "", "x": form}, (("row", entry),))
        .to_markdown()
        .split("| row | ")[1]
        .removesuffix(" |")
    )


@pytest.mark.parametrize(
    ("entry", "form", "text"),
    [
        (None, ".2f", ""),
        ("a", ".2f", "a"),
        (12345, ".2f", "12345"),
        (True, ".2f", "yes"),
        (0.5, ".2f", "0.50"),
        (-0.001, ".2f", "0.00"),
        (math.nan, ".2f", "-"),
        (1234.5, lambda value: ".0f" if value > 100 else ".2f", "1234"),
        (Span(0.03, 0.072), ".3f", "0.030 to 0.072"),
        (Estimate(0.456, 0.2146), ".2f", "0.46 \u00b1 0.21"),
        (Estimate(0.0, None, ">"), ".2f", "> 0.00"),
        (Estimate(-0.06, 0.08, "<"), ".2f", "&lt; -0.06 \u00b1 0.08"),
        # An interval that is 0.00 when rounded is not one without variance.
        (Estimate(0.19, 0.0, ">"), ".2f", "> 0.19 \u00b1 0.00"),
        (Estimate(math.nan, None, ">"), ".2f", "> -"),
        (Estimate(0.2, 0.1), "+.1f", "+0.2 \u00b1 0.1"),
        # The spread has the decimals of the value.
        (Estimate(1358.0, 5.27), lambda value: ".0f" if value > 100 else ".2f", "1358 \u00b1 5"),
    ],
)
def test_every_kind_of_entry_is_written(entry: Entry, form: Format, text: str) -> None:
    assert written(entry, form) == text


def test_a_sheet_is_text_and_markdown() -> None:
    sheet = Sheet("Scores", {"": "", "one": ".2f"}, (("a", Estimate(0.1, 0.2, "<")), ("b", math.nan)))

    assert sheet.to_text() == "Scores\n              one\na  < 0.10 +- 0.20\nb               -"
    assert sheet.to_markdown() == (
        "Scores\n\n|  | one |\n| --- | ---: |\n| a | &lt; 0.10 \u00b1 0.20 |\n| b | - |"
    )


def test_a_row_has_an_entry_per_column() -> None:
    with pytest.raises(ValueError, match="zip"):
        Sheet("", {"": "", "x": ""}, (("a",),)).to_text()


def test_the_mean_of_values_has_a_normal_interval() -> None:
    # The deviation of 1 and 5 is sqrt(8); 1.96 * sqrt(8) / sqrt(2) = 3.92.
    found = Estimate.of(np.array([1.0, 5.0]))

    assert found.value == 3.0
    assert found.low == pytest.approx(-0.92)
    assert Estimate.of(np.array([2.0])) == Estimate(2.0)
    assert math.isnan(Estimate.of(np.empty(0)).value)


def test_intervals_of_differences_add_as_squares() -> None:
    assert Estimate(5.0, 3.0).minus(Estimate(1.0, 4.0)) == Estimate(4.0, 5.0)
    assert math.isnan(Estimate(5.0, 3.0).minus(Estimate(1.0)).low)
