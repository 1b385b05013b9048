"""``relforest play``: episodes to look at."""

# Heavy imports wait until the command runs, so that --help answers at once.
# ruff: noqa: PLC0415

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import mean, stdev
from typing import TYPE_CHECKING, Annotated, Final, Literal, final

from tyro.conf import Positional, arg

from relforest.cli.outputs import check_free
from relforest.cli.progress import note, working
from relforest.support.errors import InputError

if TYPE_CHECKING:
    from relforest.worlds.keepaway.recording import Recording

_MOST_LINES: Final = 20
_POLICIES: Final = {"random": "random policy", "hold": "always hold", "hand": "hand-coded policy"}
# In the order of the codes: PLAYING, OUT, TAKEN, CAPPED.
_ENDS: Final = ("unfinished", "the ball went out", "a taker took the ball", "cut off")


@final
@dataclass(frozen=True, slots=True)
class PlayOptions:
    """Play episodes of a world and, with --out, write a page that shows them.

    For each episode it tells how long it took and how it ended. The page is one HTML file that any browser
    opens, without a network: it plays the episodes and lists every decision, with the scores of the
    hand-coded policy.

    For example:
      relforest play keepaway
      relforest play keepaway --policy hand --keepers 3 --takers 2 --out game.html
      relforest play keepaway --policy random --keepers 4 --takers 3 --size 25 --episodes 10 --out games.html

    Parameters
    ----------
    world
        What to play: keepaway.
    policy
        Who decides for the keepers: at random, always hold the ball, or the hand-coded policy.
    keepers
        Players who keep the ball.
    takers
        Players who try to take it.
    size
        Side of the square field in metres, or its length and its width.
    perception
        What players know: distances and angles rounded as the RoboCup 2-D server rounds them, exact ones, or
        exact ones without the players' rule that a ball in an opponent's reach stands still.
    max_cycles
        Cycles of a tenth of a second after which an episode is cut off; 0 = never.
    episodes
        How many.
    seed
        The same seed gives the same episodes.
    out
        Page to write: .html.
    force
        Replace the page if it exists.
    """

    world: Annotated[Positional[Literal["keepaway"]], arg(metavar="WORLD")]
    policy: Literal["random", "hold", "hand"] = "hand"
    keepers: int = 3
    takers: int = 2
    size: Annotated[tuple[float, ...], arg(metavar="METRES [METRES]")] = (20.0,)
    perception: Literal["quantised", "exact", "fullstate"] = "quantised"
    max_cycles: int = 10_000
    episodes: int = 1
    seed: int = 0
    out: Annotated[Path | None, arg(metavar="PAGE", help_behavior_hint="(default: no page)")] = None
    force: bool = False


def play(options: PlayOptions) -> int:
    """Play as the options say; the exit code is 0."""
    from relforest.worlds.keepaway.options import KeepawayOptions
    from relforest.worlds.keepaway.recorder import record_episodes

    if options.out is not None:
        _check_page(options.out, force=options.force)
    rules = KeepawayOptions(
        keepers=options.keepers,
        takers=options.takers,
        size=_size(options.size),
        perception=options.perception,
        max_cycles=options.max_cycles,
    )
    with working("playing"):
        recordings = record_episodes(options.policy, rules, options.episodes, options.seed)
    for line in _told(recordings):
        print(line)
    if options.out is not None:
        _write_page(options.out, options, recordings)
    return 0


def _size(sides: tuple[float, ...]) -> float | tuple[float, float]:
    match sides:
        case (side,):
            return side
        case (length, width):
            return length, width
        case _:
            raise InputError(f"--size takes one number, or a length and a width, got {len(sides)} numbers")


def _check_page(out: Path, *, force: bool) -> None:
    if out.suffix.lower() not in {".html", ".htm"}:
        raise InputError(f"{out} must end in .html: --out writes a page")
    check_free(out, force=force)


def _told(recordings: Sequence[Recording]) -> Iterator[str]:
    """Yield a line about each of the first episodes, and one about all of them."""
    from relforest.worlds.keepaway.layout import TAKEN
    from relforest.worlds.keepaway.recording import SECOND

    seconds = [recording.duration / SECOND for recording in recordings]
    for number, recording in enumerate(recordings[:_MOST_LINES], start=1):
        yield f"episode {number}: {recording.duration / SECOND:.1f} s, {_ENDS[recording.end]}"
    if len(recordings) > _MOST_LINES:
        yield f"... and {len(recordings) - _MOST_LINES} more"
    if len(recordings) > 1:
        taken = sum(recording.end == TAKEN for recording in recordings) / len(recordings)
        spread = f"standard deviation {stdev(seconds):.1f} s, from {min(seconds):.1f} to {max(seconds):.1f} s"
        yield f"mean of {len(seconds)}: {mean(seconds):.1f} s ({spread}), {taken:.0%} taken"


def _write_page(out: Path, options: PlayOptions, recordings: Sequence[Recording]) -> None:
    from relforest.support.files import write_text
    from relforest.worlds.keepaway.page import page

    length, width = recordings[0].field
    title = f"Keepaway: {options.keepers} keepers, {options.takers} takers"
    subtitle = f"{_POLICIES[options.policy]}, {length:g} m by {width:g} m, {options.perception} perception"
    write_text(out, page(recordings, title=title, subtitle=f"{subtitle}, seed {options.seed}"))
    note(f"wrote {out}")
