"""Positions of players, as kloppy reads them, as scenes."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, Final

import pyarrow as pa

from relforest.scenes import Attribute, Scenes
from relforest.support.errors import InputError

BALL: Final = "ball"


def scenes_from_tracking(frames: Iterable[Any]) -> Scenes:
    """Return a scene for each frame: players and ball with ``location`` and the category ``team``.

    Parameters
    ----------
    frames : iterable
        Frames of kloppy: a ``TrackingDataset``, some of its frames, or the freeze frames of events. Their
        coordinates are kept; bring data sets to the same pitch first
        (``dataset.transform(to_coordinate_system=...)``).

    Returns
    -------
    Scenes
        Scenes have the id of their frame, players the id of the player, teams are ``home``, ``away`` and
        ``ball``. Who is not seen in a frame is not in its scene.

    Raises
    ------
    InputError
        If there is no frame, something else than a frame, two frames with the same id, or one in which nobody
        is seen.
    """
    columns: dict[str, list[Any]] = {name: [] for name in ("frame", "object", "x", "y", "team")}
    known: set[Any] = set()
    for frame in frames:
        if not hasattr(frame, "players_data"):
            raise InputError(
                f"pass frames of kloppy, such as a TrackingDataset or event.freeze_frame, got {frame!r:.60}"
            )
        if frame.frame_id in known:
            raise InputError(f"two frames have the id {frame.frame_id}: pass each frame once")
        known.add(frame.frame_id)
        seen = [
            (player.player_id, data.coordinates, player.team.ground.value)
            for player, data in frame.players_data.items()
            if data.coordinates is not None
        ]
        if frame.ball_coordinates is not None:
            seen.append((BALL, frame.ball_coordinates, BALL))
        if not seen:
            raise InputError(f"nobody is seen in frame {frame.frame_id}: leave it out")
        for name, place, team in seen:
            for column, value in zip(
                columns.values(), (frame.frame_id, str(name), place.x, place.y, str(team)), strict=True
            ):
                column.append(value)
    if not known:
        raise InputError("pass at least one frame")
    return Scenes.from_frame(
        pa.table(columns),
        scene="frame",
        object="object",
        attributes={"location": ["x", "y"], Attribute("team", kind="category"): "team"},
    )
