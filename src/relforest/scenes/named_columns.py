"""Which columns of a Parquet file scenes are read from: those that are named, or the file's own."""

from __future__ import annotations

from collections.abc import Sequence
from os import PathLike

from relforest.scenes.frames import AttributeColumns, FrameLayout, frame_layout
from relforest.support.errors import InputError

__all__ = ["named_columns"]


def named_columns(
    origin: str | PathLike[str],
    scene: str | None = None,
    object: str | None = None,  # noqa: A002 - the keyword of `Scenes.from_parquet`
    attributes: AttributeColumns | None = None,
    arguments: Sequence[str] = (),
    *,
    own: bool,
) -> FrameLayout | None:
    """Return the columns named by the keywords of `Scenes.from_parquet`, or None for a file's own.

    Raises
    ------
    InputError
        If keywords are missing that a file needs which is not `own`, written by `Scenes.to_parquet`.
    """
    if own and scene is None and object is None and attributes is None and not arguments:
        return None
    if scene is None or attributes is None:
        raise InputError(
            f"{origin} was not written by Scenes.to_parquet, or keywords were given: name its columns "
            "with scene= and attributes= (and object=, arguments=) as for from_frame"
        )
    return frame_layout(scene, object, attributes, arguments)
