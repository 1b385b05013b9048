"""Conditions in words."""

from __future__ import annotations

import math

import numpy as np
import pytest

from forest_scenes import ATTRIBUTES, random_condition
from relforest.forests import Condition
from relforest.forests.statements import Bound, Is, Near, Statement
from relforest.forests.words import sentence
from relforest.mappings import Mapping
from relforest.scenes import Schema

SCHEMA = Schema(ATTRIBUTES, ["passer", "target"])


def said(operation: str, attribute: str, variables: tuple[int, ...], test: Bound | Near | Is) -> str:
    """The sentence of one statement; 0 is the passer, 1 the target, 2 some object."""
    statement = Statement(Mapping(operation, SCHEMA[attribute]), variables, test)
    return sentence(Condition(int(2 in variables), (statement,)), SCHEMA)


@pytest.mark.parametrize(
    ("operation", "attribute", "variables", "test", "expected"),
    [
        ("identity", "location", (2,), Bound(1, "at most", 7.5), "some object has y at most 7.5"),
        ("identity", "weight", (2,), Near(0, (4.0,), (1.0,)), "some object has weight between 3 and 5"),
        ("identity", "team", (2,), Is(1), "some object has team guest"),
        ("identity", "team", (2,), Is(1, negated=True), "some object does not have team guest"),
        ("same", "team", (0, 2), Is(1), "some object has the same team as the passer"),
        ("same", "team", (0, 2), Is(0), "some object has another team than the passer"),
        ("same", "team", (0, 2), Is(1, negated=True), "some object has another team than the passer"),
        ("distance", "location", (0, 2), Bound(0, "at most", 3.0), "some object is within 3 of the passer"),
        (
            "distance",
            "location",
            (0, 1),
            Bound(0, "at least", 3.0),
            "the target is at least 3 from the passer",
        ),
        (
            "distance",
            "weight",
            (0, 2),
            Near(0, (3.0,), (1.0,)),
            "some object is between 2 and 4 from the passer in weight",
        ),
        ("distance", "location", (0, 2), Bound(0, "at most", 0.0), "some object is where the passer is"),
        ("distance", "weight", (0, 2), Bound(0, "at most", 0.0), "some object is like the passer in weight"),
        (
            "bearing",
            "location",
            (0, 1, 2),
            Bound(0, "at most", 0.0),
            "some object is seen from the passer in the direction of the target",
        ),
        # Ends that no value can pass are not mentioned.
        ("distance", "location", (0, 2), Near(0, (1.0,), (2.0,)), "some object is within 3 of the passer"),
        (
            "scaled_distance",
            "location",
            (0, 1, 2),
            Near(0, (0.5,), (0.75,)),
            "some object is at most 1.25 times as far from the passer as the target is",
        ),
        *(
            (
                "bearing",
                "location",
                (0, 1, 2),
                Near(0, (math.pi / 2,), (radius,)),
                f"some object is seen from the passer {angles} degrees away from the target",
            )
            for radius, angles in ((1.0, "between 32.7 and 147"), (2.0, "at least 0"))
        ),
        (
            "bearing",
            "location",
            (0, 1, 2),
            Near(0, (3.0,), (1.0,)),
            "some object is seen from the passer at least 115 degrees away from the target",
        ),
        (
            "difference",
            "location",
            (0, 2),
            Bound(0, "at least", 2.0),
            "some object has x at least 2 above that of the passer",
        ),
        (
            "difference",
            "location",
            (0, 2),
            Bound(0, "at most", -2.0),
            "some object has x at least 2 below that of the passer",
        ),
        (
            "difference",
            "location",
            (0, 2),
            Bound(1, "at most", 2.0, absolute=True),
            "some object has y within 2 of that of the passer",
        ),
        (
            "difference",
            "location",
            (0, 2),
            Bound(1, "at least", 2.0, absolute=True),
            "some object differs in y by at least 2 from the passer",
        ),
        (
            "reframe",
            "location",
            (0, 1, 2),
            Bound(1, "at most", 3.0, absolute=True),
            "some object is within 3 of the line from the passer to the target",
        ),
        (
            "reframe",
            "location",
            (0, 1, 2),
            Bound(0, "at most", -1.0),
            "some object is at least 1 behind the passer, facing the target",
        ),
        (
            "reframe",
            "location",
            (0, 1, 2),
            Bound(1, "at least", 1.0),
            "some object is at least 1 left of the line from the passer to the target",
        ),
        (
            "scaled_reframe",
            "location",
            (0, 1, 2),
            Near(0, (0.8,), (0.2,)),
            "some object is between 0.6 and 1 of the way from the passer to the target",
        ),
        (
            "bearing",
            "location",
            (0, 1, 2),
            Bound(0, "at most", np.pi / 6),
            "some object is seen from the passer at most 30 degrees away from the target",
        ),
        (
            "scaled_distance",
            "location",
            (0, 1, 2),
            Bound(0, "at most", 0.5),
            "some object is at most 0.5 times as far from the passer as the target is",
        ),
        (
            "difference",
            "location",
            (0, 2),
            Near(0, (4.0, 0.0), (2.0, 1.0)),
            "some object is in the ellipse around (4, 0) with half-axes 2 and 1, the passer at (0, 0)",
        ),
    ],
)
def test_statements(
    operation: str, attribute: str, variables: tuple[int, ...], test: Bound | Near | Is, expected: str
) -> None:
    assert said(operation, attribute, variables, test) == expected


def test_several_statements_and_objects() -> None:
    near = Statement(Mapping("distance", SCHEMA["location"]), (0, 2), Bound(0, "at most", 3.0))
    other = Statement(Mapping("same", SCHEMA["team"]), (0, 2), Is(0))
    pass_ = Statement(Mapping("distance", SCHEMA["location"]), (0, 1), Bound(0, "at least", 9.0))
    pair = Statement(Mapping("distance", SCHEMA["location"]), (2, 3), Bound(0, "at most", 1.0))

    assert sentence(Condition(1, (near, other, pass_)), SCHEMA) == (
        "some object with another team than the passer is within 3 of the passer; the target is at "
        "least 9 from the passer"
    )
    assert sentence(Condition(1, (near, other), 2), SCHEMA) == (
        "there are at least 2 objects C such that C is within 3 of the passer and C has another team than "
        "the passer"
    )
    assert sentence(Condition(2, (near, pair)), SCHEMA) == (
        "there are objects C and D such that C is within 3 of the passer and D is within 1 of C"
    )


@pytest.mark.parametrize("n_parameters", [0, 1, 2])
def test_every_condition_can_be_said(n_parameters: int) -> None:
    rng = np.random.default_rng(n_parameters)
    schema = Schema(ATTRIBUTES, ["passer", "receiver"][:n_parameters])
    texts = [sentence(random_condition(rng, n_parameters), schema) for _ in range(300)]

    assert all(text.strip() == text and "  " not in text and "inf" not in text for text in texts)
