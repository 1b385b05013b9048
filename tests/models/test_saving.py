from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from sklearn.exceptions import NotFittedError

from cli.command_lines import passes, write
from forests.team_scenes import scenes_of
from relforest import (
    SMRFRPI,
    CovAggClassifier,
    SMRFBoostingRegressor,
    SMRFForestClassifier,
    SMRFRuleSetClassifier,
    SMRFTreeClassifier,
    SMRFTreeRegressor,
    load,
    save,
)
from relforest.models import Model, as_model, read_training_data
from relforest.rl import ValueFunction
from relforest.support.errors import InputError, ModelFormatError
from rl.small_worlds import Picking

RNG = np.random.default_rng(0)
SCENES = scenes_of(RNG, 40)
WEIGHTS = np.array([SCENES.matrix[SCENES.objects(i), 0].max() for i in range(len(SCENES))])
HIGH = np.where(np.median(WEIGHTS) < WEIGHTS, "high", "low")
THIRDS = np.digitize(WEIGHTS, np.quantile(WEIGHTS, [1 / 3, 2 / 3])).astype(np.float64)


@pytest.mark.parametrize(
    ("estimator", "y"),
    [
        (SMRFTreeClassifier(random_state=0), HIGH),
        (SMRFTreeClassifier(random_state=0), THIRDS),
        (SMRFTreeRegressor(random_state=0), WEIGHTS),
        (SMRFForestClassifier(n_trees=3, random_state=0), THIRDS),
        (SMRFBoostingRegressor(n_trees=3, random_state=0), WEIGHTS),
        (SMRFRuleSetClassifier(n_trees=3, random_state=0), HIGH),
    ],
    ids=lambda value: type(value).__name__,
)
def test_a_saved_estimator_predicts_the_same(tmp_path: Path, estimator: Any, y: Any) -> None:
    estimator.fit(SCENES, y)
    save(estimator, tmp_path / "a.json")
    model = load(tmp_path / "a.json")
    assert isinstance(model, Model)
    save(model, tmp_path / "b.json")
    found = model.predictions(SCENES)

    assert (tmp_path / "a.json").read_bytes() == (tmp_path / "b.json").read_bytes()
    assert found.predicted.tolist() == estimator.predict(SCENES).tolist()
    if found.probability is not None:
        assert np.array_equal(found.probability, estimator.predict_proba(SCENES))
        assert model.classes == tuple(np.unique(y).tolist())
    assert str(model) == model.text
    assert repr(model).startswith("Model(")
    assert len(repr(model)) < 200
    version = json.loads((tmp_path / "a.json").read_text())["version"]
    assert version == (1 if model.classes == ("high", "low") else 2)


def test_training_data_tell_how_to_apply_a_model(tmp_path: Path) -> None:
    table = write(passes(), tmp_path / "passes.csv")
    columns: Any = {"scene": "pass", "object": "player", "attributes": {"extent": "x"}}
    data = read_training_data(table, "completed", positive=True, **columns)
    tree = SMRFTreeClassifier(random_state=0).fit(data.scenes, data.y)
    save(tree, tmp_path / "tree.json", data)
    model = load(tmp_path / "tree.json")

    assert isinstance(model, Model)
    assert (model.outcome, model.columns) == ("completed = True", data.columns)
    assert model.points
    assert model.predictions(model.read_scenes(table)).predicted[:2].tolist() == [True, False]
    with pytest.raises(InputError, match="fitted to other data"):
        as_model(SMRFTreeRegressor(random_state=0).fit(data.scenes, data.y), data)
    with pytest.raises(InputError, match="data belong to estimators of scenes, not to a Model"):
        save(model, tmp_path / "other.json", data)


@pytest.mark.parametrize("names", [None, ("x", "y")])
@pytest.mark.parametrize("shape", ["full", "axis"])
def test_the_volume_of_a_classifier_of_bags_comes_back(
    tmp_path: Path, names: tuple[str, str] | None, shape: Any
) -> None:
    points = RNG.normal(size=(20, 3, 2))
    points[:10, 0] = RNG.normal([3, 3], 0.3, size=(10, 2))
    bags: list[Any] = [bag if names is None else pd.DataFrame(bag, columns=names) for bag in points]
    fitted = CovAggClassifier(shape=shape, random_state=0).fit(bags, ["+"] * 10 + ["-"] * 10)
    save(fitted, tmp_path / "volume.json")
    found = load(tmp_path / "volume.json")

    assert isinstance(found, CovAggClassifier)
    assert found.predict(bags).tolist() == fitted.predict(bags).tolist()
    assert np.array_equal(found.decision_function(bags), fitted.decision_function(bags))
    assert getattr(found, "feature_names_in_", None) is None or found.feature_names_in_.tolist() == ["x", "y"]


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("classes", [1]),
        ("classes", [0, 0]),
        ("classes", ["a", 1]),
        ("classes", None),
        ("features", ["x"]),
        ("features", [1, 2]),
        ("volume", {"shape": "arc", "mean": 0.0, "radius": 1.0, "kappa": 1.0}),
        ("volume", 3),
    ],
)
def test_damaged_volumes_are_refused(tmp_path: Path, key: str, value: object) -> None:
    path = tmp_path / "volume.json"
    bags = RNG.normal(size=(8, 2, 2))
    save(CovAggClassifier(random_state=0).fit(bags, [0, 1] * 4), path)
    path.write_text(json.dumps(json.loads(path.read_text()) | {key: value}))

    with pytest.raises(ModelFormatError, match=r"volume\.json is damaged: .*; restore it"):
        load(path)


def test_an_agent_is_saved_as_a_run_folder_and_its_values_come_back(tmp_path: Path) -> None:
    agent = SMRFRPI(Picking(), random_state=0).learn(iterations=1, episodes=10, test_episodes=1)
    save(agent, tmp_path / "run")
    found = load(tmp_path / "run")

    assert isinstance(found, ValueFunction)
    assert found.action_types == agent.value_.action_types
    assert [weights.tolist() for weights in found.weights] == [w.tolist() for w in agent.value_.weights]
    trees = sorted((tmp_path / "run" / "trees").iterdir())
    assert all(isinstance(load(tree), Model) for tree in trees)


def test_only_what_was_learned_is_saved(tmp_path: Path) -> None:
    with pytest.raises(NotFittedError):
        save(SMRFTreeClassifier(), tmp_path / "a.json")
    with pytest.raises(InputError, match="models are made of fitted trees, forests"):
        save("a tree", tmp_path / "a.json")  # type: ignore[arg-type]
    with pytest.raises(ModelFormatError, match="cannot be read: No such file"):
        load(tmp_path / "a.json")
