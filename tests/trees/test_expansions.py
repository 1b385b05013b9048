"""Which questions are tried at a leaf, listed in full for small cases."""

from __future__ import annotations

from collections import Counter
from itertools import permutations

import pytest

from relforest.mappings import Mapping, catalogue
from relforest.trees.expansions import Expansion, expansions
from small_trees import plane

ALL = catalogue(plane())
SHORT = {
    "identity(location)": "i",
    "distance(location)": "d",
    "difference(location)": "-",
    "reframe(location)": "r",
    "scaled_reframe(location)": "s",
}


def listed(n_bound: int, n_parameters: int, mappings: tuple[Mapping, ...] = ALL) -> list[str]:
    """Such as "2 dAB": two new variables, distance of A and B."""
    return [
        f"{each.n_new} {SHORT[each.mapping.name]}{''.join('ABCDEFG'[v] for v in each.variables)}"
        for each in expansions(mappings, n_bound, n_parameters)
    ]


def frames(n_new: int, names: str) -> list[str]:
    """All orders of the unscaled frame, and those of the scaled one whose first two are in order."""
    orders = ["".join(order) for order in permutations(names)]
    kept = [order for order in orders if order[0] < order[1]]
    return [f"{n_new} r{order}" for order in orders] + [f"{n_new} s{order}" for order in kept]


def test_at_the_root_without_arguments() -> None:
    assert listed(0, 0) == ["1 iA", "2 dAB", "2 -AB", *frames(3, "ABC")]


def test_with_one_variable_bound() -> None:
    assert listed(1, 0) == [
        "0 iA",
        "1 iB",
        "1 dAB",
        "1 -AB",
        *["2 dBC", "2 -BC", *frames(2, "ABC")],
        *frames(3, "BCD"),
    ]


def test_with_two_arguments_that_need_not_be_asked_about() -> None:
    # Section 6.2: from the third variable on, questions must refer to every new variable; A and B are exempt.
    assert listed(0, 2) == [
        "1 iA",
        *["2 iB", "2 dAB", "2 -AB"],
        *["3 iC", "3 dAC", "3 dBC", "3 -AC", "3 -BC", *frames(3, "ABC")],
        *["4 dCD", "4 -CD", "4 rACD", "4 rADC", "4 rCAD", "4 rCDA", "4 rDAC", "4 rDCA"],
        *["4 rBCD", "4 rBDC", "4 rCBD", "4 rCDB", "4 rDBC", "4 rDCB"],
        *["4 sACD", "4 sADC", "4 sCDA", "4 sBCD", "4 sBDC", "4 sCDB"],
        *frames(5, "CDE"),
    ]


def test_an_argument_that_is_bound_later() -> None:
    # One of two arguments is bound: the question with one new variable is about B, the last one bound.
    assert listed(1, 2)[:4] == ["0 iA", "1 iB", "1 dAB", "1 -AB"]


def test_with_all_arguments_bound() -> None:
    assert listed(2, 2)[:9] == ["0 iA", "0 iB", "0 dAB", "0 -AB", "1 iC", "1 dAC", "1 dBC", "1 -AC", "1 -BC"]


def test_a_mapping_that_needs_more_variables_than_the_first_step_binds() -> None:
    only_distance = catalogue(plane(operations=("distance",)))

    assert listed(0, 0, only_distance) == ["2 dAB"]
    assert listed(1, 0, only_distance) == ["1 dAB", "2 dBC"]


@pytest.mark.parametrize(
    ("n_bound", "n_parameters"), [(0, 0), (1, 0), (2, 0), (3, 0), (0, 1), (0, 3), (2, 2), (4, 2)]
)
def test_nothing_is_asked_twice_and_every_new_variable_is_used(n_bound: int, n_parameters: int) -> None:
    found = list(expansions(ALL, n_bound, n_parameters))
    asked = Counter((each.mapping.name, each.variables, each.n_new) for each in found)

    assert max(asked.values()) == 1
    # Fewer new variables come first.
    assert [each.n_new for each in found] == sorted(each.n_new for each in found)
    for each in found:
        last = n_bound + each.n_new
        new = {v for v in range(n_bound, last) if v >= n_parameters}
        assert new <= set(each.variables) <= set(range(last))
        if each.n_new:
            assert last - 1 in each.variables


def test_the_same_question_is_never_asked_with_superfluous_variables() -> None:
    # (mapping, variables) determine how many variables must be bound.
    found = [(each.mapping.name, each.variables) for each in expansions(ALL, 0, 2)]

    assert len(found) == len(set(found))


def test_questions_that_exchange_new_variables_have_one_pattern() -> None:
    found = list(expansions(ALL, 2, 0))
    by_pattern: dict[Expansion, list[str]] = {}
    for each in found:
        by_pattern.setdefault(each.pattern(2), []).append("".join("ABCDE"[v] for v in each.variables))

    # Of the frames of A, C and D, those with C and D in either order; of C, D and E, all.
    reframes = [names for pattern, names in by_pattern.items() if pattern.mapping.name == "reframe(location)"]
    assert [names for names in reframes if set(names[0]) == set("ACD")] == [
        ["ACD", "ADC"],
        ["CAD", "DAC"],
        ["CDA", "DCA"],
    ]
    assert [len(names) for names in reframes if set(names[0]) == set("CDE")] == [6]
    # Variables that are bound are different objects of a sequence, which earlier answers tell apart.
    assert [names for names in reframes if set(names[0]) == set("ABC")] == [
        [order] for order in ("ABC", "ACB", "BAC", "BCA", "CAB", "CBA")
    ]


def test_without_mappings_there_is_nothing_to_ask() -> None:
    assert listed(2, 0, ()) == []
    assert listed(0, 2, ()) == []
