"""The recipe of docs/many-scenes.md, as it is written there; only where Dask is installed."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pytest
from pyarrow import parquet

import relforest as rf
from relforest.scenes import read_table

pytest.importorskip("dask.dataframe")

DOCUMENT = Path(__file__).parents[2] / "docs" / "many-scenes.md"
COLUMNS: Any = {"scene": "pass", "object": "player", "attributes": {"location": ["x", "y"]}}


class _Model:
    """Stands for a classifier: the probability depends on all objects of a scene."""

    def predict_proba(self, scenes: rf.Scenes) -> Any:
        far = np.array([scenes.matrix[scenes.objects(i), 0].sum() for i in range(len(scenes))])
        return np.column_stack([1 - far, far])


# Dask may use what newer versions of pandas deprecate.
@pytest.mark.filterwarnings("default")
def test_partitions_are_predicted_without_cutting_a_scene(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    rows = np.arange(30)
    table = pa.table({"pass": rows // 3, "player": [f"p{i}" for i in rows], "x": rows / 100, "y": rows / 10})
    (tmp_path / "parts").mkdir()
    for number, begin in enumerate((0, 10, 20)):
        parquet.write_table(table.slice(begin, 10), tmp_path / "parts" / f"{number}.parquet")
    monkeypatch.chdir(tmp_path)
    recipe = DOCUMENT.read_text("utf-8").partition("## Dask")[2].partition("```python")[2].partition("```")[0]
    exec(recipe, {"rf": rf, "model": _Model(), "columns": COLUMNS})  # noqa: S102

    whole = _Model().predict_proba(rf.Scenes.from_frame(table, **COLUMNS))
    found = read_table(tmp_path / "predictions")["probability"].to_pylist()
    assert found == pytest.approx(whole[:, 1].tolist())
