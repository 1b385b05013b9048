from __future__ import annotations

import numpy as np
import pytest

from relforest.forests import Condition
from relforest.forests.statements import Bound, Is, Near, Statement
from relforest.mappings import Mapping
from relforest.rl.fitted.standing import in_words, margins_of_choices, unit_of, witnesses
from relforest.scenes import Attribute, Scenes, Schema

PLACE = Attribute("location", 2, operations=["identity", "distance", "bearing"])
TEAM = Attribute("team", kind="category", categories=["own", "other"])
PASS = Schema((PLACE, TEAM), ("holder", "receiver"))
# The holder at the origin, the receiver on the x axis; 2 and 3 are others, 4 is one's own.
MATRIX = np.array([[0.0, 0.0, 0], [10.0, 0.0, 0], [3.0, 3.0, 1], [3.0, -1.0, 1], [3.0, 0.0, 0]])
OTHER = Statement(Mapping("identity", TEAM), (2,), Is(1))
BESIDE = Statement(Mapping("bearing", PLACE), (0, 1, 2), Near(0, (0.0,), (0.1,)))


def scene(*objects: int) -> Scenes:
    rows = np.array(objects)
    return Scenes(PASS, MATRIX, rows, np.zeros(1, int), np.array([len(rows)]), np.array([[0, 1]]))


def test_the_witness_is_the_nearest_object_of_the_right_category() -> None:
    condition = Condition(1, (OTHER, BESIDE))
    assert witnesses(condition, scene(0, 1, 2, 3, 4)) == (3,)
    assert witnesses(condition, scene(4, 2, 1, 0)) == (2,)
    assert witnesses(condition, scene(0, 1, 4)) == ()
    assert (
        witnesses(
            Condition(0, (Statement(Mapping("distance", PLACE), (0, 1), Bound(0, "at most", 3.0)),)),
            scene(0, 1),
        )
        == ()
    )


def test_margins_of_choices_are_those_of_scenes_with_nothing_else() -> None:
    choices = np.array([[0, 1, 2], [0, 1, 3], [0, 1, 4]])
    margins = margins_of_choices(Condition(1, (OTHER, BESIDE)), PASS, MATRIX, choices)
    # 45 and 18.4 degrees, less the radius of .1; the last one is of the wrong team.
    assert margins[:2] == pytest.approx([np.pi / 4 - 0.1, np.arctan(1 / 3) - 0.1])
    assert np.isnan(margins[2])


def test_pairs_are_ordered() -> None:
    near = Statement(Mapping("distance", PLACE), (0, 2), Bound(0, "at most", 3.1))
    far = Statement(Mapping("distance", PLACE), (0, 3), Bound(0, "at least", 4.0))
    assert witnesses(Condition(2, (near, far)), scene(0, 1, 2, 3)) == (3, 2)


@pytest.mark.parametrize(
    ("condition", "margin", "count", "stands"),
    [
        (Condition(1, (OTHER, BESIDE)), 0.5, 0, "off by 28.6 degrees"),
        (Condition(1, (OTHER, BESIDE)), -0.05, 1, "true"),
        (Condition(1, (OTHER, BESIDE)), 0.0, 3, "true of 3"),
        (Condition(1, (OTHER, BESIDE)), np.nan, 0, "no such object"),
        (Condition(1, (OTHER,)), 1.0, 0, "not true"),
        (
            Condition(0, (Statement(Mapping("distance", PLACE), (0, 1), Bound(0, "at least", 3.0)),)),
            1.25,
            0,
            "off by 1.25",
        ),
        (
            Condition(0, (Statement(Mapping("distance", PLACE), (0, 1), Bound(0, "at least", 3.0)),)),
            np.nan,
            0,
            "cannot be said",
        ),
        (
            Condition(0, (Statement(Mapping("distance", PLACE), (0, 1), Bound(0, "at most", 0.0)),)),
            10.0,
            0,
            "off by 10",
        ),
    ],
)
def test_how_it_stands_is_told(condition: Condition, margin: float, count: float, stands: str) -> None:
    assert in_words(condition, PASS, margin, count)[1] == stands


def test_a_number_of_the_arguments_is_told_without_its_limit() -> None:
    number = Condition(0, (Statement(Mapping("identity", PLACE), (1,), Bound(0, "at most", 0.0)),))
    assert in_words(number, PASS, 10.0, 0) == ("the receiver has x", "10")


def test_angles_are_in_degrees_where_their_sentence_is() -> None:
    scale, unit = unit_of(Condition(1, (OTHER, BESIDE)))
    assert (scale, unit) == (np.degrees(1.0), "degrees")
    assert unit_of(Condition(1, (OTHER,))) == (1.0, "")
