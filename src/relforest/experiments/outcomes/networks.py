"""Neural networks that read scenes as sets of objects: Deep Sets, and attention between objects."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Final, cast

import numpy as np
from numpy.typing import NDArray
from sklearn.model_selection import train_test_split

from relforest.experiments.outcomes.rivals import Learner, Scores
from relforest.experiments.outcomes.scenes import Labelled
from relforest.experiments.outcomes.settings import ATTENTION, DEEP_SETS
from relforest.scenes import Scenes
from relforest.scenes.arrays import gather
from relforest.support.progress import report

if TYPE_CHECKING:
    from torch import Tensor, nn

_WIDTH: Final = 64
_HEADS: Final = 4
_EPOCHS: Final = 300
_PATIENCE: Final = 40
_BATCH: Final = 32
_HELD: Final = 0.2
_RATE: Final = 1e-3
_DECAY: Final = 1e-3


def sets(scenes: Scenes) -> tuple[NDArray[np.float32], NDArray[np.bool_]]:
    """Return the objects of scenes as vectors (n, m, k), and where there is one, (n, m).

    A vector holds the attributes of the object, 0 where undefined; which argument it is; and its difference
    from every argument, so that relations to arguments need not be learned. There is at least one place.
    """
    n, n_parameters = len(scenes), scenes.schema.n_parameters
    counts = scenes.counts
    # The last row is that of empty places.
    matrix = np.vstack([np.nan_to_num(scenes.matrix), np.zeros(scenes.schema.width)])
    places = np.arange(max(int(counts.max(initial=1)), 1)) < counts[:, None]
    rows = np.full(places.shape, len(scenes.matrix))
    rows[places] = gather(scenes.rows, scenes.starts, counts)
    pieces = [matrix[rows]]
    for number in range(n_parameters):
        own = scenes.arguments[:, number]
        pieces += [(rows == own[:, None])[..., None], matrix[rows] - matrix[own][:, None]]
    vectors = np.concatenate(pieces, axis=2).astype(np.float32)
    return np.where(places[..., None], vectors, np.float32(0)).reshape(n, places.shape[1], -1), places


def _network(width: int, *, attends: bool) -> nn.ModuleDict:
    """Return the parts of a network for vectors of this width."""
    from torch import nn  # noqa: PLC0415 - an optional dependency, slow to import

    parts = {
        "each": nn.Sequential(nn.Linear(width, _WIDTH), nn.ReLU(), nn.Linear(_WIDTH, _WIDTH)),
        "whole": nn.Sequential(nn.Linear(2 * _WIDTH, _WIDTH), nn.ReLU(), nn.Linear(_WIDTH, 1)),
    }
    if attends:
        layer = nn.TransformerEncoderLayer(_WIDTH, _HEADS, 2 * _WIDTH, dropout=0.1, batch_first=True)
        parts["between"] = nn.TransformerEncoder(layer, 2, enable_nested_tensor=False)
    return nn.ModuleDict(parts)


def _log_odds(network: nn.ModuleDict, vectors: Tensor, places: Tensor) -> Tensor:
    """Return log-odds (n,) for vectors (n, m, width) of objects, and where there is one, (n, m)."""
    import torch  # noqa: PLC0415 - see above

    hidden = network["each"](vectors)
    if "between" in network:
        hidden = network["between"](hidden, src_key_padding_mask=~places)
    hidden = torch.relu(hidden) * places[..., None]
    pooled = torch.cat([hidden.sum(dim=1), hidden.amax(dim=1)], dim=1)
    return cast("Tensor", network["whole"](pooled)[:, 0])


def _learner(*, attends: bool) -> Learner:
    """Return a learner that stops when the loss of a part of the scenes that was held out stops falling."""

    def learn(known: Labelled, seed: int) -> Scores:
        import torch  # noqa: PLC0415 - see above

        vectors, places = sets(known.scenes)
        mean, deviation = vectors[places].mean(axis=0), vectors[places].std(axis=0)
        deviation[deviation == 0.0] = 1.0

        def tensors(vectors: NDArray[np.float32], places: NDArray[np.bool_]) -> tuple[Tensor, Tensor]:
            scaled = np.where(places[..., None], (vectors - mean) / deviation, np.float32(0))
            return torch.from_numpy(scaled), torch.from_numpy(places)

        share = float(known.labels.mean())
        with _seeded(seed):
            network = _network(vectors.shape[2], attends=attends)
            loss = torch.nn.BCEWithLogitsLoss()
            steps = torch.optim.AdamW(network.parameters(), lr=_RATE, weight_decay=_DECAY)
            objects, labels = tensors(vectors, places), torch.from_numpy(known.labels.astype(np.float32))
            numbers = np.arange(len(labels))
            training, held = train_test_split(
                numbers, test_size=_HELD, stratify=known.labels, random_state=seed
            )
            rng, least, best, waited = np.random.default_rng(seed), np.inf, network.state_dict(), 0
            for epoch in range(_EPOCHS):
                report("epochs", epoch, _EPOCHS)
                network.train()
                order = rng.permutation(training)
                for begin in range(0, len(order), _BATCH):
                    batch = order[begin : begin + _BATCH]
                    steps.zero_grad()
                    loss(_log_odds(network, *(each[batch] for each in objects)), labels[batch]).backward()
                    steps.step()
                network.eval()
                with torch.no_grad():
                    judged = _log_odds(network, *(each[held] for each in objects))
                    now = float(loss(judged, labels[held]))
                waited = 0 if now < least else waited + 1
                if now < least:
                    least = now
                    best = {name: array.clone() for name, array in network.state_dict().items()}
                if waited >= _PATIENCE:
                    break
            network.load_state_dict(best)

        def scores(scenes: Scenes) -> NDArray[np.float64]:
            with _seeded(seed), torch.no_grad():
                found = _log_odds(network, *tensors(*sets(scenes))).numpy().astype(np.float64)
            return np.asarray(found - np.log(share / (1.0 - share)))

        return scores

    return learn


@contextmanager
def _seeded(seed: int) -> Iterator[None]:
    """Draw from this seed, and use one thread, so that sums are taken in the same order on any machine."""
    import torch  # noqa: PLC0415 - loaded by now

    n_threads = torch.get_num_threads()
    torch.set_num_threads(1)
    try:
        with torch.random.fork_rng():
            torch.manual_seed(seed)
            yield
    finally:
        torch.set_num_threads(n_threads)


NETWORKS: Final[dict[str, Learner]] = {
    DEEP_SETS: _learner(attends=False),
    ATTENTION: _learner(attends=True),
}
"""Learners that need PyTorch."""
