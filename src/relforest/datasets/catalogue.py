"""Facts about the published sets of bags of the comparison in Palmer (2015), section 3.3.2."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Final

from relforest.datasets.bag_set import About
from relforest.support.files import read_input


def file_name(name: str) -> str:
    """Return the name of the file of a data set."""
    return f"{name}.csv.gz"


_ENTRIES: Final = tomllib.loads(read_input(Path(__file__).with_suffix(".toml")).decode())
SHA256: Final[Mapping[str, str]] = MappingProxyType(
    {file_name(name): entry.pop("sha256") for name, entry in _ENTRIES.items() if "sha256" in entry}
)
_SETS: Final = {name: About(name, **entry) for name, entry in _ENTRIES.items()}
EAST_WEST: Final = _SETS.pop("east_west")
CATALOGUE: Final[Mapping[str, About]] = MappingProxyType(_SETS)
