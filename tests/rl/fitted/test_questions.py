from __future__ import annotations

import json
from itertools import pairwise

import numpy as np
import pytest

from relforest.forests import Condition
from relforest.forests.packing import pack_conditions
from relforest.forests.statements import Near, Statement
from relforest.mappings import Mapping
from relforest.rl.fitted.questions import N_KNOTS, Question, curves, features_of, hats, knots_of, measured
from relforest.scenes import Scenes
from relforest.support.errors import ModelFormatError
from rl.small_worlds import LOCATION, PICK_SCHEMA

KNOTS = (-1.0, 0.0, 1.0, 2.0, 4.0)


def near(centre: float, radius: float) -> Condition:
    """Another thing differs from the argument by about `centre`."""
    test = Near(0, (centre,), (radius,))
    return Condition(1, (Statement(Mapping("difference", LOCATION), (0, 1), test),))


def scenes() -> Scenes:
    """Things at 0, 1, 3; and one alone; the first of each is the argument."""
    matrix = np.array([[0.0], [1.0], [3.0], [5.0]])
    return Scenes(PICK_SCHEMA, matrix, np.arange(4), np.array([0, 3]), np.array([3, 1]), np.array([[0], [3]]))


@pytest.mark.parametrize(
    ("margin", "shares"),
    [
        (-2.0, [1, 0, 0, 0, 0]),
        (-1.0, [1, 0, 0, 0, 0]),
        (-0.25, [0.25, 0.75, 0, 0, 0]),
        (1.0, [0, 0, 1, 0, 0]),
        (3.0, [0, 0, 0, 0.5, 0.5]),
        (4.0, [0, 0, 0, 0, 1]),
        (np.inf, [0, 0, 0, 0, 1]),
        (np.nan, [0, 0, 0, 0, 1]),
    ],
)
def test_a_margin_lies_between_two_knots(margin: float, shares: list[float]) -> None:
    out, knots = np.empty((1, N_KNOTS)), np.array([KNOTS])
    hats(np.array([[margin]]), knots, out)
    assert out[0].tolist() == shares
    heights, total = np.array([[3.0, -1.0, 2.0, 0.0, 5.0]]), np.empty(1)
    curves(np.array([[margin]]), knots, heights, total)
    assert total[0] == pytest.approx(out[0] @ heights[0])


def test_curves_agree_with_interpolation() -> None:
    rng = np.random.default_rng(0)
    margins, heights = rng.normal(size=(30, 3)) * 3, rng.normal(size=(3, N_KNOTS))
    knots = np.sort(rng.normal(size=(3, N_KNOTS)), axis=1)
    total = np.empty(30)
    curves(margins, knots, heights, total)
    expected = sum(np.interp(margins[:, j], knots[j], heights[j]) for j in range(3))
    np.testing.assert_allclose(total, expected)


def test_features_are_about_the_nearest_object() -> None:
    question = Question(near(1.5, 0.5), KNOTS)
    packed = pack_conditions(PICK_SCHEMA, [question.condition])
    seen = measured(packed, scenes())
    # The thing at 1 is nearest, 0.5 from the centre: on the edge; the second scene has no other thing.
    assert seen.margins[0, 0] == pytest.approx(0.0, abs=1e-12)
    assert np.isnan(seen.margins[1, 0])
    assert seen.counts.tolist() == [[1.0], [0.0]]
    np.testing.assert_allclose(
        features_of(measured(packed, scenes()).margins, [question])[1], [0, 0, 0, 0, 1]
    )


def test_knots_are_quantiles_in_ascending_order() -> None:
    found = knots_of(np.append(np.arange(101.0), [np.nan, np.inf]))
    assert found is not None
    np.testing.assert_allclose(found, [2, 25, 50, 75, 98], atol=1e-3)
    same = knots_of(np.ones(50))
    assert same is not None
    assert all(a < b for a, b in pairwise(same))
    assert knots_of(np.array([1.0, np.nan])) is None


def test_the_json_form_is_read_back() -> None:
    question = Question(near(0.3, 0.2), KNOTS, (1.0, 2.0, 3.0, 4.0, 5.0), 0.5)
    assert Question.from_dict(json.loads(json.dumps(question.to_dict())), PICK_SCHEMA) == question


@pytest.mark.parametrize(
    "change",
    [
        {"knots": [0.0, 1.0, 1.0, 2.0, 3.0]},
        {"knots": [0.0, 1.0]},
        {"heights": [0.0, 1.0, 2.0, 3.0, float("inf")]},
        {"spread": -1.0},
        {"condition": {}},
    ],
)
def test_damaged_documents_are_named(change: dict[str, object]) -> None:
    with pytest.raises(ModelFormatError, match="malformed question"):
        Question.from_dict(Question(near(0.3, 0.2), KNOTS).to_dict() | change, PICK_SCHEMA)
