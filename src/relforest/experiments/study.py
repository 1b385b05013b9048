"""What a study is: settings, a function from a setting to tidy rows, functions from the table to results."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import Field, dataclass
from pathlib import Path
from typing import Any, ClassVar, Generic, Protocol, TypeVar, final

import numpy as np
from matplotlib.figure import Figure

from relforest.experiments.claims import Findings
from relforest.experiments.table import Row, Table
from relforest.support.rng import seed_sequence, stream


class Setting(Protocol):
    """One part of a study that is computed at once: a frozen dataclass of plain JSON values."""

    __dataclass_fields__: ClassVar[dict[str, Field[Any]]]

    def __str__(self) -> str:
        """Return a few words that name the setting."""
        ...


S = TypeVar("S", bound=Setting)


@final
@dataclass(frozen=True, slots=True)
class Place:
    """Where and with which seed a setting is computed.

    Parameters
    ----------
    seed : int
        The seed of the study.
    index : int
        Number of the setting within the study.
    folder : path
        The folder of the study, for settings that write files of their own.
    """

    seed: int
    index: int
    folder: Path

    @property
    def stream(self) -> np.random.SeedSequence:
        """The random stream of this setting."""
        return stream(seed_sequence(self.seed), self.index)


@final
@dataclass(frozen=True, slots=True)
class Study(Generic[S]):
    """A question put to the library, and how it is answered.

    Parameters
    ----------
    name : str
        As the command line has it.
    question : str
        One sentence.
    settings : tuple
        The whole study.
    smoke : tuple
        A small version of it, done in seconds, that goes through the same code.
    compute : callable
        Turns a setting into rows. It must be a function of a module, draw its random numbers from
        `Place.stream` or `Place.seed`, and go on where it was interrupted if it takes long.
    summarize : callable
        Turns the table of all rows into findings.
    figures : callable
        Turns the table into figures by file name.
    compiles : bool
        Whether settings call kernels in the process that runs them. These are then compiled before several
        processes start, by running the first small setting.
    """

    name: str
    question: str
    settings: tuple[S, ...]
    smoke: tuple[S, ...]
    compute: Callable[[S, Place], list[Row]]
    summarize: Callable[[Table], Findings]
    figures: Callable[[Table], Mapping[str, Figure]]
    compiles: bool = True
