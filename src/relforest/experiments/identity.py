"""What the content of a folder depends on, to compare it with the present request."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, final


@final
@dataclass(frozen=True, slots=True, eq=False)
class Identity:
    """What the content of a folder depends on.

    Parameters
    ----------
    file : str
        Name of the file that stores it, such as ``"run.json"``.
    format : str
        The format that the file names, such as ``"relforest-run"``.
    content : mapping
        Plain JSON values: everything that the results depend on, apart from the versions of the software.
    growing : str, optional
        A number in the content that may be raised later.
    """

    file: str
    format: str
    content: Mapping[str, Any]
    growing: str | None = None
