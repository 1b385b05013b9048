"""All studies by name; a new one is added here."""

from __future__ import annotations

from collections.abc import Iterator
from collections.abc import Mapping as ReadOnly
from importlib import import_module
from typing import TYPE_CHECKING, Any, Final, final

if TYPE_CHECKING:
    from relforest.experiments.study import Study

_PACKAGES: Final = {
    name: f"relforest.experiments.{name}"
    for name in ("mil", "concepts", "calibration", "mil_ablation", "corridor", "keepaway", "blocks", "resume")
}


def heading(package: str) -> tuple[str, str]:
    """Return the name of a study and its question: the first line of the docstring of its package."""
    return package.rpartition(".")[2], str(import_module(package).__doc__).partition("\n")[0]


@final
class _Studies(ReadOnly[str, "Study[Any]"]):
    """Studies that are loaded when they are asked for."""

    def __getitem__(self, name: str) -> Study[Any]:
        """Load a study."""
        study: Study[Any] = import_module(f"{_PACKAGES[name]}.analysis").STUDY
        return study

    def __iter__(self) -> Iterator[str]:
        """Iterate over the names."""
        return iter(_PACKAGES)

    def __len__(self) -> int:
        """Return the number of studies."""
        return len(_PACKAGES)


STUDIES: Final[ReadOnly[str, Study[Any]]] = _Studies()
"""Name of a study, as the command line has it -> the study."""
