"""What there is to see of a game: the field, the players with their body directions, the ball, a decision.

Keepers are yellow with numbers from 1, takers are blue. A ring around the keeper that decides shows how far
it can kick; an arrow shows a pass it has chosen. As on the monitor of the RoboCup 2-D server, the y of a
game points down. Distances are to scale, players and ball are drawn larger than they are.
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import Final

import numpy as np
from numpy.typing import NDArray

from relforest.playing.frames import Frame, Stage, Thing
from relforest.playing.shapes import Chip, Circle, Line, Polygon, Shape, Text, Words, box
from relforest.worlds.keepaway.decisions.scene import NOBODY
from relforest.worlds.keepaway.play.batch import Batch
from relforest.worlds.keepaway.server.layout import (
    BODY,
    CAPPED,
    DASH,
    END,
    KICK,
    NONE,
    OUT,
    PLAYING,
    SECOND,
    TAKEN,
    TIME,
    TURN,
    Setup,
)
from relforest.worlds.keepaway.server.referee import REACH

COLORS: Final = {
    "grass": ("#d9e5d4", "#2b3a2e"),
    "stripe": ("#d3e0ce", "#28362b"),
    "chalk": ("#ffffff", "#8d9a8f"),
    "rim": ("#262626", "#0e0f10"),
    "ball": ("#ffffff", "#ffffff"),
    "keeper": ("#f0b414", "#f0b414"),
    "taker": ("#56b4e9", "#56b4e9"),
}

_ENDS: Final = {
    PLAYING: "",
    OUT: "the ball went out",
    TAKEN: "a taker took the ball",
    CAPPED: "cut off",
}
_SHORTEST: Final = 0.25
_LEGEND: Final = (
    "Keepers are yellow with numbers, takers are blue; the short line shows which way a player faces. The "
    "ring is as far as the keeper that decides can kick, and an arrow is a pass. A tick is a tenth of a "
    "second. Players and ball are drawn larger than they are. The band over the slider tells who can kick: "
    "yellow a keeper, blue a taker."
)


@lru_cache(maxsize=16)
def game_stage(setup: Setup) -> Stage:
    """Return the stage of games with these rules."""
    margin = 0.06 * max(setup.length, setup.width)
    # A narrow field leaves room for what is written above it.
    least = _SHORTEST * max(setup.length, setup.width)
    x, y = setup.length / 2, setup.width / 2
    wide, high = max(x, least) + margin, max(y, least) + margin
    edges = np.linspace(-x, x, 11).tolist()
    stripes = [Polygon(box(*ends, -y, y), "stripe") for ends in zip(edges[1::2], edges[2::2], strict=True)]
    chalk = Polygon(box(-x, x, -y, y), edge="chalk", width=margin / 6)
    grass = Polygon(box(-x, x, -y, y), "grass")
    return Stage(
        (-wide, wide, -high, high),
        (grass, *stripes, chalk),
        COLORS,
        pixels=624,
        rate=SECOND,
        legend=_LEGEND,
    )


def game_frame(batch: Batch, g: int, choice: tuple[int, int] | None = None) -> Frame:
    """Return game ``g`` of a batch as it is.

    ``choice`` is the keeper that decided a moment ago, and the receiver of its pass or `NOBODY`.
    """
    setup, games = batch.setup, batch.games
    players, ball, counters = games.players[g], games.ball[g], games.counters[g]
    stage, keepers, end = game_stage(setup), setup.keepers, int(counters[END])
    size = 0.02 * max(setup.length, setup.width)
    x_most, y_most = stage.view[1] - size, stage.view[3] - size
    # What is far outside is drawn at the edge of the picture.
    places = np.clip(np.vstack([players[:, :2], ball[:2]]), (-x_most, -y_most), (x_most, y_most))
    at = (places * (1.0, -1.0)).tolist()
    asked = int(batch.seen.actors[g]) if end == PLAYING else NOBODY
    actor, receiver = (asked, NOBODY) if choice is None or asked >= 0 else choice
    things = [
        Thing(
            f"player {i}",
            _player(i + 1 if i < keepers else 0, size, chosen=i == actor),
            at[i][0],
            at[i][1],
            -math.radians(players[i, BODY]),
            "keeper" if i < keepers else "taker",
        )
        for i in reversed(range(len(players)))
    ]
    return Frame(
        time=int(counters[TIME]) / SECOND,
        things=(*things, Thing("ball", _ball(size), at[-1][0], at[-1][1], trail="ball")),
        notes=_pass(at[actor], at[receiver], size) if receiver != NOBODY else (),
        caption=_ENDS[end],
        band=_holder(players, ball, keepers),
        details=tuple(_command(i, keepers, games.commands[g, i].tolist()) for i in range(len(players))),
    )


def player_chip(player: int, keepers: int) -> Chip:
    """Return the name of a player: its number within its team, on the color of the team."""
    return Chip(str(player + 1), "keeper") if player < keepers else Chip(str(player - keepers + 1), "taker")


@lru_cache(maxsize=256)
def _player(number: int, size: float, *, chosen: bool) -> tuple[Shape, ...]:
    nose = Line(((0.0, 0.0), (1.45 * size, 0.0)), "ink", 0.36 * size)
    disc = Circle((0.0, 0.0), 0.93 * size, "keeper" if number else "taker", "rim", 0.14 * size)
    ring = (Circle((0.0, 0.0), max(REACH, 1.5 * size), edge="choice", width=0.18 * size),) if chosen else ()
    name = (Text(str(number), (0.0, 0.0), 1.1 * size, "#262626", bold=True),) if number else ()
    return (*ring, nose, disc, *name)


@lru_cache(maxsize=16)
def _ball(size: float) -> tuple[Shape, ...]:
    return (Circle((0.0, 0.0), 0.5 * size, "ball", "rim", 0.14 * size),)


def _pass(begin: list[float], end: list[float], size: float) -> tuple[Shape, ...]:
    """Return an arrow that begins and ends beside the players."""
    far = math.dist(begin, end)
    if far < 4 * size:
        return ()
    along = [(last - first) / far for first, last in zip(begin, end, strict=True)]
    tail = (begin[0] + size * along[0], begin[1] + size * along[1])
    tip = (end[0] - 1.5 * size * along[0], end[1] - 1.5 * size * along[1])
    return (Line((tail, tip), "choice", 0.22 * size, arrow=True),)


def _holder(players: NDArray[np.float64], ball: NDArray[np.float64], keepers: int) -> str:
    near = np.hypot(*(players[:, :2] - ball[:2]).T) < REACH
    return "taker" if near[keepers:].any() else "keeper" if near[:keepers].any() else ""


def _command(player: int, keepers: int, command: list[int]) -> Words:
    verb, amount, direction = command
    words = {
        NONE: " does nothing",
        DASH: f" dashes with power {amount}",
        TURN: f" turns by {amount}\N{DEGREE SIGN}",
        KICK: f" kicks with power {amount}, direction {direction}\N{DEGREE SIGN}",
    }[verb]
    return (player_chip(player, keepers), words.replace("-", "\N{MINUS SIGN}"))
