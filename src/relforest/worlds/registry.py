"""The names of the worlds, and their registration with Gymnasium."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Final

from relforest.support.options import one_of

ENVIRONMENT_IDS: Final[Mapping[str, str]] = MappingProxyType(
    {
        "corridor": "relforest/Corridor-v0",
        "keepaway": "relforest/Keepaway-v0",
        "high-towers": "relforest/HighTowers-v0",
        "color-grouping": "relforest/ColorGrouping-v0",
        "arch": "relforest/Arch-v0",
    }
)
"""Name of a world on the command line -> its identifier for ``gymnasium.make``."""

_ENTRY_POINTS: Final[Mapping[str, str]] = MappingProxyType(
    {
        "relforest/Corridor-v0": "relforest.worlds.corridor.env:make_corridor",
        "relforest/Keepaway-v0": "relforest.worlds.keepaway.env:make_keepaway",
        "relforest/HighTowers-v0": "relforest.worlds.blocks.env:make_high_towers",
        "relforest/ColorGrouping-v0": "relforest.worlds.blocks.env:make_color_grouping",
        "relforest/Arch-v0": "relforest.worlds.blocks.env:make_arch",
    }
)

# Worlds that play many games at once; `gymnasium.make_vec` uses these by default.
_VECTOR_ENTRY_POINTS: Final[Mapping[str, str]] = MappingProxyType(
    {"relforest/Keepaway-v0": "relforest.worlds.keepaway.vector:KeepawayVectorEnv"}
)


def environment_id(world: str) -> str:
    """Return the Gymnasium identifier of a world, a key of `ENVIRONMENT_IDS`, such as ``"corridor"``.

    Raises
    ------
    InputError
        If the world is unknown; the message lists all worlds.
    """
    return ENVIRONMENT_IDS[one_of("world", world, tuple(ENVIRONMENT_IDS))]


def register_worlds() -> None:
    """Register all worlds with Gymnasium, skipping those that are registered already.

    Importing `relforest` does it: therefore ``gymnasium.make("relforest:relforest/Corridor-v0")`` works
    before any import.
    """
    import gymnasium  # noqa: PLC0415 - names of worlds are needed without it

    for identifier, entry_point in _ENTRY_POINTS.items():
        if identifier not in gymnasium.registry:
            gymnasium.register(
                identifier,
                entry_point=entry_point,
                vector_entry_point=_VECTOR_ENTRY_POINTS.get(identifier),
            )
