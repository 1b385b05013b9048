from __future__ import annotations

from collections import Counter
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pytest
from pyarrow import parquet

from relforest.scenes import Scenes, sample_scenes
from relforest.scenes.parquet_source import ParquetSource
from relforest.support.errors import InputError

COLUMNS: Any = {"scene": "s", "object": "o", "attributes": {"x": "x"}, "arguments": ["agent"]}


@pytest.fixture
def source(tmp_path: Path) -> Path:
    """Six scenes of 1, 2, 3, 1, 2, 3 objects in two files; the third scene begins in the first one."""
    counts = [1, 2, 3, 1, 2, 3]
    columns = {
        "s": np.repeat(list("abcdef"), counts),
        "o": np.concatenate([np.arange(count) for count in counts]),
        "x": np.arange(12) / 2,
        "agent": np.repeat(np.array(counts) - 1, counts),
        "good": np.repeat([True, False, True, True, False, False], counts),
    }
    table = pa.table(columns)
    parquet.write_table(table.slice(0, 4), tmp_path / "0.parquet")
    parquet.write_table(table.slice(4), tmp_path / "1.parquet")
    return tmp_path


def test_samples_are_whole_scenes_with_their_labels(source: Path) -> None:
    by_id = {record["id"]: record for record in Scenes.from_parquet(source, **COLUMNS).to_dicts()}
    samples = sample_scenes(source, 3, 4, rng=1, label="good", **COLUMNS)

    assert len(samples) == 3
    for scenes, labels in samples:
        ids = scenes.scene_ids.tolist()
        assert len(set(ids)) == 4
        assert scenes.to_dicts() == [by_id[name] for name in sorted(ids)]
        assert labels is not None
        assert labels.tolist() == ["abcdef".index(name) in {0, 2, 3} for name in ids]


def test_every_set_of_scenes_is_equally_probable(source: Path) -> None:
    samples = sample_scenes(source, 3000, 2, rng=0, **COLUMNS)
    found = Counter("".join(scenes.scene_ids.tolist()) for scenes, _ in samples)
    expected = 3000 / 15
    statistic = sum((count - expected) ** 2 / expected for count in found.values())

    assert sorted(found) == ["".join(pair) for pair in combinations("abcdef", 2)]
    # The 99.9 % quantile of chi-squared with 14 degrees of freedom.
    assert statistic < 36.1


def test_a_sample_depends_on_seed_and_number_only(source: Path) -> None:
    one, *_ = sample_scenes(source, 1, 3, rng=5, **COLUMNS)
    several = sample_scenes(source, 3, 3, rng=5, **COLUMNS)

    assert one[1] is None
    assert one[0].to_dicts() == several[0][0].to_dicts()
    assert len({str(scenes.scene_ids) for scenes, _ in several}) > 1


def test_only_ids_are_read_to_count(source: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    read = []
    pieces = ParquetSource.pieces

    def spied(self: ParquetSource, types: Any, n_rows: int) -> Any:
        read.append(list(types))
        return pieces(self, types, n_rows)

    monkeypatch.setattr(ParquetSource, "pieces", spied)
    sample_scenes(source, 1, 1, rng=0, **COLUMNS)

    assert read == [["s"], ["s", "o", "agent", "x"]]


@pytest.mark.parametrize(
    ("n_samples", "size", "message"),
    [
        (0, 1, "n_samples must be"),
        (1, 0, "size must be"),
        (1, 7, "size must be at most the 6 scenes of .*, got 7"),
    ],
)
def test_impossible_samples_are_refused(source: Path, n_samples: int, size: int, message: str) -> None:
    with pytest.raises(InputError, match=message):
        sample_scenes(source, n_samples, size, rng=0, **COLUMNS)
