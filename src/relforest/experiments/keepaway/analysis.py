"""Table -> our games beside real ones, learning curves, speeds, claims, and pictures of all three."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Final

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from relforest.experiments.claims import Claim, Findings
from relforest.experiments.headings import heading
from relforest.experiments.keepaway.run import compute
from relforest.experiments.keepaway.settings import (
    DURATION_BOUNDS,
    DURATIONS,
    EVENT_TITLES,
    LEARNING,
    LEARNING_BOUNDS,
    PHYSICS,
    SEPARATE,
    SERVER,
    SERVER_EVENTS,
    SETTINGS,
    SHARED,
    SMOKE,
    SPEED,
    SPEED_BOUNDS,
)
from relforest.experiments.sheets import Entry, Estimate, Format, Sheet, Span
from relforest.experiments.study import Study
from relforest.experiments.table import Table
from relforest.reports.style import BLUE, GREY, INK, ORANGE, PALE, styled

_BENCHMARK = "3v2"
_LEARNERS: Mapping[str, tuple[str, str]] = {
    SEPARATE: ("every keeper learns alone", BLUE),
    SHARED: ("all learn from everyone", ORANGE),
}
_NO_PHYSICS = (
    "One-step physics: not compared with recorded games (set RELFOREST_DATA to a folder that holds "
    "keepaway-trajectories.npz)"
)


def summarize(table: Table) -> Findings:
    """State everything measured beside what real games gave, and whether it lies where it must."""
    physics, recorded = (
        _physics(table),
        "Recorded steps of the real server outside the bounds of the formulas",
    )
    claims = (
        *(Claim(f"recorded steps outside the bounds, {kind}", float(n), high=0.0) for kind, _, n in physics),
        *_duration_claims(table),
        *_learning_claims(table),
        *_speed_claims(table),
    )
    sheets = (
        *([Sheet(recorded, dict.fromkeys(("kind", "steps", "outside"), ""), physics)] if physics else []),
        _durations(table),
        _events(table),
        _learning(table),
        _speed(table),
    )
    return Findings("" if physics else _NO_PHYSICS, claims, sheets)


def figures(table: Table) -> Mapping[str, Figure]:
    """Draw the durations beside those of real games, the learning curves, and the speeds."""
    with styled():
        return {
            "durations.png": _durations_figure(table),
            "learning.png": _learning_figure(table),
            "speed.png": _speed_figure(table),
        }


def measure(table: Table, part: str, game: str, condition: str, name: str) -> float:
    """Return one number of the table; NaN if it was not measured."""
    rows = table.where(part=part, game=game, condition=condition)
    found = [row["value"] for row in rows.rows if row["measure"] == name]
    return float(found[0]) if found and isinstance(found[0], (int, float)) else float("nan")


def curves(table: Table, method: str) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Return the ends of the blocks of episodes, (blocks,), and the runs' mean durations, (runs, blocks)."""
    rows = table.where(part=LEARNING, condition=method)
    ends = [int(str(name)) for name in rows.distinct("measure")]
    values = [rows.where(run=run).numbers("value") for run in rows.distinct("run")]
    return np.array(ends), np.array(values)


def _physics(table: Table) -> tuple[tuple[str, int, int], ...]:
    """Return kind, number and violations of the recorded steps; nothing if there is no recording."""
    found = {str(row["measure"]): int(row["value"] or 0) for row in table.where(part=PHYSICS).rows}
    kinds = dict.fromkeys(name.partition(":")[0] for name in found if name)
    return tuple((kind, found[f"{kind}: steps"], found[f"{kind}: violations"]) for kind in kinds)


def _played(table: Table) -> Iterator[tuple[str, str]]:
    for game, policy in table.where(part=DURATIONS).groups("game", "condition"):
        yield str(game), str(policy)


def _durations(table: Table) -> Sheet:
    rows: list[tuple[Entry, ...]] = []
    for game, policy in _played(table):
        found = {name: measure(table, DURATIONS, game, policy, name) for name in _MEASURES}
        episodes = int(measure(table, DURATIONS, game, policy, "episodes"))
        mean = Estimate.normal(found.pop("mean"), found["sd"], episodes)
        rows.append((f"{game} {policy}", mean, *found.values()))
        if game == _BENCHMARK:
            rows.append(("  real server", *(SERVER[policy].get(name) for name in _MEASURES)))
    quantiles = dict.fromkeys(("5 %", "25 %", "50 %", "75 %", "95 %"), ".0f")
    caption = "Durations of episodes in cycles of 0.1 s (95 % interval of the mean)"
    return Sheet(caption, {"": "", "mean": ".1f", "sd": ".1f", **quantiles, "taken": ".2f"}, tuple(rows))


_MEASURES = ("mean", "sd", "q5", "q25", "q50", "q75", "q95", "taken")


def _events(table: Table) -> Sheet:
    rows = tuple(
        (title, measure(table, DURATIONS, _BENCHMARK, "random", name), SERVER_EVENTS[name])
        for name, title in EVENT_TITLES.items()
    )
    columns = dict.fromkeys(("ours", "real server"), lambda value: ".3f" if value < 1 else ".2f")
    return Sheet(f"What happens in {_BENCHMARK} games of random keepers", {"": "", **columns}, rows)


def _learning(table: Table) -> Sheet:
    found = [(title, *curves(table, method)) for method, (title, _) in _LEARNERS.items()]
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
    caption = (
        f"Mean duration while CMAC Sarsa learns {_BENCHMARK}, {len(found[0][2])} runs (lowest to highest)"
    )
    return Sheet(caption, columns, tuple(rows))


def _speeds(table: Table) -> dict[str, dict[str, float]]:
    rows = table.where(part=SPEED).rows
    found: dict[str, dict[str, float]] = {}
    for row in rows:
        value = row["value"]
        found.setdefault(str(row["condition"]), {})[str(row["game"])] = float(value or 0)
    return found


def _speed(table: Table) -> Sheet:
    speeds = _speeds(table)
    games = list(next(iter(speeds.values())))
    rows = tuple((policy, *(own.get(game) for game in games)) for policy, own in speeds.items())
    caption = "Game cycles per second of CPU time, one core"
    return Sheet(caption, {"": "", **dict.fromkeys(games, ",.0f")}, rows)


def _duration_claims(table: Table) -> Iterator[Claim]:
    for policy, (low, high) in DURATION_BOUNDS.items():
        mean = measure(table, DURATIONS, _BENCHMARK, policy, "mean")
        yield Claim(f"{_BENCHMARK}, {policy}: mean duration", mean, low=low, high=high)


def _learning_claims(table: Table) -> Iterator[Claim]:
    ends, alone = curves(table, SEPARATE)
    together = curves(table, SHARED)[1]
    for end, (low, high) in LEARNING_BOUNDS.items():
        wanted = ends == end if end < max(LEARNING_BOUNDS) else (ends >= end - 1000) & (ends <= end)
        if wanted.any():
            mean = float(alone[:, wanted].mean())
            yield Claim(f"CMAC Sarsa, mean duration around episode {end}", mean, low=low, high=high)
    early = ends <= max(1000, int(ends[0]))
    gain = float(together[:, early].mean() - alone[:, early].mean())
    yield Claim("gain in mean duration by sharing experience, first 1000 episodes", gain, low=0.0)


def _speed_claims(table: Table) -> Iterator[Claim]:
    for policy, own in _speeds(table).items():
        for game, low in SPEED_BOUNDS.items():
            if game in own:
                yield Claim(f"{game}, {policy}: game cycles per CPU second", own[game], low=low)


def _durations_figure(table: Table) -> Figure:
    figure = Figure(figsize=(6.4, 3.8), layout="constrained")
    axes = figure.add_subplot()
    labels: list[str] = []
    for game, policy in _played(table):
        found = {name: measure(table, DURATIONS, game, policy, name) for name in _MEASURES}
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


def _learning_figure(table: Table) -> Figure:
    figure = Figure(figsize=(6.4, 3.8), layout="constrained")
    axes = figure.add_subplot()
    for method, (title, color) in _LEARNERS.items():
        ends, values = curves(table, method)
        axes.fill_between(ends, values.min(axis=0), values.max(axis=0), color=color, alpha=0.15, linewidth=0)
        axes.plot(ends, values.mean(axis=0), "-", color=color, label=title)
    for policy, style in (("hand", "--"), ("random", ":")):
        mean = measure(table, DURATIONS, _BENCHMARK, policy, "mean")
        name = {"hand": "hand-coded policy", "random": "random policy"}[policy]
        axes.axhline(mean, color=GREY, linewidth=0.9, linestyle=style, label=name)
    axes.set_xlabel("episodes")
    axes.set_ylabel("mean duration in cycles")
    axes.set_ylim(bottom=0)
    axes.set_title(f"CMAC Sarsa learns {_BENCHMARK} keepaway (bands: lowest to highest run)", loc="left")
    axes.legend(loc="lower right")
    return figure


def _speed_figure(table: Table) -> Figure:
    figure = Figure(figsize=(6.4, 3.2), layout="constrained")
    axes = figure.add_subplot()
    for (policy, own), color in zip(_speeds(table).items(), (BLUE, ORANGE), strict=False):
        axes.plot(list(own), list(own.values()), "o-", color=color, label=policy)
    for game, low in SPEED_BOUNDS.items():
        if game in next(iter(_speeds(table).values())):
            axes.plot(
                [game], [low], "_", color=INK, markersize=16, label="aim" if game == _BENCHMARK else None
            )
    axes.axhline(480, color=PALE, linewidth=1.2)
    axes.annotate("real server", (0.0, 480), (0, 3), textcoords="offset points", fontsize=8.0, color=GREY)
    axes.set_yscale("log")
    axes.set_ylabel("game cycles per CPU second")
    axes.legend(loc="center right")
    return figure


STUDY: Final = Study(*heading(__package__), SETTINGS, SMOKE, compute, summarize, figures)
