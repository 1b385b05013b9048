from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from relforest.forests import Condition
from relforest.forests.statements import Bound, Is, Near, Statement
from relforest.mappings import Mapping
from relforest.reports.figure_files import save_figure
from relforest.reports.policy_figure import policy_figure
from relforest.rl.experience import Experience
from relforest.rl.fitted.influence import influences
from relforest.rl.fitted.questions import Question
from relforest.rl.fitted.sum import Sum
from relforest.rl.fitted.value import QValue
from relforest.rl.fitted.view import View
from relforest.scenes import Attribute, Schema
from relforest.smdp import ActionType
from relforest.support.errors import InputError

WORLD = Schema((Attribute("location", 2), Attribute("color", 3)))
ACTIONS = (ActionType("hold"), ActionType("pass", ("receiver",)))
VIEW = View(WORLD, (("color", np.array([[0.0, 1.0, 1.0], [1.0, 1.0, 0.0]])),))
LOCATION, TEAM = VIEW.attributes
KNOTS = (0.0, 1.0, 2.0, 4.0, 8.0)


def near(radius: float, heights: tuple[float, ...]) -> Question:
    other = Statement(Mapping("identity", TEAM), (1,), Is(0))
    place = Statement(Mapping("difference", LOCATION), (0, 1), Near(0, (1.0, 0.0), (radius, radius)))
    return Question(Condition(1, (other, place)), KNOTS, heights, heights[-1])


def far(limit: float) -> Question:
    place = Statement(Mapping("identity", LOCATION), (0,), Bound(0, "at least", limit))
    return Question(Condition(1, (place,)), KNOTS, (9.0, 7.0, 5.0, 3.0, 1.0), 5.0)


def value(*questions: Question) -> QValue:
    return QValue(VIEW, ACTIONS, Sum(VIEW.schemas(ACTIONS), 0, (3.0, 0.0), ((far(2.0),), questions)))


def experience() -> Experience:
    """Return twelve states of three objects, the last one of the others; passes and holding take turns."""
    rng, n = np.random.default_rng(0), 12
    matrix = np.concatenate(
        [rng.normal(size=(3 * n, 2)) * 3, np.tile([[1.0, 1, 0], [1, 1, 0], [0, 1, 1]], (n, 1))], axis=1
    )
    states = np.arange(n - 1)
    nothing = np.zeros(n - 1)
    return Experience(
        matrix, 3 * np.arange(n + 1), np.zeros(n, int), np.full(n, -1), 2 * np.arange(n + 1),
        np.tile([0, 1], n), np.tile([[-1], [1]], (n, 1)), states, states + 1, 2 * states + states % 2,
        nothing, nothing + 1, nothing > 0, nothing > 0, np.zeros(1), np.zeros(1),
    )  # fmt: skip


LOUD, QUIET = near(1.0, (0.0, 1.0, 2.0, 4.0, 8.0)), near(0.1, (0.0, 0.1, 0.2, 0.4, 0.8))


def test_what_matters_most_comes_first_and_the_base_last() -> None:
    apart = replace(
        QUIET,
        condition=Condition(0, (Statement(Mapping("identity", LOCATION), (0,), Bound(0, "at least", 0.0)),)),
    )
    found = influences(value(LOUD, apart), experience(), 9)
    assert [(each.number, each.questions) for each in found] == [
        (1, (LOUD,)),
        (1, (apart,)),
        (0, (far(2.0),)),
    ]
    assert found[0].spread > found[1].spread
    assert len(found[0].margins) == 5
    # The curve is the distance itself, and what is usual is subtracted.
    np.testing.assert_allclose(found[0].adds, np.clip(found[0].margins, 0.0, 8.0) - LOUD.usual)


def test_questions_alike_are_one_influence() -> None:
    (found, base) = influences(value(QUIET, LOUD), experience(), 9)
    assert (found.questions, base.number) == ((LOUD, QUIET), 0)
    scene = found.scenes.take([0])
    rows = np.array([[scene.arguments[0, 0], row] for row in scene.objects(0)])
    margins, adds = found.of_choices(scene, scene.matrix, rows)
    # Only the last object is one of the others: the others count as far away.
    assert np.isnan(margins).tolist() == [True, True, False]
    assert margins[2] == pytest.approx(found.margins[0])
    assert adds[2] == pytest.approx(found.adds[0])


@pytest.mark.parametrize("questions", [(LOUD,), (QUIET, LOUD)])
def test_conditions_are_drawn_over_scenes_beside_what_they_add(
    questions: tuple[Question, ...], tmp_path: Path
) -> None:
    figure = policy_figure(value(*questions), experience(), title="run")
    texts = [text.get_text() for text in figure.texts]
    assert texts[0] == "run"
    assert "1. pass: some object with color (0, 1, 1) is in the ellipse" in " ".join(texts)
    scene, adds, *_ = figure.axes
    assert {text.get_text() for text in scene.texts} == {"receiver"}
    assert adds.get_xlabel() == "how far from true"
    assert bool(scene.images)
    save_figure(figure, tmp_path / "figure.png")


def test_a_policy_without_conditions_cannot_be_drawn() -> None:
    with pytest.raises(InputError, match="has no conditions yet"):
        policy_figure(QValue(VIEW, ACTIONS, Sum.zero(VIEW.schemas(ACTIONS), None)), experience())
