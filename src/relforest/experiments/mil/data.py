"""The data sets: what each is called, and where its bags come from.

East-West, the fourteenth of the source, is not among them: no copy of it is at hand. Covariant 1 is there
twice: the means that Table 3.1 prints for its negatives, (-2, 2) and (2, -2), make an easier problem than the
one in Table 3.2; means at distance 2 from the origin reproduce the scores of that one.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache, partial
from typing import Final, Protocol, TypeAlias, TypeVar, final

import numpy as np
from numpy.typing import NDArray

from relforest.datasets import (
    BagSet,
    color,
    covariant1,
    covariant2,
    disjunctive,
    false_frequency,
    fetch,
    poisoned_presence,
    poisoned_threshold,
)
from relforest.datasets.catalogue import file_name
from relforest.datasets.download import DATA_VARIABLE, URL_VARIABLE
from relforest.experiments.study import Unavailable
from relforest.support.errors import MissingDataError
from relforest.support.rng import generator, seed_sequence, stream

N_FOLDS: Final = 10
"""Parts of a standard data set, each of which is the test set once."""

_DRAWS, _FOLDS, _TUNING = 0, 1, 2


@final
@dataclass(frozen=True, slots=True)
class Synthetic:
    """A data set that can be drawn any number of times."""

    title: str  # as tables have it
    key: int  # its number in the names of random streams; never given to another one
    draw: Callable[[np.random.Generator, int], BagSet]  # draws the given number of bags
    draw_test: Callable[[np.random.Generator, int], BagSet] | None = None
    """Draws test bags, if their distribution is another one than that of training bags."""


@final
@dataclass(frozen=True, slots=True)
class Standard:
    """A data set that exists once."""

    title: str
    key: int
    """Both as of a synthetic one."""
    fetch: Callable[[], BagSet]
    """Reads the bags, or raises a `DataError`: a `MissingDataError` if the file is missing."""


DataSet: TypeAlias = Synthetic | Standard


class _OnData(Protocol):
    """A setting that uses a data set, of this study or made up for another one."""

    @property
    def data_set(self) -> str:
        """Its name."""
        ...


OnData = TypeVar("OnData", bound=_OnData)


@final
@dataclass(frozen=True, slots=True, eq=False)
class Split:
    """What is learned from, and what is then predicted."""

    train: BagSet
    test: BagSet


def _tested(draw: Callable[..., BagSet], title: str, key: int, *, is_changed: bool) -> Synthetic:
    def drawn(rng: np.random.Generator, n_bags: int, part: str) -> BagSet:
        return draw(rng, part=part, n_bags=n_bags)

    return Synthetic(
        title, key, partial(drawn, part="train"), partial(drawn, part="test") if is_changed else None
    )


PRINTED: Final = "covariant1-printed"

ASSUMPTIONS: Final[Mapping[str, Synthetic]] = {
    "presence": _tested(poisoned_presence, "Presence", 14, is_changed=False),
    "presence-poisoned": _tested(poisoned_presence, "Presence, poisoned", 15, is_changed=True),
    "threshold": _tested(poisoned_threshold, "Threshold", 16, is_changed=False),
    "threshold-poisoned": _tested(poisoned_threshold, "Threshold, poisoned", 17, is_changed=True),
    "frequency": _tested(false_frequency, "Frequency", 18, is_changed=False),
    "frequency-false": _tested(false_frequency, "Frequency, false", 19, is_changed=True),
}
"""Tests of Raff and Holt (2023), each with test bags like those of training, and with others."""

DATA_SETS: Final[Mapping[str, DataSet]] = {
    "color": Synthetic("Color", 0, lambda rng, n: color(rng, n_bags=n)),
    "covariant1": Synthetic("Covariant 1", 1, lambda rng, n: covariant1(rng, reading="sqrt2", n_bags=n)),
    PRINTED: Synthetic(
        "Covariant 1, means as printed", 13, lambda rng, n: covariant1(rng, reading="printed", n_bags=n)
    ),
    "covariant2": Synthetic("Covariant 2", 2, lambda rng, n: covariant2(rng, n_bags=n)),
    "disjunctive": Synthetic("Disjunctive", 3, lambda rng, n: disjunctive(rng, n_bags=n)),
    "musk1": Standard("Musk 1", 4, partial(fetch, "musk1")),
    "musk2": Standard("Musk 2", 5, partial(fetch, "musk2")),
    "mutagenesis-atoms": Standard("Muta Atoms", 6, partial(fetch, "mutagenesis_atoms")),
    "mutagenesis-bonds": Standard("Muta Bonds", 7, partial(fetch, "mutagenesis_bonds")),
    "mutagenesis-chains": Standard("Muta Chains", 8, partial(fetch, "mutagenesis_chains")),
    "thioredoxin": Standard("Thioredoxin", 9, partial(fetch, "thioredoxin")),
    "elephant": Standard("Elephant", 10, partial(fetch, "elephant")),
    "fox": Standard("Fox", 11, partial(fetch, "fox")),
    "tiger": Standard("Tiger", 12, partial(fetch, "tiger")),
    **ASSUMPTIONS,
}
"""Name on the command line -> data set, in the order of the source's tables; then tests of assumptions."""

COMPARED: Final = tuple(name for name in DATA_SETS if name not in (PRINTED, *ASSUMPTIONS))
"""Data sets of the source that all methods are tried on."""

DESIGNED_WITH: Final = ("color", "covariant1", "covariant2", "disjunctive", "musk1")
HELD_OUT: Final = tuple(name for name in COMPARED if name not in DESIGNED_WITH)
"""Data sets that played no part in designing the committee.

On the others its score is flattering, as that of the best of several variants. See the ``README.md`` of this
study and that of ``mil_ablation`` for what was known of these.
"""


def splitter(data_set: DataSet, *, seed: int, n_bags: int) -> Callable[[int], Split]:
    """Return a function from the number of a fold to its bags, the same for all methods.

    Of a synthetic data set, `n_bags` are drawn for each training and test set; a fold of a standard one is
    one of `N_FOLDS` parts.
    """
    if isinstance(data_set, Synthetic):
        draws = stream(seed_sequence(seed), _DRAWS, data_set.key)
        return lambda fold: _drawn(data_set, n_bags, stream(draws, fold))
    return cross_validation(
        _fetched(data_set.fetch), generator(stream(seed_sequence(seed), _FOLDS, data_set.key))
    )


def cross_validation(all_bags: BagSet, rng: np.random.Generator) -> Callable[[int], Split]:
    """Return a function from the number of a fold, 0 to ``N_FOLDS - 1``, to its bags, stratified."""
    parts = stratified_parts(all_bags.labels, N_FOLDS, rng)
    return lambda fold: Split(_taken(all_bags, parts != fold), _taken(all_bags, parts == fold))


def tuning_splits(data_set: Synthetic, *, seed: int, n_bags: int, count: int) -> list[Split]:
    """Return splits of a synthetic data set that are never used for scores."""
    return [
        _drawn(data_set, n_bags, stream(seed_sequence(seed), _TUNING, data_set.key, number))
        for number in range(count)
    ]


def stratified_parts(labels: NDArray[np.bool_], n_parts: int, rng: np.random.Generator) -> NDArray[np.int64]:
    """Deal bags out at random to parts of nearly equal size with nearly equal shares of positives.

    Return the part of each bag, (n_bags,): counts of parts differ by at most one, of either class and in
    total.
    """
    order = np.concatenate([rng.permutation(np.flatnonzero(labels == label)) for label in (True, False)])
    parts = np.empty(len(labels), dtype=np.int64)
    parts[order] = np.arange(len(labels)) % n_parts
    return parts


def unavailable(settings: Sequence[OnData]) -> Mapping[OnData, Unavailable]:
    """Return those of the settings whose data cannot be used here, with the remedy.

    Raises
    ------
    DataError
        If a file is a wrong one, or cannot be read or downloaded.
    """
    names = dict.fromkeys(setting.data_set for setting in settings)
    missing = {name: absence for name in names if (absence := _absence(name)) is not None}
    return {setting: missing[setting.data_set] for setting in settings if setting.data_set in missing}


def _absence(name: str) -> Unavailable | None:
    data_set = DATA_SETS.get(name)
    if isinstance(data_set, Standard):
        try:
            data_set.fetch()
        except MissingDataError:
            # The reason is the same for all data sets, so it is printed once.
            return Unavailable(f"{data_set.title} ({file_name(name.replace('-', '_'))})", _remedy())
    return None


@lru_cache(maxsize=1)
def _fetched(fetch: Callable[[], BagSet]) -> BagSet:
    return fetch()


def _remedy() -> str:
    now = os.environ.get(DATA_VARIABLE)
    return (
        f"These files were not found: set the environment variable {DATA_VARIABLE} "
        f"({f'now {now}' if now else 'not set now'}) to a folder that contains them, directly or in a folder "
        f"mil, or {URL_VARIABLE} to the address of a folder to download them from."
    )


def _drawn(data_set: Synthetic, n_bags: int, seed: np.random.SeedSequence) -> Split:
    rng = generator(seed)
    return Split(data_set.draw(rng, n_bags), (data_set.draw_test or data_set.draw)(rng, n_bags))


def _taken(all_bags: BagSet, which: NDArray[np.bool_]) -> BagSet:
    return BagSet([all_bags.bags[number] for number in np.flatnonzero(which)], all_bags.labels[which])
