"""What a study is: settings, a function from a setting to tidy rows, and functions from rows to results."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import Field, dataclass, field, replace
from pathlib import Path
from typing import Any, ClassVar, Generic, Protocol, TypeVar, final

import numpy as np
from matplotlib.figure import Figure

from relforest.experiments.claims import Findings
from relforest.experiments.runs import RunInFolder
from relforest.experiments.table import Row, Table
from relforest.support.errors import InputError
from relforest.support.options import at_least, one_of
from relforest.support.rng import seed_sequence, stream


class Setting(Protocol):
    """The part of a study that one task computes: a frozen dataclass of plain JSON values."""

    __dataclass_fields__: ClassVar[dict[str, Field[Any]]]

    def __str__(self) -> str:
        """Return a few words that name the setting."""
        ...


S = TypeVar("S", bound=Setting)


@final
@dataclass(frozen=True, slots=True)
class Context:
    """Where a setting is computed, and with which seed.

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
class Unavailable:
    """Why a setting cannot be computed here.

    Parameters
    ----------
    missing : str
        What is missing, such as the title of a data set.
    reason : str
        Why it is missing and what to do about it; the same text for everything missing for the same reason.
    """

    missing: str
    reason: str


@final
@dataclass(frozen=True, slots=True)
class Study(Generic[S]):
    """A question about the library, and how it is answered.

    Parameters
    ----------
    name : str
        As on the command line: that of its package.
    question : str
        One sentence: the first line of the docstring of its package; see `heading` in `registry`.
    settings : tuple
        The whole study.
    smoke : tuple
        A small version that runs the same code in seconds.
    compute : callable
        Turns a setting into rows. It must be a function of a module, and draw its random numbers from
        `Context.stream` or `Context.seed`.
    summarize : callable
        Turns the table of all rows into findings.
    figures : callable
        Turns the table into figures by file name; by default none.
    compiles : bool
        Whether settings call kernels in their own process. The kernels are then compiled before several
        processes start, by running the first small setting.
    choices : mapping of str to callable
        How settings are chosen: for each option of the command line, such as ``"methods"``, a function that
        returns the value of a setting.
    sizes : mapping of str to callable
        How the study is made larger or smaller: for each option of the command line, such as ``"runs"``, a
        function that turns a setting and the number into the settings that take its place.
    unavailable : callable, optional
        Returns those of the given settings that cannot be computed here, each with the reason.
    learned : callable, optional
        For a study of learners: the run that a setting is about, in a folder below that of the study. It is
        learned, or resumed, before `compute` turns what is in its folder into rows. None where nothing is
        learned.
    """

    name: str
    question: str
    settings: tuple[S, ...]
    smoke: tuple[S, ...]
    compute: Callable[[S, Context], list[Row]]
    summarize: Callable[[Table], Findings]
    figures: Callable[[Table], Mapping[str, Figure]] = lambda _table: {}
    compiles: bool = True
    choices: Mapping[str, Callable[[S], str]] = field(default_factory=dict)
    sizes: Mapping[str, Callable[[S, int], tuple[S, ...]]] = field(default_factory=dict)
    unavailable: Callable[[Sequence[S]], Mapping[S, Unavailable]] | None = None
    learned: Callable[[S, Context], RunInFolder | None] | None = None


def resized(study: Study[S], sizes: Mapping[str, int]) -> Study[S]:
    """Return a study with other numbers of runs and the like; it needs a folder of its own.

    Parameters
    ----------
    study : Study
    sizes : mapping of str to int
        Numbers by option, at least 1.

    Raises
    ------
    InputError
        If the study does not offer a size, or a number is too small.
    """
    for name, number in sizes.items():
        if name not in study.sizes:
            instead = f", only its {' and '.join(study.sizes)}" if study.sizes else ""
            raise InputError(
                f"the number of {name} of the study {study.name} cannot be chosen{instead}: omit it"
            )
        at_least(name, number, 1)
        change = study.sizes[name]
        settings, smoke = (
            tuple(new for setting in old for new in change(setting, number))
            for old in (study.settings, study.smoke)
        )
        study = replace(study, settings=settings, smoke=smoke)
    return study


def repeated(setting: S, number: int) -> tuple[S, ...]:
    """Return that many runs in place of the first run of a condition, and none in place of the others."""
    plain: dict[str, Any] = {name: getattr(setting, name) for name in setting.__dataclass_fields__}
    if plain["run"]:
        return ()
    return tuple(type(setting)(**{**plain, "run": run, "runs": number}) for run in range(number))


def chosen_settings(study: Study[S], settings: Sequence[S], only: Mapping[str, Sequence[str]]) -> list[int]:
    """Return the numbers of the settings that have one of the wanted values for every choice.

    Parameters
    ----------
    study : Study
    settings : sequence
        Those to choose from.
    only : mapping of str to sequence of str
        Wanted values for each choice; an empty sequence keeps all settings.

    Raises
    ------
    InputError
        If the study does not offer a choice or a value, or no setting matches all of them.
    """
    wanted = {name: values for name, values in only.items() if values}
    for name, values in wanted.items():
        if name not in study.choices:
            instead = f", only of {' and '.join(study.choices)}" if study.choices else ""
            raise InputError(f"the study {study.name} does not offer a choice of {name}{instead}: omit it")
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
        raise InputError(f"no setting of the study {study.name} has {described}: choose others")
    return chosen
