from __future__ import annotations

from typing import Any

import pytest

from relforest.models import Model
from relforest.scenes import Scenes
from relforest.sharing import program_of, python_code, sql_code
from sharing.shared_models import KINDS, arrow, differences, random_cases, scene_rows


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
