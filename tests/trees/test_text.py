"""Every sentence a tree can say, word for word."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest

from relforest.mappings import Mapping
from relforest.scenes import Attribute, Schema
from relforest.trees import Instantiation, Leaf, Node, Question, Tree
from relforest.trees.text import fresh_variables, leaf_summary, sentence
from relforest.volumes import Arc, Ellipsoid, Volume
from small_trees import ball, leaf, plane

LOCATION = Attribute("location", 2)
HEADING = Attribute("heading", 1, "angle", ("identity", "difference"))


def upright(mean: Sequence[float], half_widths: Sequence[float], radius: float = 1.0) -> Ellipsoid:
    """Reaches `half_widths` along the axes (times the radius)."""
    return Ellipsoid(np.array(mean, dtype=np.float64), np.diag(np.square(half_widths)), radius, 3, 0.1)


def said(
    operation: str,
    attribute: Attribute,
    variables: tuple[int, ...],
    volume: Volume,
    fresh: tuple[int, ...] = (),
) -> str:
    return sentence(Question(Mapping(operation, attribute), variables, volume, 1, 2, 3), fresh)


FLAT = upright([1.5, -2], [2, 1])
FLAT_SAID = "near (1.5, -2), reaching 2 along (1, 0) and 1 along (0, 1)"
COLOR_REACH = "reaching 0.3 along (0, 0, 1), 0.2 along (0, 1, 0) and 0.1 along (1, 0, 0)"
RING = upright([5], [2])


@pytest.mark.parametrize(
    ("operation", "attribute", "variables", "volume", "expected"),
    [
        ("identity", LOCATION, (0,), FLAT, f"A has location {FLAT_SAID}"),
        ("identity", Attribute("weight"), (1,), RING, "B has weight between 3 and 7"),
        (
            "identity",
            Attribute("color", 3),
            (0,),
            upright([0.9, 0.8, 0.1], [1, 2, 3], 0.1),
            f"A has color near (0.9, 0.8, 0.1), {COLOR_REACH}",
        ),
        ("identity", HEADING, (2,), Arc(1.0, 0.25, 2.0), "C has heading within 0.25 rad of 1 rad"),
        ("distance", LOCATION, (0, 2), upright([1], [2.1]), "C is within 3.1 of A"),
        ("distance", LOCATION, (0, 2), RING, "C is between 3 and 7 from A"),
        ("distance", Attribute("color", 3), (0, 1), upright([0], [0.5]), "B has color within 0.5 of A's"),
        ("distance", Attribute("weight"), (1, 0), RING, "A has weight between 3 and 7 from B's"),
        ("difference", LOCATION, (0, 1), FLAT, f"B has location minus A's {FLAT_SAID}"),
        ("difference", Attribute("weight"), (0, 1), RING, "B has weight minus A's between 3 and 7"),
        (
            "difference",
            HEADING,
            (0, 1),
            Arc(-0.5, 0.1, 2.0),
            "B has heading minus A's within 0.1 rad of -0.5 rad",
        ),
        ("reframe", LOCATION, (0, 1, 2), FLAT, f"C is {FLAT_SAID}, in the frame of A facing B"),
        ("reframe", LOCATION, (2, 0, 1), FLAT, f"B is {FLAT_SAID}, in the frame of C facing A"),
        (
            "scaled_reframe",
            LOCATION,
            (0, 1, 2),
            FLAT,
            f"C is {FLAT_SAID}, in the frame of A facing B, their distance being 1",
        ),
        (
            "reframe",
            Attribute("velocity", 2),
            (0, 1, 2),
            FLAT,
            f"C is at velocity {FLAT_SAID}, in the frame of A facing B",
        ),
    ],
)
def test_statements(
    operation: str, attribute: Attribute, variables: tuple[int, ...], volume: Volume, expected: str
) -> None:
    assert said(operation, attribute, variables, volume) == expected


@pytest.mark.parametrize(
    ("operation", "variables", "volume", "fresh", "expected"),
    [
        # The one new variable is what the statement is about.
        ("distance", (0, 2), RING, (2,), "there is a C between 3 and 7 from A"),
        ("distance", (0, 2), upright([1], [2.1]), (2,), "there is a C within 3.1 of A"),
        ("identity", (0,), FLAT, (0,), f"there is an A that has location {FLAT_SAID}"),
        ("difference", (0, 1), FLAT, (1,), f"there is a B that has location minus A's {FLAT_SAID}"),
        ("reframe", (0, 1, 2), FLAT, (2,), f"there is a C {FLAT_SAID}, in the frame of A facing B"),
        # The one new variable is something else.
        ("distance", (2, 0), RING, (2,), "there is a C such that A is between 3 and 7 from C"),
        ("distance", (4, 0), RING, (4,), "there is an E such that A is between 3 and 7 from E"),
        (
            "reframe",
            (2, 1, 0),
            FLAT,
            (2,),
            f"there is a C such that A is {FLAT_SAID}, in the frame of C facing B",
        ),
        # Several new variables.
        ("distance", (0, 1), RING, (0, 1), "there are A and B such that B is between 3 and 7 from A"),
        (
            "reframe",
            (0, 1, 2),
            FLAT,
            (0, 1, 2),
            f"there are A, B and C such that C is {FLAT_SAID}, in the frame of A facing B",
        ),
    ],
)
def test_new_variables_are_introduced(
    operation: str, variables: tuple[int, ...], volume: Volume, fresh: tuple[int, ...], expected: str
) -> None:
    assert said(operation, LOCATION, variables, volume, fresh) == expected


@pytest.mark.parametrize(
    ("volume", "expected"),
    [
        # Three digits, and no minus before a zero.
        (
            upright([123456, -0.001], [1000, 12.3456]),
            "near (1.23e+05, 0), reaching 1e+03 along (1, 0) and 12.3 along (0, 1)",
        ),
        # A small volume needs more digits for its centre.
        (
            upright([0.00123, -0.2], [0.002, 0.001]),
            "near (0.0012, -0.2), reaching 0.002 along (1, 0) and 0.001 along (0, 1)",
        ),
        # Nothing but the centre inside.
        (upright([1, 2], [1, 1], 0.0), "near (1, 2), reaching 0 along (0, 0) and 0 along (0, 0)"),
    ],
)
def test_numbers(volume: Ellipsoid, expected: str) -> None:
    assert said("identity", LOCATION, (0,), volume) == f"A has location {expected}"


def test_an_oblique_volume_names_its_axes() -> None:
    # Eigenvalues 9 along (1, 1) and 1 along (1, -1); the sign of an axis is arbitrary.
    oblique = Ellipsoid(np.zeros(2), np.array([[5.0, 4.0], [4.0, 5.0]]), 1.0, 1, 0.1)
    text = said("identity", LOCATION, (0,), oblique).replace("-0.71", "0.71")

    assert text == "A has location near (0, 0), reaching 3 along (0.71, 0.71) and 1 along (0.71, 0.71)"


def test_distances_below_zero_are_not_mentioned() -> None:
    assert said("distance", LOCATION, (0, 1), upright([1], [1])) == "B is within 2 of A"


@pytest.mark.parametrize(
    ("made", "expected"),
    [
        (Leaf(0.5, 1, 1), "0.50  (1 of 2 scenes positive)"),
        (Leaf(1.0, 0, 1), "1.00  (1 of 1 scene positive)"),
        (Leaf(0.25, 0, 0), "0.25  (0 of 0 scenes positive)"),
    ],
)
def test_leaves(made: Leaf, expected: str) -> None:
    assert leaf_summary(made) == expected


def test_arguments_are_not_fresh() -> None:
    schema = plane("passer", "receiver")

    assert fresh_variables(schema, 0, 2) == ()
    assert fresh_variables(schema, 0, 4) == (2, 3)
    assert fresh_variables(schema, 1, 2) == (2,)
    assert fresh_variables(schema, 3, 1) == (3,)


def test_a_stub_in_words() -> None:
    stub = Tree.stub(plane(), Leaf(0.75, 1, 3))

    assert str(stub) == "SMRF tree with 0 questions and 1 leaf\n0.75  (3 of 4 scenes positive)"


def test_a_tree_in_words() -> None:
    schema = plane("passer", "receiver")
    location = schema["location"]
    nodes: tuple[Node, ...] = (
        *(Instantiation(i + 1) for i in range(3)),
        Question(Mapping("reframe", location), (0, 1, 2), FLAT, 4, 12, 13),
        Question(Mapping("distance", location), (0, 1), ball([0.0], 3.0), 5, 6, 7),
        Leaf(0.9, 1, 9),
        Leaf(0.5, 1, 1),
        Instantiation(8),
        Question(Mapping("identity", location), (3,), FLAT, 9, 10, 11),
        *(Leaf(probability, 0, 0) for probability in (0.8, 0.2, 0.1)),
        Leaf(0.05, 20, 1),
        Leaf(0.0, 1, 0),
    )

    assert str(Tree(schema, nodes)).splitlines() == [
        "SMRF tree with 3 questions and 7 leaves",
        f"A is the passer, B is the receiver; there is a C {FLAT_SAID}, in the frame of A facing B?",
        "    yes: B is within 3 of A?",
        "        yes: 0.90  (9 of 10 scenes positive)",
        "        no: 0.50  (1 of 2 scenes positive)",
        f"        error: there is a D that has location {FLAT_SAID}?",
        "            yes: 0.80  (0 of 0 scenes positive)",
        "            no: 0.20  (0 of 0 scenes positive)",
        "    no: 0.05  (1 of 21 scenes positive)",
        "    error: 0.00  (0 of 1 scene positive)",
    ]


def test_arguments_are_introduced_where_they_are_bound() -> None:
    # The second argument is bound below the first question only.
    schema = plane("passer", "receiver")
    here = ball([0.0, 0.0], 1.0)
    nodes: tuple[Node, ...] = (
        Instantiation(1),
        Question(Mapping("identity", schema["location"]), (0,), here, 2, 7, 8),
        Instantiation(3),
        Question(Mapping("distance", schema["location"]), (0, 1), ball([0.0], 1.0), 4, 5, 6),
        *(leaf(0.5),) * 5,
    )
    lines = str(Tree(schema, nodes)).splitlines()

    assert lines[1].startswith("A is the passer; A has location near (0, 0)")
    assert lines[2] == "    yes: B is the receiver; B is within 1 of A?"


def test_bindings_above_a_leaf_are_not_worth_a_line() -> None:
    schema = Schema((LOCATION,), ("passer",))

    assert str(Tree(schema, (Instantiation(1), leaf(0.5)))).splitlines()[1:] == [
        "0.50  (0 of 0 scenes positive)"
    ]
