"""A learned tree, digit by digit: what learning does may change on purpose only.

Run with RELFOREST_REGENERATE_GOLDEN=1 to write the file anew, and look at the difference before you keep it.
"""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from interpreted import compiled_only
from relforest import Attribute, Scenes, Schema, SMRFTreeClassifier, Tree
from relforest.support.files import write_json

pytestmark = compiled_only

GOLDEN = Path(__file__).parents[1] / "golden" / "small_tree.json"
SCHEMA = Schema((Attribute("location", 2), Attribute("orientation")), ("passer",))


def learned() -> Tree:
    """From 60 scenes: is some other object ahead of the passer and near, or is the passer turned away?"""
    rng = np.random.default_rng(2015)
    n = 60
    counts = rng.integers(2, 5, size=n)
    starts = np.cumsum(counts) - counts
    matrix = np.column_stack(
        [rng.uniform(-5, 5, (counts.sum(), 2)), rng.uniform(-np.pi, np.pi, counts.sum())]
    )
    matrix[rng.random(len(matrix)) < 0.05, 2] = np.nan
    scenes = Scenes(SCHEMA, matrix, np.arange(len(matrix)), starts, counts, starts[:, None])
    gaps = [
        np.linalg.norm(matrix[start + 1 : start + count, :2] - matrix[start, :2], axis=1).min()
        for start, count in zip(starts, counts, strict=True)
    ]
    away = np.abs(matrix[starts, 2]) > 2
    labels = (np.array(gaps) < 2.5) | away
    return SMRFTreeClassifier(random_state=7, search="exhaustive", attempts=1).fit(scenes, labels).tree_


def assert_close(found: Any, expected: Any, where: str = "tree") -> None:
    """Equal but for the last digits of numbers, which may differ between processors."""
    assert type(found) is type(expected), where
    if isinstance(expected, dict):
        assert list(found) == list(expected), where
        for key, value in expected.items():
            assert_close(found[key], value, f"{where}.{key}")
    elif isinstance(expected, list):
        assert len(found) == len(expected), where
        for position, value in enumerate(expected):
            assert_close(found[position], value, f"{where}[{position}]")
    elif isinstance(expected, float):
        assert found == pytest.approx(expected, rel=1e-6, abs=1e-9), where
    else:
        assert found == expected, where


def test_the_learned_tree_is_the_one_on_file() -> None:
    document = learned().to_dict()
    if os.environ.get("RELFOREST_REGENERATE_GOLDEN") == "1":
        write_json(GOLDEN, document)
    expected = json.loads(GOLDEN.read_text(encoding="utf-8"))

    assert_close(document, expected)
    # It is worth comparing: more than one question, both spaces, every type of node.
    types = [node["kind"] for node in expected["nodes"]]
    assert types.count("question") >= 2
    assert {node["volume"]["shape"] for node in expected["nodes"] if "volume" in node} == {"ellipsoid", "arc"}


def test_the_file_is_still_readable() -> None:
    tree = Tree.from_dict(json.loads(GOLDEN.read_text(encoding="utf-8")))

    assert tree.schema == SCHEMA
    assert not tree.is_stub
