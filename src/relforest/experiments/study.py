"""What a study is: settings, a function from a setting to tidy rows, functions from the table to results."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import Field, dataclass, field
from pathlib import Path
from typing import Any, ClassVar, Generic, Protocol, TypeVar, final

import numpy as np
from matplotlib.figure import Figure

from relforest.experiments.claims import Findings
from relforest.experiments.table import Row, Table
from relforest.support.errors import InputError
from relforest.support.options import one_of
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
class Obstacle:
    """Why a setting cannot be computed here.

    Parameters
    ----------
    missing : str
        What it needs, such as the title of a data set.
    reason : str
        Why that is missing, and what to do about it; equal for all that is missing for the same reason.
    """

    missing: str
    reason: str


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
    choices : mapping of str to callable
        What settings may be chosen by: for each option of the command line, such as ``"methods"``, the value
        that a setting has.
    obstacles : callable, optional
        Returns, of the settings it is given, those that cannot be computed here, each with what it lacks.
    """

    name: str
    question: str
    settings: tuple[S, ...]
    smoke: tuple[S, ...]
    compute: Callable[[S, Place], list[Row]]
    summarize: Callable[[Table], Findings]
    figures: Callable[[Table], Mapping[str, Figure]]
    compiles: bool = True
    choices: Mapping[str, Callable[[S], str]] = field(default_factory=dict)
    obstacles: Callable[[Sequence[S]], Mapping[S, Obstacle]] | None = None


def chosen_settings(study: Study[S], settings: Sequence[S], only: Mapping[str, Sequence[str]]) -> list[int]:
    """Return the numbers of the settings that have one of the wanted values in every choice named.

    Parameters
    ----------
    study : Study
    settings : sequence
        Those to choose from.
    only : mapping of str to sequence of str
        Wanted values by choice of the study; without values, a choice leaves all settings.

    Raises
    ------
    InputError
        If the study has no such choice, no setting has a value, or none has all that is wanted.
    """
    wanted = {name: values for name, values in only.items() if values}
    for name, values in wanted.items():
        if name not in study.choices:
            instead = f", only of {' and '.join(study.choices)}" if study.choices else ""
            raise InputError(f"the study {study.name} has no choice of {name}{instead}: leave it out")
        known = tuple(dict.fromkeys(study.choices[name](setting) for setting in settings))
        for value in values:
            one_of(f"{name} of the study {study.name}", value, known)
    chosen = [
        index
        for index, setting in enumerate(settings)
        if all(study.choices[name](setting) in values for name, values in wanted.items())
    ]
    if not chosen:
        described = " and ".join(f"{name} {', '.join(values)}" for name, values in wanted.items())
        raise InputError(f"the study {study.name} has no setting with {described}: choose others")
    return chosen
