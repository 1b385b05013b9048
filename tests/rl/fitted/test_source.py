from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from experiments.run_folders import contents
from interpreted import compiled_only
from relforest.rl.fitted import CurveSettings, ForestSettings, QLearner, QSettings, Source
from relforest.rl.fitted.horizon import Horizon
from relforest.rl.fitted.sum import Sum
from relforest.runs.learner import advance
from relforest.runs.store import RunStore
from relforest.smdp import ActionType, Decision
from relforest.support.errors import InputError
from rl.small_worlds import Limited, Picking, Reaching

pytestmark = compiled_only

SETTINGS = QSettings(
    curves=CurveSettings(rounds=2, candidates=20, min_scenes=5, ridge=1.0),
    forests=ForestSettings(counts=10, trees=5),
)


WORLDS = (Picking, Limited)


def learner(world: Picking, source: Source | None = None, settings: QSettings = SETTINGS) -> QLearner:
    return QLearner(world, settings, np.random.SeedSequence(1), 30, 10, source=source)


@pytest.fixture(scope="module", params=WORLDS)
def folder(
    request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory
) -> tuple[type[Picking], Path]:
    """Return a world, and a run of one iteration in it."""
    world: type[Picking] = request.param
    path = tmp_path_factory.mktemp(world.__name__)
    first = QLearner(world(), SETTINGS, np.random.SeedSequence(0), 30, 10)
    RunStore(path, first).write(advance(first, advance(first, None)[0])[0])
    return world, path


def decision_of(world: Picking, seed: int = 5) -> Decision:
    world.reset(seed=seed)
    return world.decision()


def test_a_run_begins_with_the_values_of_another_with_fewer_objects(
    folder: tuple[type[Picking], Path],
) -> None:
    world, path = folder
    first = QLearner(world(), SETTINGS, np.random.SeedSequence(0), 30, 10)
    known = RunStore(path, first).resume()
    begun, _ = advance(learner(world(things=6), Source(path)), None)
    assert known is not None
    assert known.state.value is not None
    assert begun.state.value is not None
    decision = decision_of(world(things=6))
    np.testing.assert_array_equal(begun.state.value.values(decision), known.state.value.values(decision))
    # Two of ten pick more than two of the things at random.
    assert begun.metrics[0]["test_reward"] > 2.0


def test_the_penalty_is_on_what_differs_from_the_source(folder: tuple[type[Picking], Path]) -> None:
    world, path = folder
    if world is Limited:
        pytest.skip("forests have no weights that could be penalised")
    stiff = replace(SETTINGS, curves=replace(SETTINGS.curves, ridge=1e9, prior=1e9))
    found = learner(world(things=6), Source(path), stiff)
    before = found.start()
    after = found.iterate(before, 1)
    assert before.value is not None
    assert after.value is not None
    decision = decision_of(world(things=6))
    old, new = before.value.values(decision), after.value.values(decision)
    # The mean of each action type is free.
    np.testing.assert_allclose(new[1:] - new[1], old[1:] - old[1], atol=1e-3)


def test_trees_of_the_source_count_like_transitions(folder: tuple[type[Picking], Path]) -> None:
    world, path = folder
    if world is Limited:
        pytest.skip("forests are learned again")
    trees = {}
    for prior in (1.0, 30.0, 1e6):
        settings = replace(SETTINGS, curves=replace(SETTINGS.curves, prior=prior))
        after = learner(world(things=6), Source(path), settings)
        found = after.iterate(after.start(), 1).value
        assert found is not None
        assert isinstance(found.learned, Sum)
        begun = after.start().value
        assert begun is not None
        assert isinstance(begun.learned, Sum)
        assert begun.learned.trees is not None
        n_before = len(begun.learned.trees.feature)
        trees[prior] = int((found.learned.roots(1) < n_before).sum())
    assert trees[1.0] == 0
    assert 0 < trees[30.0] < SETTINGS.forests.trees
    assert trees[1e6] == SETTINGS.forests.trees


def test_only_the_questions_of_another_task_are_asked(folder: tuple[type[Picking], Path]) -> None:
    world, path = folder
    found = learner(world(things=6), Source(path, "questions"))
    state = found.start()
    assert state.value is not None
    assert not state.value.values(decision_of(world(things=6))).any()
    after = found.iterate(state, 1)
    assert after.value is not None
    offered, learned = state.value.learned, after.value.learned
    if isinstance(offered, Sum):
        assert isinstance(learned, Sum)
        kept = zip(offered.questions, learned.questions, strict=True)
        assert all(
            [new.condition for new in own[: len(old)]] == [each.condition for each in old]
            for old, own in kept
        )
        assert any(map(any, (question.heights for own in learned.questions for question in own)))
    else:
        assert isinstance(learned, Horizon)
        best = max(
            (each for each in offered.measured[1] if each.condition.n_free), key=lambda each: each.importance
        )
        assert best.condition in [each.condition for each in learned.measured[1]]


class Resting(Picking):
    """Picking in which waiting has another name."""

    action_types = (ActionType("rest"), ActionType("pick", ("thing",)))


class Grabbing(Picking):
    """Picking in which everything has another name."""

    action_types = (ActionType("rest"), ActionType("grab", ("thing",)))


def test_questions_of_the_action_types_in_common_are_asked(folder: tuple[type[Picking], Path]) -> None:
    _, path = folder
    source = Source(path, "questions")
    value = learner(Resting(), source).start().value
    assert value is not None
    learned = value.learned
    rest, pick = learned.questions if isinstance(learned, Sum) else learned.measured
    assert (len(rest), len(pick) > 0) == (0, True)
    with pytest.raises(InputError, match="knows no action type of Grabbing: give a run of a similar task"):
        learner(Grabbing(), source).start()


@pytest.mark.parametrize("what", ["policy", "questions"])
def test_an_interrupted_run_no_longer_needs_its_source(
    folder: tuple[type[Picking], Path], what: str, tmp_path: Path
) -> None:
    world, path = folder
    copy = tmp_path / "source"
    copy.mkdir()
    for name, content in contents(path).items():
        (copy / name).parent.mkdir(exist_ok=True)
        (copy / name).write_bytes(content)
    found = learner(world(things=5), Source(copy, what))  # type: ignore[arg-type]
    whole, parts = RunStore(tmp_path / "whole", found), RunStore(tmp_path / "parts", found)
    run = None
    for number in range(3):
        run, _ = advance(found, run)
        whole.write(run)
        again, _ = advance(found, parts.resume())
        parts.write(again)
        if number == 0:
            for file in sorted(copy.rglob("*.*")):
                file.unlink()
    assert contents(tmp_path / "whole") == contents(tmp_path / "parts")


def test_a_source_that_does_not_fit_is_an_error(folder: tuple[type[Picking], Path], tmp_path: Path) -> None:
    _, path = folder
    with pytest.raises(InputError, match=r"what must be one of 'policy', 'questions', got 'all'"):
        Source(path, "all")  # type: ignore[arg-type]
    with pytest.raises(InputError, match="the agent knows the action types"):
        QLearner(Reaching(), SETTINGS, np.random.SeedSequence(0), 5, 5, source=Source(path)).start()
    empty = learner(Picking())
    RunStore(tmp_path, empty).write(advance(empty, None)[0])
    with pytest.raises(InputError, match="has not learned anything yet"):
        learner(Picking(), Source(tmp_path)).start()
