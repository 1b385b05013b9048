from __future__ import annotations

from dataclasses import replace

import numpy as np

from relforest import Attribute, Schema
from relforest.forests.statements import Bound, Is, Statement
from relforest.mappings import Mapping
from relforest.rl.fitted.search import new_questions
from relforest.rl.fitted.settings import CurveSettings
from relforest.scenes import Scenes
from relforest.scenes.arrays import FloatArray

SCHEMA = Schema(
    (Attribute("location", 2), Attribute("team", kind="category", categories=["own", "other"])), ("holder",)
)
SETTINGS = CurveSettings(candidates=80, kept=3, min_scenes=10)


def scenes(n: int, seed: int) -> Scenes:
    """A holder, two of its own and two others in each scene."""
    rng = np.random.default_rng(seed)
    matrix = np.column_stack([rng.uniform(-10, 10, (5 * n, 2)), np.tile([0.0, 0.0, 0.0, 1.0, 1.0], n)])
    starts = np.arange(n) * 5
    return Scenes(SCHEMA, matrix, np.arange(5 * n), starts, np.full(n, 5), starts[:, None])


def nearest_other(found: Scenes) -> FloatArray:
    places = found.matrix[:, :2].reshape(-1, 5, 2)
    distances: FloatArray = np.linalg.norm(places[:, 3:] - places[:, :1], axis=2).min(axis=1)
    return distances


def test_the_best_question_is_about_what_the_residual_depends_on() -> None:
    given = scenes(300, 0)
    residuals = np.where(nearest_other(given) < 6.0, -1.0, 1.0)
    best = new_questions(given, residuals, SETTINGS, np.random.default_rng(3))[0].condition
    # It is about another player than the holder, of the other team, and where it is.
    assert best.n_free >= 1
    kinds = [each.test for each in best.statements if isinstance(each.test, Is)]
    assert Is(1) in kinds


def test_kept_questions_differ_and_are_no_more_than_asked_for() -> None:
    given = scenes(200, 1)
    found = new_questions(given, nearest_other(given), SETTINGS, np.random.default_rng(0))
    assert len(found) == 3
    assert len({question.condition for question in found}) == 3


def test_the_same_stream_gives_the_same_questions() -> None:
    given, target = scenes(100, 2), nearest_other(scenes(100, 2))
    one, other = (new_questions(given, target, SETTINGS, np.random.default_rng(7)) for _ in range(2))
    assert one == other


def test_how_near_the_nearest_is_is_asked_once() -> None:
    given, settings = scenes(300, 0), replace(SETTINGS, candidates=800, kept=80)
    first = new_questions(given, nearest_other(given), settings, np.random.default_rng(0))
    nearest = Statement(Mapping("distance", SCHEMA["location"]), (0, 1), Bound(0, "at most", 0.0))
    asked = [question for question in first if question.condition.statements[-1] == nearest]
    # Of the own team and of the others.
    assert len(asked) == 2
    # How far it is from being true is the distance itself.
    quantiles = np.quantile(nearest_other(given), (0.02, 0.25, 0.5, 0.75, 0.98))
    assert any(np.allclose(question.knots, quantiles, rtol=1e-4) for question in asked)
    again = new_questions(given, nearest_other(given), settings, np.random.default_rng(0), first)
    assert not {question.condition for question in asked} & {question.condition for question in again}


def test_too_few_scenes_or_nothing_to_explain_give_no_question() -> None:
    assert new_questions(scenes(19, 0), np.arange(19.0), SETTINGS, np.random.default_rng(0)) == []
    assert new_questions(scenes(40, 0), np.zeros(40), SETTINGS, np.random.default_rng(0)) == []
