"""Decision volumes of any shape."""

from __future__ import annotations

import reprlib

from relforest.support.errors import ModelFormatError
from relforest.volumes.arc import Arc
from relforest.volumes.ellipsoid import Ellipsoid
from relforest.volumes.slab import Slab

Volume = Ellipsoid | Arc | Slab


def volume_from_dict(document: object) -> Volume:
    """Read a volume from its JSON form.

    Raises
    ------
    ModelFormatError
        If the document is not a valid volume.
    """
    if not isinstance(document, dict):
        raise ModelFormatError(f"malformed volume: expected an object, got {type(document).__name__}")
    shapes: dict[str, type[Volume]] = {"ellipsoid": Ellipsoid, "arc": Arc, "slab": Slab}
    shape = document.get("shape")
    if not isinstance(shape, str) or shape not in shapes:
        raise ModelFormatError(
            f"unknown volume shape {reprlib.repr(shape)}: expected one of {', '.join(shapes)}"
        )
    return shapes[shape].from_dict(document)
