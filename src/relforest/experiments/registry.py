"""All studies by name; a new one is added here."""

from __future__ import annotations

from collections.abc import Iterator
from collections.abc import Mapping as ReadOnly
from importlib import import_module
from typing import TYPE_CHECKING, Any, Final, final

if TYPE_CHECKING:
    from relforest.experiments.study import Study

_PACKAGES: Final = (
    "mil",
    "concepts",
    "calibration",
    "mil_ablation",
    "mil_folds",
    "corridor",
    "keepaway",
    "blocks",
    "resume",
    "outcomes",
)
_LEARNING: Final[ReadOnly[str, tuple[str, str]]] = {
    "keepaway-learning": (
        "KEEPAWAY",
        "How many episodes of keepaway do learners need, also for larger teams?",
    ),
    "high-towers-learning": ("TOWERS", "How many episodes do learners need to build high towers?"),
    "color-learning": ("COLORS", "How many episodes do learners need to group blocks by color?"),
    "arch-learning": ("ARCH", "How many episodes do learners need to build arches?"),
}
"""Studies of the package ``learning``, one for each task: name -> name in its module, and question."""

_PLACES: Final[ReadOnly[str, tuple[str, str]]] = {
    **{name: (name, "STUDY") for name in _PACKAGES},
    **{name: ("learning", constant) for name, (constant, _) in _LEARNING.items()},
}
"""Name of a study -> its package, and its name there."""


def question_of(name: str) -> str:
    """Return the question of a study without loading it."""
    return _LEARNING[name][1] if name in _LEARNING else heading(f"relforest.experiments.{name}")[1]


def heading(package: str) -> tuple[str, str]:
    """Return the name of a study and its question: the first line of the docstring of its package."""
    return package.rpartition(".")[2], str(import_module(package).__doc__).partition("\n")[0]


@final
class _Studies(ReadOnly[str, "Study[Any]"]):
    """Studies that are loaded when they are asked for."""

    def __getitem__(self, name: str) -> Study[Any]:
        """Load a study."""
        package, constant = _PLACES[name]
        module = import_module(f"relforest.experiments.{package}.analysis")
        study: Study[Any] = getattr(module, constant)
        return study

    def __iter__(self) -> Iterator[str]:
        """Iterate over the names."""
        return iter(_PLACES)

    def __len__(self) -> int:
        """Return the number of studies."""
        return len(_PLACES)


STUDIES: Final[ReadOnly[str, Study[Any]]] = _Studies()
"""Name of a study, as the command line has it -> the study."""
