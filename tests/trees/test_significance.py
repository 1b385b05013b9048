from __future__ import annotations

import pytest
from scipy import stats

from relforest.mappings import Mapping
from relforest.scenes import Attribute
from relforest.trees.significance import added_parameters, likelihood_ratio_p, sidak


@pytest.mark.parametrize(
    ("operation", "attribute", "expected"),
    [
        # Centre d, shape and size d (d + 1) / 2, one more leaf: 1 + 1 + 1, 2 + 3 + 1, 3 + 6 + 1.
        ("identity", Attribute("weight"), 3),
        ("distance", Attribute("location", 2), 3),
        ("identity", Attribute("location", 2), 6),
        ("difference", Attribute("location", 2), 6),
        ("scaled_reframe", Attribute("location", 2), 6),
        ("identity", Attribute("color", 3), 10),
        # Centre and width of an arc.
        ("identity", Attribute("orientation"), 3),
    ],
)
def test_added_parameters_by_hand(operation: str, attribute: Attribute, expected: int) -> None:
    mapping = Mapping(operation, attribute)

    assert added_parameters(mapping, has_errors=False) == expected
    # The Error leaf is one more.
    assert added_parameters(mapping, has_errors=True) == expected + 1


def test_parameters_of_other_shapes_by_hand() -> None:
    color, weight = Mapping("identity", Attribute("color", 3)), Mapping("identity", Attribute("weight"))

    # Centre and width for each of three; which one, its centre and its width; and one more leaf.
    assert added_parameters(color, has_errors=False, shape="diagonal") == 7
    assert added_parameters(color, has_errors=False, shape="axis") == 4
    assert added_parameters(weight, has_errors=False, shape="diagonal") == 3
    assert added_parameters(weight, has_errors=True, shape="axis") == 4


@pytest.mark.parametrize("gain", [0.0, 0.5, 3.0, 12.6, 100.0, 700.0])
@pytest.mark.parametrize("n_parameters", [3, 6, 10])
def test_the_tail_of_chi_square(gain: float, n_parameters: int) -> None:
    assert likelihood_ratio_p(gain, n_parameters) == pytest.approx(
        float(stats.chi2.sf(2 * gain, n_parameters)), rel=1e-9
    )


def test_literals_of_the_chi_square_table() -> None:
    # 95 % points: 12.592 for 6 and 7.815 for 3 degrees of freedom.
    assert likelihood_ratio_p(12.592 / 2, 6) == pytest.approx(0.05, abs=1e-5)
    assert likelihood_ratio_p(7.815 / 2, 3) == pytest.approx(0.05, abs=1e-5)


def test_a_loss_proves_nothing() -> None:
    assert likelihood_ratio_p(-5.0, 6) == 1
    assert likelihood_ratio_p(0.0, 6) == 1


def test_sidak_by_hand() -> None:
    assert sidak(0.05, 1) == pytest.approx(0.05)
    # 1 - sqrt(.95) and 1 - .95^(1/10).
    assert sidak(0.05, 2) == pytest.approx(0.0253205655)
    assert sidak(0.05, 10) == pytest.approx(0.0051161969)


@pytest.mark.parametrize("n_tests", [1, 7, 1000])
def test_the_chance_that_one_of_the_tests_errs_is_alpha(n_tests: int) -> None:
    assert 1 - (1 - sidak(0.05, n_tests)) ** n_tests == pytest.approx(0.05)
