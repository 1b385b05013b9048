"""Values by neural networks: of a whole vector, or of a set of its parts (Deep Sets).

PyTorch learns them; to play what was learned, NumPy is enough.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any, ClassVar, Final, final

import numpy as np
from numpy.typing import NDArray

from relforest.rl.fitted.evidence import Evidence, check_values
from relforest.rl.vectors.approximator import Model, Rows
from relforest.rl.vectors.sweeps import TRACE
from relforest.scenes.arrays import FloatArray
from relforest.support.errors import ModelFormatError
from relforest.support.options import at_least, in_range
from relforest.support.progress import report

Floats = NDArray[np.float32]

_HIDDEN: Final = 64
_LAYERS: Final = 4


@final
@dataclass(frozen=True, slots=True, eq=False)
class Network:
    """Two layers for each part of a vector, and two for the sum over the parts that are not zero.

    References
    ----------
    Zaheer et al., Deep Sets (2017).
    """

    parts: int  # into how many parts of equal length a vector is cut; 1 makes it an ordinary network
    layers: tuple[tuple[Floats, Floats], ...]  # weights and constants of the layers
    scale: FloatArray  # (2,) mean and deviation that give the output its unit

    fields: ClassVar[tuple[str, ...]] = (
        "parts",
        "scale",
        *(f"{name}{number}" for number in range(_LAYERS) for name in ("weights", "constants")),
    )

    @classmethod
    def drawn(cls, parts: int, width: int, scale: FloatArray, rng: np.random.Generator) -> Network:
        """Return a network with random weights (He et al., 2015) for vectors of `width` numbers."""
        layers = tuple(
            (
                (rng.standard_normal(shape) * np.sqrt(2.0 / shape[0])).astype(np.float32),
                np.zeros(shape[1], dtype=np.float32),
            )
            for shape in _shapes(width, parts)
        )
        return cls(parts, layers, scale)

    def values(self, rows: Rows) -> FloatArray:
        """Return the values of actions, (c,)."""
        pieces = _pieces(rows.vectors, self.parts)
        (a, b), (c, d), (e, f), (g, h) = self.layers
        hidden = np.maximum(np.maximum(pieces @ a + b, 0.0) @ c + d, 0.0) * pieces.any(axis=2, keepdims=True)
        out = np.maximum(hidden.sum(axis=1) @ e + f, 0.0) @ g + h
        values: FloatArray = self.scale[0] + self.scale[1] * out[:, 0].astype(np.float64)
        return values

    def arrays(self) -> Mapping[str, NDArray[Any]]:
        """Return the layers, the parts and the scale."""
        flat = [array for layer in self.layers for array in layer]
        return dict(zip(self.fields, [np.array([self.parts]), self.scale, *flat], strict=True))

    @classmethod
    def of(cls, arrays: Mapping[str, NDArray[Any]], width: int, *, origin: str) -> Network:
        """Return the network of arrays; `ModelFormatError` if they are not one of vectors (width,)."""
        parts = arrays["parts"]
        if parts.shape != (1,) or parts.dtype != np.int64 or parts[0] < 1 or width % parts[0]:
            raise ModelFormatError(f"{origin}: parts must be a number that divides {width}")
        layers = []
        for number, shape in enumerate(_shapes(width, int(parts[0]))):
            layer = arrays[f"weights{number}"], arrays[f"constants{number}"]
            if [each.shape for each in layer] != [shape, shape[1:]] or {each.dtype for each in layer} != {
                np.dtype(np.float32)
            }:
                raise ModelFormatError(f"{origin}: layer {number} must be of the shape {shape}, in float32")
            layers.append(layer)
        scale = arrays["scale"]
        if scale.shape != (2,) or scale.dtype != np.float64:
            raise ModelFormatError(f"{origin}: scale must be two numbers")
        if not all(np.isfinite(each).all() for each in (scale, *sum(layers, ()))):
            raise ModelFormatError(f"{origin}: the network contains numbers that are not finite")
        return cls(int(parts[0]), tuple(layers), scale)


@final
@dataclass(frozen=True, slots=True)
class NetworkQ:
    """Neural fitted Q iteration on all experience, with a target network and double Q-learning.

    Parameters
    ----------
    name : str
        What it is called.
    parts : int
        See `Network`.
    sweeps : int
        How often the target network is renewed whenever it learns.
    steps : int
        Steps of Adam between.
    batch : int
        Transitions of a step, drawn from all.
    rate : float
        Step size.

    References
    ----------
    Riedmiller, Neural fitted Q iteration (2005); van Hasselt, Guez and Silver (2016).
    """

    name: str
    parts: int = 1
    sweeps: int = 10
    steps: int = 500
    batch: int = 256
    rate: float = 1e-3

    model: ClassVar[type[Model]] = Network

    def __post_init__(self) -> None:
        for name in ("parts", "sweeps", "steps", "batch"):
            at_least(name, getattr(self, name), 1)
        in_range("rate", self.rate, 0.0, 1.0, open_low=True)

    def improved(
        self, before: Network | None, evidence: Evidence, rows: Rows, rng: np.random.Generator
    ) -> Network:
        """Return a network that has learned from all experience, beginning with an earlier one."""
        earned = evidence.earned()
        network = before
        if network is None:
            scale = np.array([earned.mean(), max(float(earned.std()), evidence.scale)])
            network = Network.drawn(self.parts, rows.vectors.shape[1], scale, rng)
        examples = _pieces(rows.vectors[evidence.taken], self.parts)
        values = judged = _bounded(network, rows, evidence)
        with _training(network, self.rate) as training:
            for sweep in range(self.sweeps):
                report("target networks", sweep, self.sweeps)
                is_first = before is None and sweep == 0
                targets = earned if is_first else evidence.targets(values, TRACE, judged)
                wanted = ((targets - network.scale[0]) / network.scale[1]).astype(np.float32)
                for _ in range(self.steps):
                    chosen = rng.integers(len(wanted), size=self.batch)
                    training.step(examples[chosen], wanted[chosen])
                network, judged = Network(self.parts, training.layers(), network.scale), values
                values = _bounded(network, rows, evidence)
        return network

    def to_dict(self) -> dict[str, Any]:
        """Return the name of the learner and its options."""
        return {name: getattr(self, name) for name in ("name", "parts", "sweeps", "steps", "batch", "rate")}


def _bounded(network: Network, rows: Rows, evidence: Evidence) -> FloatArray:
    """Return values of actions within what rewards allow, which networks exceed for actions never tried."""
    largest = evidence.largest_value
    values = np.clip(network.values(rows), -largest, largest)
    check_values(values, evidence)  # NaN
    return values


def _shapes(width: int, parts: int) -> tuple[tuple[int, int], ...]:
    return (width // parts, _HIDDEN), (_HIDDEN, _HIDDEN), (_HIDDEN, _HIDDEN), (_HIDDEN, 1)


def _pieces(vectors: FloatArray, parts: int) -> Floats:
    shape = (len(vectors), parts, vectors.shape[1] // parts)
    return vectors.reshape(shape).astype(np.float32)


@final
class _Training:
    """The weights of a network while PyTorch changes them."""

    def __init__(self, network: Network, rate: float) -> None:
        import torch  # noqa: PLC0415 - an optional dependency, slow to import

        self._torch = torch
        self._layers = [
            [torch.tensor(array, requires_grad=True) for array in layer] for layer in network.layers
        ]
        self._adam = torch.optim.Adam([array for layer in self._layers for array in layer], lr=rate)

    def step(self, pieces: Floats, wanted: Floats) -> None:
        """Take a step towards the wanted outputs, by Huber's loss."""
        torch, x = self._torch, self._torch.from_numpy(pieces)
        (a, b), (c, d), (e, f), (g, h) = self._layers
        hidden = torch.relu(torch.relu(x @ a + b) @ c + d) * (x != 0).any(dim=2, keepdim=True)
        out = torch.relu(hidden.sum(dim=1) @ e + f) @ g + h
        loss = torch.nn.functional.smooth_l1_loss(out[:, 0], torch.from_numpy(wanted))
        self._adam.zero_grad()
        loss.backward()
        self._adam.step()

    def layers(self) -> tuple[tuple[Floats, Floats], ...]:
        """Return a copy of the present weights."""
        found = [[array.detach().numpy().copy() for array in layer] for layer in self._layers]
        return tuple((weights, constants) for weights, constants in found)


@contextmanager
def _training(network: Network, rate: float) -> Iterator[_Training]:
    """Train with one thread, so that sums are taken in the same order on any machine."""
    training = _Training(network, rate)
    import torch  # noqa: PLC0415 - loaded by now

    n_threads = torch.get_num_threads()
    torch.set_num_threads(1)
    try:
        yield training
    finally:
        torch.set_num_threads(n_threads)
