"""Every sentence a tree can say, word for word."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import pytest

from relforest.mappings import Mapping
from relforest.scenes import Attribute, Schema
from relforest.trees import Instantiation, Leaf, Node, Question, Tree
from relforest.trees.bounds import Bounds
from relforest.trees.text import describe, introduced, one_sided_hint, sentence
from relforest.volumes import Arc, Ellipsoid, Slab, Volume
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


def slab(axis: int, low: float, high: float, dim: int = 2) -> Slab:
    return Slab(upright([(low + high) / 2], [(high - low) / 2]), axis, dim)


FLAT = upright([1.5, -2], [2, 1])
FLAT_SAID = "in the ellipse around (1.5, -2) that reaches 2 along (1, 0) and 1 across"
RIGHT_OF_A = f"on the right of A, looking from A to B: {FLAT_SAID}, with A at (0, 0)"
RING = upright([5], [2])
COLOR = Attribute("color", 3)
PALE = upright([0.9, 0.8, 0.1], [0.2, 0.2, 0.2])


@pytest.mark.parametrize(
    ("operation", "attribute", "volume", "expected"),
    [
        ("identity", LOCATION, slab(0, 3, 5), "x of A is between 3 and 5"),
        ("identity", COLOR, slab(2, 0.2, 0.4, 3), "component 3 of A's color is between 0.2 and 0.4"),
        (
            "identity",
            Attribute("location", 4),
            slab(3, 3, 5, 4),
            "component 4 of A's location is between 3 and 5",
        ),
        ("difference", LOCATION, slab(1, 3, 5), "y of B is between 3 and 5 more than A's"),
        ("difference", LOCATION, slab(1, -2, 2), "y of B is within 2 of A's"),
        ("difference", COLOR, slab(0, -2, 0, 3), "component 1 of B's color is up to 2 less than A's"),
        (
            "scaled_reframe",
            LOCATION,
            slab(1, -0.2, 0.2),
            "y of C is between -0.2 and 0.2, with A at (0, 0) and B at (1, 0)",
        ),
        (
            "reframe",
            LOCATION,
            slab(0, 3, 5),
            (
                "C is in front of A, looking from A to B: x between 3 and 5, with A at (0, 0) and B straight "
                "along (1, 0)"
            ),
        ),
        (
            "reframe",
            Attribute("velocity", 2),
            slab(0, 3, 5),
            (
                "component 1 of C's velocity is between 3 and 5, with A's at (0, 0) and B's straight along "
                "(1, 0)"
            ),
        ),
    ],
)
def test_slabs_speak_of_one_coordinate(
    operation: str, attribute: Attribute, volume: Volume, expected: str
) -> None:
    variables = tuple(range(Mapping(operation, attribute).arity))
    assert said(operation, attribute, variables, volume) == expected


def test_the_coordinate_of_a_new_object() -> None:
    assert said("identity", LOCATION, (1,), slab(0, 3, 5), (1,)) == (
        "there is a B such that x of B is between 3 and 5"
    )


@pytest.mark.parametrize(
    ("low", "high", "expected"),
    [
        (-20, 30, "at most 30 degrees"),
        (100, 200, "at least 100 degrees"),
        (100, 180, "at least 100 degrees"),
        (20, 30, "between 20 and 30 degrees"),
        (-5, 190, "any number of degrees"),
    ],
)
def test_angles_without_ends_that_cut_nothing(low: float, high: float, expected: str) -> None:
    volume = upright([math.radians(low + high) / 2], [math.radians(high - low) / 2])
    assert said("bearing", LOCATION, (0, 1, 2), volume) == f"C is {expected} from B, seen from A"


def test_shares_of_a_distance_without_ends_that_cut_nothing() -> None:
    near, ring = upright([0.5], [0.75]), upright([1.5], [0.5])
    assert said("scaled_distance", LOCATION, (0, 1, 2), near) == "C is at most 1.25 times as far from A as B"
    assert (
        said("scaled_distance", LOCATION, (0, 1, 2), ring) == "C is between 1 and 2 times as far from A as B"
    )


@pytest.mark.parametrize(
    ("operation", "attribute", "variables", "volume", "expected"),
    [
        ("identity", LOCATION, (0,), FLAT, f"A is {FLAT_SAID}"),
        ("identity", Attribute("location"), (0,), RING, "A has location between 3 and 7"),
        ("identity", Attribute("weight"), (1,), RING, "B has weight between 3 and 7"),
        ("identity", COLOR, (0,), PALE, "A has color within 0.2 of (0.9, 0.8, 0.1)"),
        ("identity", HEADING, (2,), Arc(1.0, 0.25, 2.0), "C has heading within 0.25 rad of 1 rad"),
        ("distance", LOCATION, (0, 2), upright([1], [2.1]), "C is within 3.1 of A"),
        ("distance", LOCATION, (0, 2), RING, "C is between 3 and 7 from A"),
        (
            "distance",
            LOCATION,
            (0, 1),
            upright([33.1289], [0.0085]),
            "B is between 33.1204 and 33.1374 from A",
        ),
        # Distances below zero are not mentioned.
        ("distance", LOCATION, (0, 1), upright([1], [1]), "B is within 2 of A"),
        ("distance", LOCATION, (0, 1), upright([1], [1 - 1e-15]), "B is within 2 of A"),
        ("distance", LOCATION, (0, 1), upright([3], [1], 0.0), "B is exactly 3 from A"),
        ("distance", LOCATION, (0, 1), upright([0], [1], 0.0), "B is exactly 0 from A"),
        ("distance", Attribute("location"), (0, 1), RING, "B is between 3 and 7 from A"),
        ("distance", COLOR, (0, 1), upright([0], [0.5]), "B has color within 0.5 of A's"),
        ("distance", Attribute("weight"), (1, 0), RING, "A has weight between 3 and 7 from B's"),
        (
            "difference",
            LOCATION,
            (0, 1),
            FLAT,
            f"B is at smaller y than A: {FLAT_SAID}, with A at (0, 0)",
        ),
        ("difference", COLOR, (0, 1), PALE, "B has color relative to A's within 0.2 of (0.9, 0.8, 0.1)"),
        (
            "difference",
            HEADING,
            (0, 1),
            Arc(-0.5, 0.1, 2.0),
            "B has heading relative to A's within 0.1 rad of -0.5 rad",
        ),
        ("difference", HEADING, (0, 1), Arc(0.0, 0.1, 2.0), "B has heading within 0.1 rad of A's"),
        (
            "reframe",
            LOCATION,
            (0, 1, 2),
            FLAT,
            f"C is {RIGHT_OF_A} and B straight along (1, 0)",
        ),
        (
            "reframe",
            LOCATION,
            (2, 0, 1),
            upright([0, 2], [2.5, 1.5]),
            (
                "B is on the left of C, looking from C to A: in the ellipse around (0, 2) that reaches 2.5 "
                "along (1, 0) and 1.5 across, with C at (0, 0) and A straight along (1, 0)"
            ),
        ),
        ("scaled_reframe", LOCATION, (0, 1, 2), FLAT, f"C is {RIGHT_OF_A} and B at (1, 0)"),
        (
            "scaled_reframe",
            LOCATION,
            (0, 1, 2),
            upright([0.5, 0.01], [0.3, 0.3]),
            (
                "C is around the middle of the way from A to B: within 0.3 of (0.5, 0.01), with A at (0, 0) "
                "and B at (1, 0)"
            ),
        ),
        # Nothing plain to say.
        (
            "scaled_reframe",
            LOCATION,
            (0, 1, 2),
            upright([1, 0.5], [1.2, 1.2]),
            "C is within 1.2 of (1, 0.5), with A at (0, 0) and B at (1, 0)",
        ),
        (
            "reframe",
            Attribute("velocity", 2),
            (0, 1, 2),
            FLAT,
            f"C has velocity {FLAT_SAID}, with A's at (0, 0) and B's straight along (1, 0)",
        ),
    ],
)
def test_statements(
    operation: str, attribute: Attribute, variables: tuple[int, ...], volume: Volume, expected: str
) -> None:
    assert said(operation, attribute, variables, volume) == expected


@pytest.mark.parametrize(
    ("centre", "half", "expected"),
    [
        (5, 2, "between 3 and 7 more than A's"),
        (-5, 2, "between 3 and 7 less than A's"),
        (2, 5, "between 3 less and 7 more than A's"),
        (2, 2, "up to 4 more than A's"),
        (-2, 2, "up to 4 less than A's"),
        (0.01, 5, "within 5.01 of A's"),
        (3, 0, "exactly 3 more than A's"),
        (-3, 0, "exactly 3 less than A's"),
        (0, 0, "equal to A's"),
    ],
)
def test_differences_of_numbers(centre: float, half: float, expected: str) -> None:
    volume = upright([centre], [1], half)

    assert said("difference", Attribute("weight"), (0, 1), volume) == f"B has weight {expected}"


@pytest.mark.parametrize(
    ("operation", "variables", "volume", "fresh", "expected"),
    [
        # The one new variable is what the statement is about.
        ("distance", (0, 2), RING, (2,), "there is a C between 3 and 7 from A"),
        ("distance", (0, 2), upright([1], [2.1]), (2,), "there is a C within 3.1 of A"),
        ("identity", (0,), FLAT, (0,), f"there is an A {FLAT_SAID}"),
        ("reframe", (0, 1, 2), FLAT, (2,), f"there is a C {RIGHT_OF_A} and B straight along (1, 0)"),
        # The one new variable is something else.
        ("distance", (2, 0), RING, (2,), "there is a C such that A is between 3 and 7 from C"),
        ("distance", (4, 0), RING, (4,), "there is an E such that A is between 3 and 7 from E"),
        # Several new variables.
        ("distance", (0, 1), RING, (0, 1), "there are A and B such that B is between 3 and 7 from A"),
        (
            "reframe",
            (0, 1, 2),
            FLAT,
            (0, 1, 2),
            f"there are A, B and C such that C is {RIGHT_OF_A} and B straight along (1, 0)",
        ),
    ],
)
def test_new_variables_are_introduced(
    operation: str, variables: tuple[int, ...], volume: Volume, fresh: tuple[int, ...], expected: str
) -> None:
    assert said(operation, LOCATION, variables, volume, fresh) == expected


def test_new_objects_come_with_what_they_have() -> None:
    assert (
        said("identity", Attribute("weight"), (0,), RING, (0,)) == "there is an A with weight between 3 and 7"
    )


def test_figures_may_be_left_to_a_picture() -> None:
    beside = Question(Mapping("reframe", LOCATION), (0, 1, 2), FLAT, 1, 2, 3)
    near = Question(Mapping("distance", LOCATION), (0, 1), RING, 1, 2, 3)

    assert sentence(beside, (2,), exact="see Q1") == (
        "there is a C on the right of A, looking from A to B: see Q1"
    )
    # There are no plain words that could stand alone.
    assert sentence(near, exact="see Q2") == "B is between 3 and 7 from A"


@pytest.mark.parametrize(
    ("made", "expected"),
    [
        (Leaf(0.5, 1, 1), "0.50  (1 of 2 scenes positive)"),
        (Leaf(1.0, 0, 1), "1.00  (1 of 1 scene positive)"),
        (Leaf(0.996, 1, 249), "0.996  (249 of 250 scenes positive)"),
        (Leaf(0.25, 0, 0), "0.25  (0 of 0 scenes positive)"),
    ],
)
def test_leaves(made: Leaf, expected: str) -> None:
    assert made.summary == expected


def test_arguments_are_not_introduced() -> None:
    def asked_after(n_new: int) -> tuple[int, ...]:
        asked = Question(Mapping("identity", LOCATION), (0,), FLAT, n_new + 1, n_new + 2, n_new + 3)
        chain: tuple[Node, ...] = (*(Instantiation(i + 1) for i in range(n_new)), asked, *(leaf(0.5),) * 3)
        return introduced(plane("passer", "receiver"), chain)[n_new]

    assert asked_after(2) == ()
    assert asked_after(4) == (2, 3)


def test_a_stub_in_words() -> None:
    stub = Tree.stub(plane(), Leaf(0.75, 1, 3))

    assert str(stub) == (
        "SMRF tree with 0 questions and 1 leaf\n0.75  (3 of 4 scenes positive)\n"
        "every leaf predicts positive: relforest fit --positive LABEL looks for what exists in scenes of "
        "the other class"
    )


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
        f"A is the passer, B is the receiver; there is a C {RIGHT_OF_A} and B straight along (1, 0)",
        "    yes: B is within 3 of A",
        "        yes: 0.90  (9 of 10 scenes positive)",
        "        no: 0.50  (1 of 2 scenes positive)",
        f"        error: there is a D {FLAT_SAID}",
        "            yes: 0.80  (0 of 0 scenes positive)",
        "            no: 0.20  (0 of 0 scenes positive)",
        "    no: 0.05  (1 of 21 scenes positive)",
        "    error: 0.00  (0 of 1 scene positive)",
        "left and right are as on a map, with x to the right and y upwards",
    ]


@pytest.mark.parametrize(
    ("leaves", "hint"),
    [
        # Probability and training scenes of the Yes, the No and the Error leaf.
        (((0.9, 10), (0.55, 84), (0.6, 3)), "every leaf predicts positive"),
        (((0.9, 10), (0.5, 84), (0.6, 3)), "every leaf predicts positive"),
        (((0.4, 10), (0.01, 84), (0.1, 3)), "every leaf predicts negative"),
        # A leaf that no training scene reached does not hide the fault.
        (((0.9, 10), (0.55, 84), (0.3, 0)), "every leaf predicts positive"),
        (((0.9, 10), (0.45, 84), (0.3, 0)), ""),
        (((0.9, 0), (0.55, 0), (0.3, 0)), ""),
        (((0.9, 0), (0.55, 0), (0.6, 0)), "every leaf predicts positive"),
    ],
)
def test_a_tree_of_one_prediction_says_so_and_what_to_do(
    leaves: tuple[tuple[float, int], ...], hint: str
) -> None:
    schema = plane("passer", "receiver")
    near = Question(Mapping("distance", schema["location"]), (0, 1), ball([0.0], 3.0), 3, 4, 5)
    ends = [Leaf(probability, 0, scenes) for probability, scenes in leaves]
    tree = Tree(schema, (Instantiation(1), Instantiation(2), near, *ends))
    advice = ": relforest fit --positive LABEL looks for what exists in scenes of the other class"

    assert one_sided_hint(tree.nodes) == (hint and hint + advice)
    assert one_sided_hint(tree.nodes, "failed") == (hint and hint + advice.replace("LABEL", "failed"))
    assert str(tree) == "\n".join(
        filter(None, (describe(schema, tree.nodes, other=None), hint and hint + advice))
    )


def test_arguments_named_like_their_variables_are_not_introduced() -> None:
    schema = plane("A", "receiver")
    question = Question(Mapping("distance", schema["location"]), (0, 1), ball([0.0], 3.0), 3, 4, 5)
    tree = Tree(schema, (Instantiation(1), Instantiation(2), question, *(leaf(p) for p in (0.9, 0.1, 0.1))))

    assert str(tree).splitlines()[1] == "B is the receiver; B is within 3 of A"


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

    assert lines[1] == "A is the passer; A is within 1 of (0, 0)"
    assert lines[2] == "    yes: B is the receiver; B is within 1 of A"


def test_bindings_above_a_leaf_are_not_worth_a_line() -> None:
    schema = Schema((LOCATION,), ("passer",))

    assert describe(schema, (Instantiation(1), leaf(0.5)), other=None).splitlines()[1:] == [
        "0.50  (0 of 0 scenes positive)"
    ]


@pytest.mark.parametrize(
    ("operation", "attribute", "volume", "bounds", "expected"),
    [
        ("identity", Attribute("weight"), RING, [(0, 3.0, math.inf)], "A has weight at least 3"),
        ("distance", LOCATION, RING, [(0, 3.0, math.inf)], "B is at least 3 from A"),
        ("distance", LOCATION, RING, [(0, -math.inf, 6.987)], "B is within 6.987 of A"),
        (
            "difference",
            Attribute("weight"),
            RING,
            [(0, 3.0, math.inf)],
            "B has weight at least 3 more than A's",
        ),
        (
            "difference",
            Attribute("weight"),
            RING,
            [(0, -3.0, math.inf)],
            "B has weight at most 3 less than A's",
        ),
        (
            "difference",
            Attribute("weight"),
            RING,
            [(0, -math.inf, 7.0)],
            "B has weight at most 7 more than A's",
        ),
        (
            "difference",
            Attribute("weight"),
            RING,
            [(0, -math.inf, -7.0)],
            "B has weight at least 7 less than A's",
        ),
        ("difference", Attribute("weight"), RING, [(0, -math.inf, 0.0)], "B has weight at most A's"),
        (
            "scaled_distance",
            LOCATION,
            RING,
            [(0, 1.2, math.inf)],
            "C is at least 1.2 times as far from A as B",
        ),
        ("bearing", LOCATION, RING, [(0, 1.0, math.inf)], "C is at least 57.3 degrees from B, seen from A"),
        ("bearing", LOCATION, RING, [(0, -math.inf, 1.0)], "C is at most 57.3 degrees from B, seen from A"),
        ("identity", LOCATION, slab(0, 3, 5), [(0, -math.inf, 5.0)], "x of A is at most 5"),
        ("identity", LOCATION, FLAT, [(0, 3.0, math.inf)], "x of A is at least 3"),
        (
            "identity",
            LOCATION,
            FLAT,
            [(0, 3.0, math.inf), (1, -2.0, 1.0)],
            "x of A is at least 3 and y of A is between -2 and 1",
        ),
        ("identity", COLOR, PALE, [(2, 0.9, math.inf)], "component 3 of A's color is at least 0.9"),
        ("difference", LOCATION, FLAT, [(1, -math.inf, -2.0)], "y of B is at least 2 less than A's"),
        (
            "reframe",
            LOCATION,
            FLAT,
            [(0, 0.5, math.inf), (1, -math.inf, 2.0)],
            (
                "C is in front of A, looking from A to B: x at least 0.5 and y at most 2, with A at (0, 0) "
                "and B straight along (1, 0)"
            ),
        ),
        # On the right of A, but what counts is another side of the ellipse.
        (
            "reframe",
            LOCATION,
            FLAT,
            [(1, -3.0, math.inf)],
            "y of C is at least -3, with A at (0, 0) and B straight along (1, 0)",
        ),
    ],
)
def test_only_the_bounds_that_count_are_told(
    operation: str,
    attribute: Attribute,
    volume: Volume,
    bounds: list[tuple[int, float, float]],
    expected: str,
) -> None:
    mapping = Mapping(operation, attribute)
    variables, counted = tuple(range(mapping.arity)), tuple(Bounds(*each) for each in bounds)
    assert sentence(Question(mapping, variables, volume, 1, 2, 3, counted)) == expected
