"""Forests that learn from Parquet files, each tree from its own sample."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pytest
from pyarrow import parquet
from sklearn.base import clone

from interpreted import compiled_only
from relforest import Scenes, SMRFForestClassifier, SMRFForestRegressor
from relforest.forests import forest_estimators
from relforest.forests.base import SceneEstimator
from relforest.scenes import sample_scenes
from relforest.support.errors import InputError
from relforest.support.rng import seed_sequence, stream
from relforest.trees import TreeSettings

COLUMNS: Any = {"scene": "s", "object": "o", "attributes": {"x": "x"}}
N_SCENES = 60
MODELS: tuple[SceneEstimator, ...] = (
    SMRFForestClassifier(n_trees=3, max_samples=20, random_state=0),
    SMRFForestClassifier(n_trees=2, max_samples=8, growth=TreeSettings(attempts=1), random_state=0),
    SMRFForestRegressor(n_trees=3, max_samples=20, random_state=0),
    SMRFForestRegressor(n_trees=2, max_samples=8, growth=TreeSettings(attempts=1), random_state=0),
)


def table() -> pa.Table:
    """Scenes of two objects; whether one has x above .8, and the largest x."""
    x = np.random.default_rng(0).uniform(0, 1, 2 * N_SCENES)
    largest = np.repeat(x.reshape(-1, 2).max(axis=1), 2)
    rows = np.arange(2 * N_SCENES)
    return pa.table({"s": rows // 2, "o": rows % 2, "x": x, "high": largest > 0.8, "largest": largest})


@pytest.fixture
def source(tmp_path: Path) -> Path:
    """Three files; the second and the third begin within a scene."""
    folder = tmp_path / "parts"
    folder.mkdir()
    for number, (begin, end) in enumerate(((0, 31), (31, 77), (77, 2 * N_SCENES))):
        parquet.write_table(table().slice(begin, end - begin), folder / f"{number}.parquet")
    return folder


def label_of(model: Any) -> str:
    return "high" if hasattr(model, "class_weight") else "largest"


@pytest.mark.parametrize("model", MODELS, ids=lambda model: f"{type(model).__name__}-{model.growth}"[:30])
def test_each_tree_learns_from_the_sample_drawn_for_it(model: Any, source: Path) -> None:
    one = clone(model).fit_source(source, label_of(model), **COLUMNS)
    whole = source.parent / "whole.parquet"
    parquet.write_table(table(), whole)
    other = clone(model).fit_source(whole, label_of(model), **COLUMNS)
    drawn = sample_scenes(
        source, 3, 20, stream(seed_sequence(0), forest_estimators._SAMPLES), label=label_of(model), **COLUMNS
    )
    scenes = Scenes.from_parquet(whole, **COLUMNS)

    assert one.ensemble_.to_dict() == other.ensemble_.to_dict()
    assert len(one.ensemble_.trees) == model.n_trees
    assert np.isnan(one.oob_score_)
    assert one.predict(scenes).shape == (N_SCENES,)
    if not model.growth and label_of(model) == "high":
        # Where a tree starts: the mean of all samples.
        mean = np.concatenate([labels for _, labels in drawn if labels is not None]).mean()
        assert one.ensemble_.start == pytest.approx([mean])
        counts = [sum(leaf.n_scenes for leaf in leaves(tree)) for tree in one.ensemble_.trees]
        assert counts == [20] * 3


def leaves(tree: Any) -> list[Any]:
    return [tree.nodes[index] for index in tree.leaves]


@compiled_only
def test_a_forest_of_samples_learns_as_well_as_one_of_all_scenes(source: Path) -> None:
    scenes = Scenes.from_parquet(source, **COLUMNS)
    y = table()["high"].to_numpy()[::2]
    model = SMRFForestClassifier(n_trees=20, max_samples=40, random_state=0)

    assert clone(model).fit_source(source, "high", **COLUMNS).score(scenes, y) >= 0.95
    assert clone(model).fit(scenes, y).score(scenes, y) >= 0.95


@compiled_only
@pytest.mark.parametrize("model", MODELS[:2], ids=["conditions", "smrf"])
def test_the_number_of_jobs_does_not_matter(model: Any, source: Path) -> None:
    one = clone(model).fit_source(source, "high", **COLUMNS)
    other = clone(model).set_params(n_jobs=2).fit_source(source, "high", **COLUMNS)

    assert one.ensemble_.to_dict() == other.ensemble_.to_dict()


def test_a_fit_from_a_source_forgets_an_earlier_score(source: Path) -> None:
    model = clone(MODELS[0]).fit(Scenes.from_parquet(source, **COLUMNS), table()["high"].to_numpy()[::2])
    assert model.oob_decision_function_.shape == (N_SCENES, 2)
    model.fit_source(source, "high", **COLUMNS)

    assert np.isnan(model.oob_score_)
    assert model.oob_decision_function_.shape == (0, 2)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"max_samples": 0.5}, "max_samples must be the number of scenes of each tree"),
        ({"max_samples": N_SCENES + 1}, "size must be at most the 60 scenes"),
        ({"n_trees": 0}, "n_trees must be"),
        ({"negated": 0.5}, "negated is for SMRF trees"),
    ],
)
def test_bad_options_are_refused(change: dict[str, Any], message: str, source: Path) -> None:
    with pytest.raises(InputError, match=message):
        clone(MODELS[0]).set_params(**change).fit_source(source, "high", **COLUMNS)


def test_bad_sources_are_refused_before_anything_is_learned(
    source: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def learned(*_: object, **__: object) -> None:
        raise AssertionError("something was learned")

    monkeypatch.setattr(forest_estimators, "grow_forest_of_samples", learned)
    model = clone(MODELS[0])
    shuffled = tmp_path / "shuffled.parquet"
    parquet.write_table(table().take(np.random.default_rng(0).permutation(2 * N_SCENES)), shuffled)
    one_class = tmp_path / "one.parquet"
    parquet.write_table(table().set_column(3, "high", [[True] * 2 * N_SCENES]), one_class)
    (tmp_path / "empty").mkdir()

    for path, label, message in (
        (shuffled, "high", "comes back"),
        (source, "low", "'low'"),
        (one_class, "high", "2 classes are needed"),
        (source, "largest", "continuous"),
        (tmp_path / "empty", "high", "no Parquet files|contains no"),
    ):
        with pytest.raises(InputError, match=message):
            model.fit_source(path, label, **COLUMNS)
    parquet.write_table(table().drop_columns(["x"]), source / "3.parquet")
    with pytest.raises(InputError, match="'x'"):
        model.fit_source(source, "high", **COLUMNS)
