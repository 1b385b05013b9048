"""Table -> our games beside real ones, learning curves, speeds, claims, and pictures of all three."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from relforest.experiments.claims import Claim, Findings
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
    SHARED,
    SPEED,
    SPEED_BOUNDS,
)
from relforest.experiments.table import Table, aligned
from relforest.metrics import NORMAL_95
from relforest.reports.style import BLUE, GREY, INK, ORANGE, PALE, styled

_BENCHMARK = "3v2"
_LEARNERS: Mapping[str, tuple[str, str]] = {
    SEPARATE: ("every keeper learns alone", BLUE),
    SHARED: ("all learn from everyone", ORANGE),
}


def summarize(table: Table) -> Findings:
    """State everything measured beside what real games gave, and whether it lies where it must."""
    parts = [
        _physics_text(table),
        "Durations of episodes in cycles of 0.1 s (95 % interval of the mean)\n" + _durations_text(table),
        f"What happens in {_BENCHMARK} games of random keepers\n" + _events_text(table),
        _learning_text(table),
        _speed_text(table),
    ]
    claims = (
        *_physics_claims(table),
        *_duration_claims(table),
        *_learning_claims(table),
        *_speed_claims(table),
    )
    return Findings("\n\n".join(parts), claims)


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


def _physics_text(table: Table) -> str:
    counts = _physics(table)
    if not counts:
        return (
            "One-step physics: not compared with recorded games (set RELFOREST_DATA to a folder that holds "
            "keepaway-trajectories.npz)"
        )
    rows = [(kind, f"{steps:.0f}", f"{violations:.0f}") for kind, (steps, violations) in counts.items()]
    return "Recorded steps of the real server outside the bounds of the formulas\n" + aligned(
        ("kind", "steps", "outside"), rows
    )


def _physics(table: Table) -> dict[str, tuple[float, float]]:
    rows = table.where(part=PHYSICS).rows
    found = {str(row["measure"]): row["value"] for row in rows if row["measure"]}
    kinds = dict.fromkeys(name.split(":")[0] for name in found)
    return {
        kind: (float(found[f"{kind}: steps"] or 0), float(found[f"{kind}: violations"] or 0))
        for kind in kinds
    }


def _played(table: Table) -> Iterator[tuple[str, str]]:
    rows = table.where(part=DURATIONS).rows
    yield from dict.fromkeys((str(row["game"]), str(row["condition"])) for row in rows)


def _durations_text(table: Table) -> str:
    rows = []
    for game, policy in _played(table):
        found = {name: measure(table, DURATIONS, game, policy, name) for name in _COLUMNS}
        error = NORMAL_95 * found["sd"] / measure(table, DURATIONS, game, policy, "episodes") ** 0.5
        quantiles = "/".join(f"{found[name]:.0f}" for name in ("q5", "q25", "q50", "q75", "q95"))
        mean = f"{found['mean']:.1f} +- {error:.1f}"
        rows.append((f"{game} {policy}", mean, f"{found['sd']:.1f}", quantiles, f"{found['taken']:.2f}"))
        if game == _BENCHMARK:
            real = SERVER[policy]
            quantiles = f"{real['q5']:.0f}/-/{real['q50']:.0f}/-/{real['q95']:.0f}"
            rows.append(
                (
                    "  real server",
                    f"{real['mean']:.1f}",
                    f"{real['sd']:.1f}",
                    quantiles,
                    f"{real['taken']:.2f}",
                )
            )
    return aligned(("", "mean", "sd", "5/25/50/75/95 %", "taken"), rows)


_COLUMNS = ("mean", "sd", "q5", "q25", "q50", "q75", "q95", "taken")


def _events_text(table: Table) -> str:
    rows = []
    for name, title in EVENT_TITLES.items():
        ours = measure(table, DURATIONS, _BENCHMARK, "random", name)
        real = SERVER_EVENTS[name]
        digits = 3 if real < 1 else 2
        rows.append((title, f"{ours:.{digits}f}", f"{real:.{digits}f}"))
    return aligned(("", "ours", "real server"), rows)


def _learning_text(table: Table) -> str:
    rows = []
    found = {method: curves(table, method) for method in _LEARNERS}
    for place, end in enumerate(found[SEPARATE][0].tolist()):
        cells = []
        for _, values in found.values():
            column = values[:, place]
            cells.append(f"{column.mean():.1f} ({column.min():.1f} to {column.max():.1f})")
        rows.append((str(end), *cells))
    runs = len(found[SEPARATE][1])
    return f"Mean duration while CMAC Sarsa learns {_BENCHMARK}, {runs} runs (lowest to highest)\n" + aligned(
        ("until episode", *(title for title, _ in _LEARNERS.values())), rows
    )


def _speeds(table: Table) -> dict[str, dict[str, float]]:
    rows = table.where(part=SPEED).rows
    found: dict[str, dict[str, float]] = {}
    for row in rows:
        value = row["value"]
        found.setdefault(str(row["condition"]), {})[str(row["game"])] = float(value or 0)
    return found


def _speed_text(table: Table) -> str:
    speeds = _speeds(table)
    games = list(next(iter(speeds.values())))
    rows = [
        (policy, *(f"{own[game]:,.0f}" if game in own else "" for game in games))
        for policy, own in speeds.items()
    ]
    return "Game cycles per second of CPU time, one core\n" + aligned(("", *games), rows)


def _physics_claims(table: Table) -> Iterator[Claim]:
    for kind, (_, violations) in _physics(table).items():
        yield Claim(f"recorded steps outside the bounds, {kind}", violations, high=0.0)


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
        found = {name: measure(table, DURATIONS, game, policy, name) for name in _COLUMNS}
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
