from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from interpreted import compiled_only
from relforest.rl.vectors.approximator import Rows
from relforest.rl.vectors.networks import Network, NetworkQ, _Training
from relforest.support.errors import InputError, ModelFormatError
from rl.vectors.picked_things import learned, reward

SMALL = NetworkQ("dqn", sweeps=4, steps=150, batch=64, rate=3e-3)


def network(parts: int = 3, width: int = 6) -> Network:
    return Network.drawn(parts, width, np.array([5.0, 2.0]), np.random.default_rng(0))


def rows(vectors: Any) -> Rows:
    return Rows(np.array(vectors, dtype=np.float64), np.arange(len(vectors)))


def test_values_by_plain_sums() -> None:
    found = network()
    vector = np.array([1.0, 2.0, 0.0, 0.0, -1.0, 3.0])
    layers = [(weights.astype(float), constants.astype(float)) for weights, constants in found.layers]
    total = np.zeros(64)
    for part in (vector[:2], vector[4:]):  # the one between is nobody
        inner = [max(0.0, float(part @ layers[0][0][:, i])) for i in range(64)]
        total += [max(0.0, float(np.array(inner) @ layers[1][0][:, i])) for i in range(64)]
    hidden = [max(0.0, float(total @ layers[2][0][:, i])) for i in range(64)]
    expected = 5.0 + 2.0 * float(np.array(hidden) @ layers[3][0][:, 0])
    assert found.values(rows([vector])) == pytest.approx([expected], rel=1e-4)


def test_the_order_of_parts_does_not_matter() -> None:
    one, other = network().values(rows([[1, 2, 0, 0, 3, 4], [3, 4, 1, 2, 0, 0]]))
    assert one == pytest.approx(other, rel=1e-5)


def test_a_network_survives_its_arrays() -> None:
    found, some = network(), rows([[1, 2, 0, 0, 3, 4]])
    assert tuple(found.arrays()) == Network.fields
    np.testing.assert_array_equal(
        Network.of(found.arrays(), 6, origin="file").values(some), found.values(some)
    )


@pytest.mark.parametrize(
    ("name", "array", "message"),
    [
        ("parts", np.array([4]), "parts must be a number that divides 6"),
        ("parts", np.array([2]), "layer 0 must be of the shape"),
        ("weights1", np.zeros((64, 64)), "layer 1 must be of the shape"),
        ("constants2", np.full(64, np.nan, dtype=np.float32), "numbers that are not finite"),
        ("scale", np.zeros(3), "scale must be two numbers"),
    ],
)
def test_damaged_networks_are_refused(name: str, array: Any, message: str) -> None:
    with pytest.raises(ModelFormatError, match=f"file: .*{message}"):
        Network.of({**network().arrays(), name: array}, 6, origin="file")


@pytest.mark.parametrize("options", [{"parts": 0}, {"sweeps": 0}, {"steps": 0}, {"rate": 0.0}])
def test_options_out_of_range_are_refused(options: dict[str, Any]) -> None:
    with pytest.raises(InputError, match=next(iter(options))):
        NetworkQ("dqn", **options)


def test_pytorch_computes_the_same_and_brings_outputs_closer() -> None:
    pytest.importorskip("torch")
    found, rng = network(), np.random.default_rng(1)
    pieces = rng.normal(size=(40, 3, 2)).astype(np.float32)
    pieces[::2, 1] = 0.0
    wanted = pieces.sum(axis=(1, 2))
    some = rows(pieces.reshape(40, 6))
    training = _Training(found, 1e-3)
    np.testing.assert_allclose(
        Network(3, training.layers(), found.scale).values(some), found.values(some), rtol=1e-6
    )
    for _ in range(200):
        training.step(pieces, wanted)
    after = (Network(3, training.layers(), found.scale).values(some) - 5.0) / 2.0
    assert np.abs(after - wanted).mean() < 0.1


@compiled_only
@pytest.mark.parametrize("parts", [1, 3])
def test_it_learns_which_things_are_worth_picking(parts: int) -> None:
    pytest.importorskip("torch")
    first, again = (learned(replace(SMALL, parts=parts), 3) for _ in range(2))
    assert reward(first) > 1.9
    assert first.value is not None
    assert again.value is not None
    arrays = again.value.model.arrays()
    for name, array in first.value.model.arrays().items():
        np.testing.assert_array_equal(array, arrays[name])
