"""``relforest play``: play and show episodes."""

# Heavy imports wait until the command runs, so that --help answers at once.
# ruff: noqa: PLC0415

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import mean, stdev
from types import MappingProxyType
from typing import TYPE_CHECKING, Annotated, Any, Final, Literal, final

from tyro.conf import Positional, arg

from relforest.cli.early_checks import UsageError, naming_options, option_name
from relforest.cli.progress import note, working

if TYPE_CHECKING:
    from relforest.worlds.blocks.env import BlocksEnv
    from relforest.worlds.blocks.recording import Recording as BlocksRecording
    from relforest.worlds.keepaway.recorder import Decider
    from relforest.worlds.keepaway.recording import Recording as KeepawayRecording

_MOST_LINES: Final = 20
_KEEPAWAY_POLICIES: Final = {"random": "random policy", "hold": "always hold", "hand": "hand-coded policy"}
# In the order of the codes: PLAYING, OUT, TAKEN, CAPPED.
_ENDS: Final = ("unfinished", "the ball went out", "a taker took the ball", "cut off")
# Defaults of the options that belong to each world.
_DEFAULTS: Final[Mapping[str, Mapping[str, Any]]] = MappingProxyType(
    {
        "keepaway": {
            "policy": "hand",
            "keepers": 3,
            "takers": 2,
            "size": (20.0,),
            "perception": "quantised",
            "max_cycles": 10_000,
        },
        "high-towers": {"policy": "large-first", "blocks": 5, "max_actions": 5},
        "color-grouping": {"policy": "manual", "blocks": 5, "max_actions": 5, "distance": "ciede2000"},
        "arch": {"policy": "careful", "blocks": 3, "max_actions": 5},
    }
)


@final
@dataclass(frozen=True, slots=True)
class PlayOptions:
    """Play episodes of a world and, with --out, write a page that shows them.

    The length and the outcome of each episode are printed. The page is a single HTML file that any browser
    opens offline; it plays the episodes and lists every decision.

    For example:
      relforest play keepaway --policy hand --keepers 3 --takers 2 --out game.html
      relforest play keepaway --keepers 4 --takers 3 --size 25 --episodes 10
      relforest play keepaway --policy runs/keepaway --out learned.html
      relforest play high-towers --policy large-first --out towers.html
      relforest play color-grouping --episodes 5 --seed 1 --out colors.html
      relforest play arch --policy careful --out arch.html

    Parameters
    ----------
    world
        What to play: keepaway, or a task of the blocks world: high-towers, color-grouping or arch.
    policy
        Policy that decides. keepaway: hand (the benchmark's hand-coded policy), hold (always hold the ball),
        or the folder of a run of "relforest learn keepaway"; high-towers: large-first or small-first;
        color-grouping: manual; arch: careful or trainer; any world: random.
    keepers
        keepaway: number of players who keep the ball.
    takers
        keepaway: number of players who try to take it.
    size
        keepaway: side of the square field in metres, or its length and width.
    perception
        keepaway: what players see: distances and angles rounded as by the RoboCup 2-D server, exact ones, or
        exact ones without the players' rule that a ball within an opponent's reach stands still.
    max_cycles
        keepaway: cycles (tenths of a second) after which an episode is cut off; 0 = never.
    blocks
        Blocks tasks: number of blocks dropped.
    max_actions
        Blocks tasks: actions after which an episode ends.
    distance
        color-grouping: how colours are compared.
    episodes
        Number of episodes.
    seed
        The same seed gives the same episodes.
    out
        Page to write (.html).
    force
        Replace the page if it exists.
    """

    world: Annotated[
        Positional[Literal["keepaway", "high-towers", "color-grouping", "arch"]], arg(metavar="WORLD")
    ]
    policy: Annotated[
        str | None,
        arg(metavar="NAME", help_behavior_hint="(default: hand, large-first, manual, careful)"),
    ] = None
    keepers: Annotated[int | None, arg(metavar="INT", help_behavior_hint="(default: 3)")] = None
    takers: Annotated[int | None, arg(metavar="INT", help_behavior_hint="(default: 2)")] = None
    size: Annotated[
        tuple[float, ...] | None, arg(metavar="METRES [METRES]", help_behavior_hint="(default: 20)")
    ] = None
    perception: Annotated[
        Literal["quantised", "exact", "fullstate"] | None,
        arg(metavar="{quantised,exact,fullstate}", help_behavior_hint="(default: quantised)"),
    ] = None
    max_cycles: Annotated[int | None, arg(metavar="INT", help_behavior_hint="(default: 10000)")] = None
    blocks: Annotated[int | None, arg(metavar="INT", help_behavior_hint="(default: 5, arch: 3)")] = None
    max_actions: Annotated[int | None, arg(metavar="INT", help_behavior_hint="(default: 5)")] = None
    distance: Annotated[
        Literal["ciede2000", "rgb"] | None,
        arg(metavar="{ciede2000,rgb}", help_behavior_hint="(default: ciede2000)"),
    ] = None
    episodes: int = 1
    seed: int = 0
    out: Annotated[Path | None, arg(metavar="PAGE", help_behavior_hint="(default: no page)")] = None
    force: bool = False


def play(options: PlayOptions) -> int:
    """Play episodes; the exit code is 0."""
    chosen = _chosen(options)
    if options.out is not None and options.out.suffix.lower() not in {".html", ".htm"}:
        raise UsageError(f"--out {options.out} must end in .html: the page is one HTML file")
    if options.world == "keepaway":
        lines, page = _play_keepaway(options, chosen)
    else:
        lines, page = _play_blocks(options, chosen)
    for line in lines:
        print(line)
    if options.out is not None:
        from relforest.support.files import write_text

        write_text(options.out, page())
        note(f"wrote {options.out}")
    return 0


def _chosen(options: PlayOptions) -> dict[str, Any]:
    """Return the options that belong to the world, with their defaults; refuse others."""
    defaults = _DEFAULTS[options.world]
    for name in sorted({name for own in _DEFAULTS.values() for name in own} - defaults.keys()):
        if getattr(options, name) is not None:
            worlds = [world for world, own in _DEFAULTS.items() if name in own]
            flag = option_name(name)
            raise UsageError(f"{flag} belongs to {', '.join(worlds)}, not to {options.world}: omit it")
    given = {name: getattr(options, name) for name in defaults}
    return {name: defaults[name] if value is None else value for name, value in given.items()}


def _play_keepaway(
    options: PlayOptions, chosen: Mapping[str, Any]
) -> tuple[Iterator[str], Callable[[], str]]:
    name = chosen["policy"]
    if name not in _KEEPAWAY_POLICIES and not Path(name).is_dir():
        known = ", ".join(map(repr, _KEEPAWAY_POLICIES))
        raise UsageError(f"--policy must be one of {known}, or a run folder, got {name!r}")

    from relforest.experiments.keepaway_policies import learned_policy
    from relforest.worlds.keepaway.options import KeepawayOptions
    from relforest.worlds.keepaway.page import page
    from relforest.worlds.keepaway.recorder import record_episodes

    with naming_options(chosen):
        rules = KeepawayOptions(
            keepers=chosen["keepers"],
            takers=chosen["takers"],
            size=_size(chosen["size"]),
            perception=chosen["perception"],
            max_cycles=chosen["max_cycles"],
        )
    policy: str | Decider = name
    if name in _KEEPAWAY_POLICIES:
        described = _KEEPAWAY_POLICIES[name]
    else:
        policy, described = learned_policy(Path(name), rules.keepers, rules.takers), f"learned in {name}"
    with working("playing"):
        recordings = record_episodes(policy, rules, options.episodes, options.seed)
    length, width = recordings[0].field
    title = f"Keepaway: {chosen['keepers']} keepers, {chosen['takers']} takers"
    subtitle = (
        f"{described}, {length:g} m by {width:g} m, {chosen['perception']} perception, seed {options.seed}"
    )
    return _keepaway_lines(recordings), lambda: page(recordings, title=title, subtitle=subtitle)


def _size(sides: tuple[float, ...]) -> float | tuple[float, float]:
    match sides:
        case (side,):
            return side
        case (length, width):
            return length, width
        case _:
            raise UsageError(f"--size must be one number, or a length and a width, got {len(sides)} numbers")


def _keepaway_lines(recordings: Sequence[KeepawayRecording]) -> Iterator[str]:
    """Yield a line about each of the first episodes, and one about all of them."""
    from relforest.worlds.keepaway.layout import TAKEN
    from relforest.worlds.keepaway.recording import SECOND

    seconds = [recording.duration / SECOND for recording in recordings]
    yield from _listed(
        f"{recording.duration / SECOND:.1f} s, {_ENDS[recording.end]}"
        for recording in recordings[:_MOST_LINES]
    )
    yield from _rest(recordings)
    if len(recordings) > 1:
        taken = sum(recording.end == TAKEN for recording in recordings) / len(recordings)
        spread = f"standard deviation {stdev(seconds):.1f} s, from {min(seconds):.1f} to {max(seconds):.1f} s"
        yield f"mean of {len(seconds)}: {mean(seconds):.1f} s ({spread}), {taken:.0%} taken"


def _play_blocks(options: PlayOptions, chosen: Mapping[str, Any]) -> tuple[Iterator[str], Callable[[], str]]:
    from relforest.worlds.blocks.page import page
    from relforest.worlds.blocks.policies import make_policy
    from relforest.worlds.blocks.recorder import record_episodes

    with naming_options(chosen, n_blocks="blocks"):
        env = _blocks_env(options.world, chosen)
        policy = make_policy(chosen["policy"], env)
    with working("playing"):
        recordings = record_episodes(env, policy, options.episodes, options.seed)
    compared = f", {chosen['distance']}" if "distance" in chosen else ""
    title = options.world.replace("-", " ").capitalize()
    subtitle = f"{chosen['policy']} policy, {chosen['blocks']} blocks{compared}, seed {options.seed}"
    return _blocks_lines(recordings), lambda: page(recordings, title=title, subtitle=subtitle)


def _blocks_env(world: str, chosen: Mapping[str, Any]) -> BlocksEnv:
    from relforest.worlds.blocks.env import arch_env, color_grouping_env, high_towers_env

    sizes = {"n_blocks": chosen["blocks"], "max_actions": chosen["max_actions"]}
    if world == "high-towers":
        return high_towers_env(**sizes)
    if world == "color-grouping":
        return color_grouping_env(distance=chosen["distance"], **sizes)
    # Hand-made policies need the moves of their plan among the candidates.
    return arch_env(sampler="test" if chosen["policy"] == "random" else "expert", **sizes)


def _blocks_lines(recordings: Sequence[BlocksRecording]) -> Iterator[str]:
    """Yield a line about each of the first episodes, and one about all of them."""
    from relforest.worlds.blocks.page import SCORE_NAMES

    name = SCORE_NAMES[recordings[0].task]
    yield from _listed(
        f"{recording.duration:.1f} s, {_counted(len(recording.options))}, "
        f"{name} from {_brief(recording.first_score)} to {_brief(recording.last_score)}, "
        f"reward {_brief(recording.total_reward)}"
        for recording in recordings[:_MOST_LINES]
    )
    yield from _rest(recordings)
    if len(recordings) > 1:
        rewards = [recording.total_reward for recording in recordings]
        spread = (
            f"standard deviation {stdev(rewards):.2f}, from {_brief(min(rewards))} to {_brief(max(rewards))}"
        )
        last = _brief(mean(recording.last_score for recording in recordings))
        yield f"mean of {len(rewards)}: reward {_brief(mean(rewards))} ({spread}), final {name} {last}"


def _counted(options: int) -> str:
    return f"{options} option{'' if options == 1 else 's'}"


def _brief(value: float) -> str:
    # Adding 0 makes a negative zero positive.
    return f"{round(value, 2) + 0.0:.2f}"


def _listed(lines: Iterator[str]) -> Iterator[str]:
    for number, line in enumerate(lines, start=1):
        yield f"episode {number}: {line}"


def _rest(recordings: Sequence[object]) -> Iterator[str]:
    if len(recordings) > _MOST_LINES:
        yield f"... and {len(recordings) - _MOST_LINES} more"
