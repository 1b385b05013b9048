"""The option that names one scene of a table: ``--scene K of FILE``."""

# Heavy imports wait until the command runs, so that --help answers at once.
# ruff: noqa: PLC0415

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from relforest.support.errors import InputError

if TYPE_CHECKING:
    from relforest.models import Model
    from relforest.scenes import Scenes
    from relforest.scenes.dialect import Dialect


def chosen_scene(given: tuple[str, ...], of: Path | None) -> tuple[str, Path] | None:
    """Return the id and the file of the scene that ``--scene`` and ``--of`` name.

    Raises
    ------
    InputError
        If one of them is missing.
    """
    match given:
        case () if of is None:
            return None
        case (key,) if of is not None:
            return key, of
        case (key, "of", file) if of is None:
            return key, Path(file)
        case ():
            raise InputError("--of needs a scene: add --scene K")
        case (key,):
            raise InputError(f"the file of scene {key!r} is missing: write --scene {key} of FILE")
        case _:
            raise InputError(f"--scene {' '.join(given)} is not understood: write --scene K of FILE")


def find_scene(key: str, path: Path, model: Model, dialect: Dialect) -> Scenes:
    """Return a scene of a table by its id.

    Raises
    ------
    InputError
        If there is none, or several.
    """
    from relforest.scenes.columns import listed
    from relforest.scenes.ids import plain

    scenes = model.read_scenes(path, dialect=dialect)
    ids = [plain(scene_id) for scene_id in scenes.scene_ids]
    positions = [position for position, scene_id in enumerate(ids) if str(scene_id) == key]
    if len(positions) > 1:
        raise InputError(f"{path} contains {len(positions)} scenes {key!r}: give them different ids")
    if positions:
        return scenes.take(positions)
    raise InputError(f"{path} does not contain a scene {key!r}; its scenes are {listed(ids)}")
