"""``relforest play``: play and show episodes."""

# Heavy imports wait until the command runs, so that --help answers at once.
# ruff: noqa: PLC0415

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from statistics import mean, stdev
from types import MappingProxyType
from typing import TYPE_CHECKING, Annotated, Any, Final, Literal, final

from tyro.conf import Positional, arg

from relforest.cli.early_checks import UsageError, naming_options, option_name
from relforest.cli.progress import note, working
from relforest.support.errors import InputError

if TYPE_CHECKING:
    from relforest.experiments.learned_policies import LearnedPolicy
    from relforest.playing import Recording

_MOST_LINES: Final = 20
_TRAINED: Final = "trained"


@final
@dataclass(frozen=True, slots=True)
class _World:
    """What the command line says of a world."""

    policies: Mapping[str, str]
    """Name -> how pages call it; the first one is the default."""
    title: str
    subtitle: str = ""
    """Filled with the options."""
    options: Mapping[str, Any] = field(default_factory=dict)
    """The options that belong to it -> their defaults."""
    parameters: Mapping[str, str] = field(default_factory=dict)
    """Options -> parameters of the environment with other names."""

    @property
    def default(self) -> str:
        """The policy that plays if none is chosen."""
        return next(iter(self.policies))

    @property
    def choices(self) -> Mapping[str, str]:
        """Its policies and the one that comes trained, by name, and how pages call them."""
        return {**self.policies, _TRAINED: "trained policy"}


def _blocks(policies: Sequence[str], title: str, subtitle: str = "", **options: object) -> _World:
    return _World(
        {name: f"{name} policy" for name in policies},
        title,
        "{blocks} blocks" + subtitle,
        {"blocks": 5, "max_actions": 5} | options,
        {"blocks": "n_blocks"},
    )


WORLDS: Final[Mapping[str, _World]] = MappingProxyType(
    {
        "corridor": _World(
            {"optimal": "optimal policy", "random": "random policy"}, "Corridor", "reward at both ends"
        ),
        "keepaway": _World(
            {"hand": "hand-coded policy", "hold": "always hold", "random": "random policy"},
            "Keepaway: {keepers} keepers, {takers} takers",
            "{size} m, {perception} perception",
            {
                "keepers": 3,
                "takers": 2,
                "size": (20.0,),
                "perception": "quantised",
                "max_cycles": 10_000,
            },
        ),
        "high-towers": _blocks(("large-first", "small-first", "random"), "High towers"),
        "color-grouping": _blocks(
            ("manual", "random"), "Color grouping", ", {distance}", distance="ciede2000"
        ),
        "arch": _blocks(("careful", "trainer", "random"), "Arch", blocks=3),
    }
)
"""Name of a world -> what the command line says of it."""


@final
@dataclass(frozen=True, slots=True)
class PlayOptions:
    """Play episodes of a world and, with --out, write a page that shows them.

    The length, the decisions and the outcome of each episode are printed. The page is a single HTML file that
    any browser opens offline; it plays the episodes and lists every decision. Of a policy that a relational
    learner has learned, it also shows what speaks for each decision and against it.

    For example:
      relforest play keepaway --policy hand --keepers 3 --takers 2 --out game.html
      relforest play keepaway --keepers 4 --takers 3 --size 25 --episodes 10
      relforest play keepaway --policy trained --out learned.html
      relforest play keepaway --policy trained --explain
      relforest play keepaway --policy runs/keepaway --questions 30 --episodes 100
      relforest play corridor --policy runs/corridor --out corridor.html
      relforest play high-towers --policy large-first --out towers.html
      relforest play color-grouping --episodes 5 --seed 1 --out colors.html
      relforest play arch --policy careful --out arch.html

    Parameters
    ----------
    world
        What to play: corridor, keepaway, or a task of the blocks world: high-towers, color-grouping or arch.
    policy
        Policy that decides. Any world: random, trained (learned by smrf-q for you), or the folder of a run of
        "relforest learn"; corridor: optimal; keepaway: hand (the benchmark's hand-coded policy) or hold
        (always hold the ball); high-towers: large-first or small-first; color-grouping: manual; arch: careful
        or trainer.
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
        color-grouping: how colors are compared.
    explain
        Print a line about each decision: what speaks most for it, and against it, compared with the next best
        action. For run folders of smrf-q and smrf-rpi.
    questions
        Ask only so many of the questions of a run of smrf-q, those that matter most for choosing.
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
        Positional[Literal["corridor", "keepaway", "high-towers", "color-grouping", "arch"]],
        arg(metavar="WORLD"),
    ]
    policy: Annotated[
        str | None,
        arg(metavar="NAME", help_behavior_hint="(default: a good one)"),
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
    explain: bool = False
    questions: Annotated[int | None, arg(metavar="INT", help_behavior_hint="(default: all)")] = None
    episodes: int = 1
    seed: int = 0
    out: Annotated[Path | None, arg(metavar="PAGE", help_behavior_hint="(default: no page)")] = None
    force: bool = False


def play(options: PlayOptions) -> int:
    """Play episodes; the exit code is 0."""
    world, chosen = WORLDS[options.world], _chosen(options)
    if options.out is not None and options.out.suffix.lower() not in {".html", ".htm"}:
        raise UsageError(f"--out {options.out} must end in .html: the page is one HTML file")
    name = world.default if options.policy is None else options.policy
    if name not in world.choices and not Path(name).is_dir():
        known = ", ".join(map(repr, world.choices))
        raise UsageError(f"--policy must be one of {known}, or a run folder, got {name!r}")

    if name in world.policies and (options.explain or options.questions is not None):
        flag = "--explain" if options.explain else "--questions"
        raise UsageError(
            f"{flag} is for what was learned: --policy must be {_TRAINED!r}, or the folder of a run"
        )
    recordings = _record(options, chosen, name)
    if options.explain:
        for line in _explained(recordings):
            print(line)
    for line in _described(recordings):
        print(line)
    if options.out is not None:
        from relforest.playing import page
        from relforest.support.files import write_text

        sides = (2 * chosen.get("size", ()))[:2]
        shown = {**chosen, "size": " m by ".join(f"{side:g}" for side in sides)}
        described = world.choices.get(name, f"learned in {name}")
        subtitle = f"{described}, {world.subtitle.format(**shown)}, seed {options.seed}"
        write_text(options.out, page(recordings, title=world.title.format(**shown), subtitle=subtitle))
        note(f"wrote {options.out}")
    return 0


def _chosen(options: PlayOptions) -> dict[str, Any]:
    """Return the options that belong to the world, with their defaults; refuse others."""
    defaults = WORLDS[options.world].options
    for name in sorted({name for world in WORLDS.values() for name in world.options} - defaults.keys()):
        if getattr(options, name) is not None:
            worlds = [world for world, own in WORLDS.items() if name in own.options]
            flag = option_name(name)
            raise UsageError(f"{flag} belongs to {', '.join(worlds)}, not to {options.world}: omit it")
    given = {name: getattr(options, name) for name in defaults}
    chosen = {name: defaults[name] if value is None else value for name, value in given.items()}
    if not 1 <= len(chosen.get("size", (0,))) <= 2:
        raise UsageError(
            f"--size must be one number, or a length and a width, got {len(chosen['size'])} numbers"
        )
    return chosen


def _record(options: PlayOptions, chosen: Mapping[str, Any], policy: str) -> tuple[Recording, ...]:
    import gymnasium

    from relforest.experiments.learned_policies import learned_policy, trained_run
    from relforest.playing import record_episodes
    from relforest.worlds import environment_id
    from relforest.worlds.environment import WorldEnv

    world = WORLDS[options.world]
    parameters = {world.parameters.get(name, name): value for name, value in chosen.items()}
    if "size" in parameters:
        parameters["size"] = (2 * parameters["size"])[:2]
    if options.world == "arch" and policy == "trainer":
        # It tries what an arch may follow.
        parameters["sampler"] = "training"
    with naming_options(chosen, **{theirs: ours for ours, theirs in world.parameters.items()}):
        env = gymnasium.make(environment_id(options.world), disable_env_checker=True, **parameters)
    made = env.unwrapped
    if policy in world.policies and isinstance(made, WorldEnv):
        decides = made.policies[policy]
    else:
        folder = trained_run(options.world) if policy == _TRAINED else Path(policy)
        decides = _learned(options, learned_policy(folder, env))
    with working("playing"):
        asks = options.explain or options.out is not None
        return record_episodes(env, decides, options.episodes, options.seed, explain=asks)


def _learned(options: PlayOptions, policy: LearnedPolicy) -> LearnedPolicy:
    """Return a learned policy with as many questions as wanted."""
    from relforest.experiments.learned_policies import AgentPolicy

    if not isinstance(policy, AgentPolicy):
        if options.explain or options.questions is not None:
            raise InputError(f"what {options.policy} learned has no parts that could be told or left out")
        return policy
    with naming_options(["questions"]):
        return policy if options.questions is None else policy.with_questions(options.questions)


def _explained(recordings: Sequence[Recording]) -> Iterator[str]:
    """Yield a line about each decision."""
    from relforest.playing.shapes import plain

    for number, recording in enumerate(recordings, start=1):
        if len(recordings) > 1:
            yield f"episode {number}"
        for choice in recording.choices:
            why = "there was no other action" if choice.why is None else str(choice.why)
            yield f"{choice.begin:6.1f} s  {plain(choice.words)}: {why}"


def _described(recordings: Sequence[Recording]) -> Iterator[str]:
    """Yield a line about each of the first episodes, and one about all of them."""
    for number, recording in enumerate(recordings[:_MOST_LINES], start=1):
        count = len(recording.choices)
        parts = [f"{recording.duration:.1f} s", f"{count} decision{'' if count == 1 else 's'}"]
        if scores := recording.scores:
            parts.append(f"{recording.stage.score_name} from {_brief(scores[0])} to {_brief(scores[-1])}")
        parts.append(f"reward {_brief(recording.reward)}")
        yield f"episode {number}: {', '.join([*parts, *filter(None, [recording.end])])}"
    if len(recordings) > _MOST_LINES:
        yield f"... and {len(recordings) - _MOST_LINES} more"
    if len(recordings) > 1:
        parts = [_spread([recording.duration for recording in recordings], " s")]
        parts.append(f"reward {_spread([recording.reward for recording in recordings])}")
        if recordings[0].scores:
            last = mean(recording.scores[-1] for recording in recordings)
            parts.append(f"final {recordings[0].stage.score_name} {_brief(last)}")
        ends = Counter(recording.end for recording in recordings if recording.end)
        parts += [f"{count / len(recordings):.0%} {end}" for end, count in ends.most_common()]
        yield f"mean of {len(recordings)}: {', '.join(parts)}"


def _spread(values: Sequence[float], unit: str = "") -> str:
    deviation, low, high = (_brief(value) for value in (stdev(values), min(values), max(values)))
    return f"{_brief(mean(values))}{unit} (standard deviation {deviation}, from {low} to {high})"


def _brief(value: float) -> str:
    # Adding 0 makes a negative zero positive.
    return f"{round(value, 2) + 0.0:.2f}"
