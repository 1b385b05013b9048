from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pyarrow as pa
import pytest

from relforest.forests import Condition, Ensemble
from relforest.forests.scene_tree import SceneTree, Split, Value
from relforest.forests.statements import Bound, Statement
from relforest.mappings import Mapping
from relforest.models import Model
from relforest.scenes import Attribute, Scenes, Schema
from relforest.scenes.frames import FrameLayout
from relforest.sharing import program_of, python_code, sql_code
from relforest.support.errors import InputError
from relforest.trees import ClassLeaf, Tree
from sharing.shared_models import (
    KINDS,
    arrow,
    differences,
    random_cases,
    random_model,
    random_scenes,
    scene_rows,
)


def run_python(model: Model, scenes: Scenes) -> list[dict[str, Any]]:
    names: dict[str, Any] = {}
    exec(compile(python_code(program_of(model)), "model.py", "exec"), names)  # noqa: S102 - our own code
    return [names["predict"](rows) for rows in scene_rows(scenes)]


def run_sql(model: Model, scenes: Scenes) -> list[dict[str, Any]]:
    duckdb = pytest.importorskip("duckdb")
    connection = duckdb.connect()
    connection.register("objects", arrow(scenes))
    result = connection.execute(sql_code(program_of(model)))
    names = [column[0] for column in result.description]
    found = [dict(zip(names, row, strict=True)) for row in result.fetchall()]
    assert [row.pop("scene") for row in found] == list(range(len(scenes)))
    return found


@pytest.mark.parametrize("run", [run_python, run_sql])
@pytest.mark.parametrize("kind", KINDS)
def test_exported_models_predict_what_the_library_does(kind: str, run: Any) -> None:
    for model, scenes in random_cases(7, kind):
        assert differences(model, scenes, run(model, scenes)) == []


@pytest.mark.parametrize(("column", "value"), [("team", "nobody"), ("passer", 999)])
def test_what_the_model_does_not_know_is_an_error(column: str, value: Any) -> None:
    rng = np.random.default_rng(3)
    model = random_model(rng, "rules", 1)
    program = program_of(model)
    rows = [row | {column: value} for row in scene_rows(random_scenes(rng, "rules", 1, 9))[1]]
    names: dict[str, Any] = {}
    exec(compile(python_code(program), "model.py", "exec"), names)  # noqa: S102 - our own code

    with pytest.raises(ValueError, match=f"{column} is {value!r}, which is no"):
        names["predict"](rows)
    duckdb = pytest.importorskip("duckdb")
    connection = duckdb.connect()
    connection.register("objects", pa.Table.from_pylist(rows))
    with pytest.raises(duckdb.Error, match=r"unknown team: nobody|passer is no object of scene 1"):
        connection.execute(sql_code(program)).fetchall()


def test_names_of_columns_and_classes_may_hold_quotes() -> None:
    schema = Schema([Attribute('a "b"\\', 1)])
    tree = Tree.stub(schema, ClassLeaf(0.5, 1, 1, (0.4, 0.6), (1, 1)))  # type: ignore[arg-type]
    model = Model(tree, "tree", "it's", ("'", '"'), None)
    scenes = Scenes(schema, np.ones((1, 1)), np.zeros(1, np.int64), np.array([0]), np.array([1]))

    assert [found["predicted"] for found in run_python(model, scenes)] == ['"']
    assert [found["predicted"] for found in run_sql(model, scenes)] == ['"']


def test_what_cannot_be_shared_is_named_with_the_remedy() -> None:
    rng = np.random.default_rng(0)
    model = random_model(rng, "rules", 1)
    mean = Model(
        ensemble_of(Schema([Attribute("x")], ["mean object"]), 1), "outcome", "", (False, True), None
    )
    large = Model(ensemble_of(Schema([Attribute("x")]), 30_000), "boosting", "", (False, True), None)
    columns = FrameLayout("scene", None, ((Attribute("x"), ("x",)),), ("passer",))

    with pytest.raises(InputError, match="fit it with mean_object=False"):
        program_of(mean)
    with pytest.raises(InputError, match="too large to be shared"):
        program_of(large)
    with pytest.raises(InputError, match="fit the model with --object"):
        sql_code(replace(program_of(model), layout=columns))


def ensemble_of(schema: Schema, n_trees: int) -> Ensemble:
    statement = Statement(Mapping("identity", schema.attributes[0]), (0,), Bound(0, "at most", 1.0))
    n_free = 1 - schema.n_parameters
    tree = SceneTree((Split(Condition(n_free, (statement,)), 1, 2, 1.0), Value((1.0,), 1), Value((0.0,), 1)))
    return Ensemble(schema, np.zeros(1), (tree,) * n_trees, np.ones(n_trees))
