"""Table -> our games beside real ones, learning curves, speeds, claims, and pictures of all three."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from relforest.experiments.claims import Claim, Findings
from relforest.experiments.keepaway import settings
from relforest.experiments.keepaway.run import compute
from relforest.experiments.keepaway.settings import DURATIONS, LEARNING, PHYSICS, SERVER, SPEED
from relforest.experiments.registry import heading
from relforest.experiments.samples import Samples
from relforest.experiments.sheets import Entry, Estimate, Format, Sheet, Span
from relforest.experiments.study import Study
from relforest.experiments.table import Table
from relforest.reports.style import BLUE, GREY, INK, ORANGE, PALE, styled

_BENCHMARK: Final = "3v2"
_LEARNERS: Final[Mapping[str, tuple[str, str]]] = {
    settings.SEPARATE: ("every keeper learns alone", BLUE),
    settings.SHARED: ("all learn from everyone", ORANGE),
}
_MEASURES: Final = ("mean", "sd", "q5", "q25", "q50", "q75", "q95", "taken")
_NO_PHYSICS: Final = (
    "One-step physics: not compared with recorded games (set RELFOREST_DATA to a folder that holds "
    "keepaway-trajectories.npz)"
)


def summarize(table: Table) -> Findings:
    """State everything measured beside what real games gave, and whether it lies where it must."""
    samples = _samples(table)
    sheets = (_durations(samples), _events(samples), _learning(samples), _speed(samples))
    physics = _physics(samples)
    recorded = "Recorded steps of the real server outside the bounds of the formulas"
    columns = dict.fromkeys(("motion", "steps", "outside"), "")
    return Findings(
        "" if physics else _NO_PHYSICS,
        tuple(_claims(samples)),
        (Sheet(recorded, columns, physics), *sheets) if physics else sheets,
    )


def figures(table: Table) -> Mapping[str, Figure]:
    """Draw the durations beside those of real games, the learning curves, and the speeds."""
    samples = _samples(table)
    with styled():
        return {
            "durations.png": _durations_figure(samples),
            "learning.png": _learning_figure(samples),
            "speed.png": _speed_figure(samples),
        }


def curves(samples: Samples, method: str) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Return the ends of the blocks of episodes, (blocks,), and the runs' mean durations, (runs, blocks)."""
    found = samples.below(LEARNING, _BENCHMARK, method)
    return np.array(list(map(int, found))), np.column_stack(list(found.values()))


def _samples(table: Table) -> Samples:
    return Samples.of(table, "part", "game", "condition", "measure")


def _measured(samples: Samples, game: str, policy: str, name: str) -> float:
    return samples.mean((DURATIONS, game, policy, name)).value


def _physics(samples: Samples) -> tuple[tuple[str, int, int], ...]:
    """Return motion, number and violations of the recorded steps; nothing if there is no recording."""
    found = {name: int(value[0]) for name, value in samples.below(PHYSICS, _BENCHMARK, "").items()}
    motions = dict.fromkeys(name.partition(":")[0] for name in found)
    return tuple((motion, found[f"{motion}: steps"], found[f"{motion}: violations"]) for motion in motions)


def _played(samples: Samples) -> Iterator[tuple[str, str, dict[str, float]]]:
    """Yield the games, the policies, and how long episodes were."""
    for game, policy in dict.fromkeys(key[1:3] for key in samples.values if key[0] == DURATIONS):
        yield game, policy, {name: _measured(samples, game, policy, name) for name in _MEASURES}


def _speeds(samples: Samples) -> dict[str, dict[str, float]]:
    """Return for each policy the speed of each game."""
    found: dict[str, dict[str, float]] = {}
    for part, game, policy, _ in samples.values:
        if part == SPEED:
            rate = samples.mean((SPEED, game, policy, "cycles_per_second")).value
            found.setdefault(policy, {})[game] = rate
    return found


def _durations(samples: Samples) -> Sheet:
    rows: list[tuple[Entry, ...]] = []
    for game, policy, found in _played(samples):
        episodes = int(_measured(samples, game, policy, "episodes"))
        mean = Estimate.normal(found.pop("mean"), found["sd"], episodes)
        rows.append((f"{game} {policy}", mean, *found.values()))
        if game == _BENCHMARK:
            rows.append(("  real server", *(SERVER[policy].get(name) for name in _MEASURES)))
    quantiles = dict.fromkeys(("5 %", "25 %", "50 %", "75 %", "95 %"), ".0f")
    caption = "Durations of episodes in cycles of 0.1 s (95 % interval of the mean)"
    return Sheet(caption, {"": "", "mean": ".1f", "sd": ".1f", **quantiles, "taken": ".2f"}, tuple(rows))


def _events(samples: Samples) -> Sheet:
    rows = tuple(
        (title, _measured(samples, _BENCHMARK, "random", name), server)
        for name, (title, server) in settings.SERVER_EVENTS.items()
    )
    columns = dict.fromkeys(("ours", "real server"), lambda value: ".3f" if value < 1 else ".2f")
    return Sheet(f"What happens in {_BENCHMARK} games of random keepers", {"": "", **columns}, rows)


def _learning(samples: Samples) -> Sheet:
    found = [(title, *curves(samples, method)) for method, (title, _) in _LEARNERS.items()]
    columns: dict[str, Format] = {"until episode": ""}
    for title, _, _ in found:
        columns |= {title: ".1f", f"{title}: runs": ".1f"}
    rows = []
    for place, end in enumerate(found[0][1].tolist()):
        row: list[Entry] = [end]
        for _, _, values in found:
            column = values[:, place]
            row += [float(column.mean()), Span(float(column.min()), float(column.max()))]
        rows.append(tuple(row))
    runs = len(found[0][2])
    caption = f"Mean duration while CMAC Sarsa learns {_BENCHMARK}, {runs} runs (lowest to highest)"
    return Sheet(caption, columns, tuple(rows))


def _speed(samples: Samples) -> Sheet:
    speeds = _speeds(samples)
    games = list(next(iter(speeds.values())))
    rows = tuple((policy, *(own.get(game) for game in games)) for policy, own in speeds.items())
    caption = "Game cycles per second of CPU time, one core"
    return Sheet(caption, {"": "", **dict.fromkeys(games, ",.0f")}, rows)


def _claims(samples: Samples) -> Iterator[Claim]:
    for motion, _, violations in _physics(samples):
        yield Claim(f"recorded steps outside the bounds, {motion}", float(violations), high=0.0)
    for policy, (low, high) in settings.DURATION_BOUNDS.items():
        mean = _measured(samples, _BENCHMARK, policy, "mean")
        yield Claim(f"{_BENCHMARK}, {policy}: mean duration", mean, low=low, high=high)
    ends, alone = curves(samples, settings.SEPARATE)
    for end, (low, high) in settings.LEARNING_BOUNDS.items():
        wanted = ends == end if end < max(settings.LEARNING_BOUNDS) else (ends >= end - 1000) & (ends <= end)
        if wanted.any():
            mean = float(alone[:, wanted].mean())
            yield Claim(f"CMAC Sarsa, mean duration around episode {end}", mean, low=low, high=high)
    early = ends <= max(1000, int(ends[0]))
    gain = float(curves(samples, settings.SHARED)[1][:, early].mean() - alone[:, early].mean())
    yield Claim("gain in mean duration by sharing experience, first 1000 episodes", gain, low=0.0)
    for policy, own in _speeds(samples).items():
        for game, low in settings.SPEED_BOUNDS.items():
            if game in own:
                yield Claim(f"{game}, {policy}: game cycles per CPU second", own[game], low=low)


def _durations_figure(samples: Samples) -> Figure:
    figure = Figure(figsize=(6.4, 3.8), layout="constrained")
    axes = figure.add_subplot()
    labels: list[str] = []
    for game, policy, found in _played(samples):
        _draw_spread(axes, len(labels), found, BLUE)
        labels.append(f"{game} {policy}")
        if game == _BENCHMARK:
            _draw_spread(axes, len(labels), SERVER[policy], GREY)
            labels.append("real server")
    axes.set_yticks(range(len(labels)), labels)
    axes.invert_yaxis()
    axes.set_xscale("log")
    ticks = (20, 50, 100, 200, 500)
    axes.set_xticks(ticks, [str(tick) for tick in ticks])
    axes.minorticks_off()
    axes.set_xlabel("duration of an episode in cycles of 0.1 s\n(line: 5 to 95 %, bar: median, dot: mean)")
    return figure


def _draw_spread(axes: Axes, row: int, found: Mapping[str, float], color: str) -> None:
    axes.plot([found["q5"], found["q95"]], [row, row], "-", color=color, linewidth=1.2)
    if "q25" in found:
        axes.plot([found["q25"], found["q75"]], [row, row], "-", color=color, linewidth=5, alpha=0.35)
    axes.plot([found["q50"]] * 2, [row - 0.28, row + 0.28], "-", color=color, linewidth=2)
    axes.plot([found["mean"]], [row], "o", color=color, markersize=5)


def _learning_figure(samples: Samples) -> Figure:
    figure = Figure(figsize=(6.4, 3.8), layout="constrained")
    axes = figure.add_subplot()
    for method, (title, color) in _LEARNERS.items():
        ends, values = curves(samples, method)
        axes.fill_between(ends, values.min(axis=0), values.max(axis=0), color=color, alpha=0.15, linewidth=0)
        axes.plot(ends, values.mean(axis=0), "-", color=color, label=title)
    for policy, name, style in (("hand", "hand-coded policy", "--"), ("random", "random policy", ":")):
        mean = _measured(samples, _BENCHMARK, policy, "mean")
        axes.axhline(mean, color=GREY, linewidth=0.9, linestyle=style, label=name)
    axes.set_xlabel("episodes")
    axes.set_ylabel("mean duration in cycles")
    axes.set_ylim(bottom=0)
    axes.set_title(f"CMAC Sarsa learns {_BENCHMARK} keepaway (bands: lowest to highest run)", loc="left")
    axes.legend(loc="lower right")
    return figure


def _speed_figure(samples: Samples) -> Figure:
    figure = Figure(figsize=(6.4, 3.2), layout="constrained")
    axes = figure.add_subplot()
    speeds = _speeds(samples)
    for (policy, own), color in zip(speeds.items(), (BLUE, ORANGE), strict=False):
        axes.plot(list(own), list(own.values()), "o-", color=color, label=policy)
    for game, low in settings.SPEED_BOUNDS.items():
        if game in next(iter(speeds.values())):
            label = "aim" if game == _BENCHMARK else None
            axes.plot([game], [low], "_", color=INK, markersize=16, label=label)
    axes.axhline(480, color=PALE, linewidth=1.2)
    axes.annotate("real server", (0.0, 480), (0, 3), textcoords="offset points", fontsize=8.0, color=GREY)
    axes.set_yscale("log")
    axes.set_ylabel("game cycles per CPU second")
    axes.legend(loc="center right")
    return figure


STUDY: Final = Study(*heading(__package__), settings.SETTINGS, settings.SMOKE, compute, summarize, figures)
