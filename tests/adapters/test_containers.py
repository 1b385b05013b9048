from __future__ import annotations

from types import SimpleNamespace
from typing import Any, final

import numpy as np
import pettingzoo
import pytest

from relforest import Attribute, Schema
from relforest.adapters import (
    bags_from_padded,
    bags_from_sawmil,
    bags_from_torchmil,
    padded_bags,
    scenes_from_rows,
)
from relforest.datasets import covariant2
from relforest.support.errors import InputError

DATA = covariant2(np.random.default_rng(0))
PLANE = Schema([Attribute("location", 2), Attribute("speed")])


@final
class Tensor:
    """As torch's: part of a graph on a GPU, so that NumPy cannot read it as it is."""

    def __init__(self, values: Any) -> None:
        self._values = np.asarray(values)

    def __array__(self, dtype: object = None, copy: object = None) -> Any:
        raise TypeError("can't convert cuda:0 device type tensor to numpy")

    def detach(self) -> Tensor:
        return self

    def cpu(self) -> Any:
        return self._values


def are_same(bags: Any) -> bool:
    return all(np.array_equal(*pair) for pair in zip(bags, DATA.bags, strict=True))


def test_padded_bags_return() -> None:
    points, mask = padded_bags(DATA, fill=np.nan)

    assert points.shape == (*mask.shape, DATA.n_features)
    assert np.array_equal(mask.sum(axis=1), [len(bag) for bag in DATA.bags])
    assert np.isnan(points[~mask]).all()
    assert are_same(bags_from_padded(points, mask.astype(float)))


def test_bags_of_sawmil_are_positive_above_0() -> None:
    labels = np.where(DATA.labels, 1.0, -1.0)
    pairs = zip(DATA.bags, labels, strict=True)
    dataset = SimpleNamespace(bags=[SimpleNamespace(X=bag, y=label) for bag, label in pairs])

    for given in (dataset, dataset.bags):
        found = bags_from_sawmil(given)
        assert are_same(found.bags)
        assert np.array_equal(found.labels, DATA.labels)


def test_bags_of_sawmil_itself_are_read() -> None:
    # It is not among the packages for tests, because it would raise the lowest version of SciPy.
    sawmil = pytest.importorskip("sawmil")
    found = bags_from_sawmil(sawmil.BagDataset.from_arrays(DATA.bags, DATA.labels))
    assert are_same(found.bags)
    assert np.array_equal(found.labels, DATA.labels)


def test_bags_and_batches_of_torchmil_are_read() -> None:
    # torchmil itself needs torch, which is too large for the packages for tests.
    points, mask = map(Tensor, padded_bags(DATA))
    batch = {"X": points, "Y": Tensor(DATA.labels.astype(int)[:, None]), "mask": mask, "adj": None}
    pairs = zip(DATA.bags, DATA.labels, strict=True)
    single = [{"X": Tensor(bag), "Y": Tensor(int(label))} for bag, label in pairs]

    for given in (batch, [batch], single, iter(single)):
        found = bags_from_torchmil(given)
        assert are_same(found.bags)
        assert np.array_equal(found.labels, DATA.labels)


@pytest.mark.parametrize(
    ("read", "given", "said"),
    [
        (bags_from_sawmil, [np.zeros((2, 3))], "pass a sawmil.BagDataset or a list of its bags"),
        (bags_from_sawmil, 3, "pass a sawmil.BagDataset or a list of its bags"),
        (bags_from_sawmil, [], "there are no bags"),
        (bags_from_sawmil, [SimpleNamespace(X=np.empty((0, 2)), y=1.0)], "bag 0 is empty"),
        (bags_from_torchmil, [np.zeros((2, 3))], "is a mapping with X and Y, got array"),
        (bags_from_torchmil, [{"X": np.zeros((2, 3))}], "is a mapping with X and Y, got "),
        (bags_from_torchmil, [{"X": np.zeros((2, 3)), "Y": 2}], "Y must be 0 or 1 for each of 1 bags"),
        (bags_from_torchmil, {"X": np.zeros((2, 3)), "Y": [0, 1]}, "Y must be 0 or 1 for each of 1 bags"),
        (bags_from_torchmil, {"X": np.zeros((2, 3)), "Y": 1, "mask": [1, 1]}, "points must be an array"),
        (bags_from_torchmil, [], "there are no bags"),
    ],
)
def test_other_containers_are_refused(read: Any, given: Any, said: str) -> None:
    with pytest.raises(InputError, match=said):
        read(given)


@pytest.mark.parametrize(
    ("points", "mask"),
    [
        (np.zeros((2, 3)), np.ones((2, 3))),
        (np.zeros((2, 3, 1)), np.ones((2, 2))),
        (np.zeros((2, 3, 1)), np.full((2, 3), 0.5)),
        ([[[1.0], [2.0]], [[1.0]]], np.ones((2, 2))),
    ],
)
def test_masks_must_fit(points: Any, mask: Any) -> None:
    with pytest.raises(InputError, match="array"):
        bags_from_padded(points, mask)


def test_rows_become_scenes_of_the_objects_that_are_there() -> None:
    rows = np.arange(24.0).reshape(2, 4, 3)
    mask = np.array([[1, 0, 1, 0], [0, 0, 0, 0]])
    scenes = scenes_from_rows(rows, PLANE, mask=mask)

    assert scenes.counts.tolist() == [2, 0]
    assert np.array_equal(scenes.matrix, rows[0, [0, 2]])
    assert scenes.object_ids.tolist() == [0, 2]
    for flag in (0, 2, -1):
        flagged = np.insert(rows, rows.shape[-1] if flag == -1 else flag, mask, axis=-1)
        assert scenes_from_rows(flagged, PLANE, flag=flag) == scenes
    assert scenes_from_rows(rows[0], PLANE, mask=mask[0]) == scenes[:1]


def test_observations_of_pettingzoo_become_scenes() -> None:
    pytest.importorskip("pygame")
    if not hasattr(pettingzoo, "make"):
        pytest.skip("older versions of PettingZoo make this environment in another way")
    env = pettingzoo.make("parallel", "butterfly/knights_archers_zombies-v11", obs_method="vector")
    observations, _ = env.reset(seed=0)
    env.close()
    seen = np.stack(list(observations.values()))
    schema = Schema([Attribute("distance"), Attribute("location", 2), Attribute("heading", 2)])
    scenes = scenes_from_rows(seen, schema, mask=seen.any(axis=2))
    # Two archers and two knights, and a row of the agent that sees them.
    assert scenes.counts.tolist() == [5, 5, 5, 5]
    assert np.array_equal(scenes.values["location"][:5], seen[0, :5, 1:3])


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({}, "say which rows are objects: by mask=, or by flag="),
        ({"mask": [1, 1], "flag": 0}, "say which rows are objects: by mask=, or by flag="),
        ({"flag": 0}, r"rows must be of 4 numbers, in two or three dimensions, got \(2, 3\)"),
        ({"mask": [1]}, "must have one entry for each slot of the mask"),
        ({"mask": [1, 2]}, "the mask 'mask' must be 0 or 1"),
    ],
)
def test_rows_must_fit_the_schema(options: dict[str, Any], said: str) -> None:
    with pytest.raises(InputError, match=said):
        scenes_from_rows(np.zeros((2, 3)), PLANE, **options)
    with pytest.raises(InputError, match="flag must be one of the 4 columns, counted from 0, got 4"):
        scenes_from_rows(np.zeros((2, 4)), PLANE, flag=4)
