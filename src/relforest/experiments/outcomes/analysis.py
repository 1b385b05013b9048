"""Table -> scores of all models, claims, the source's statements, figures like the source's."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import product
from typing import Final

import numpy as np
from matplotlib.figure import Figure

from relforest.experiments.claims import Claim, Findings
from relforest.experiments.outcomes.run import compute, unavailable
from relforest.experiments.outcomes.settings import (
    BALANCE,
    CURVE,
    LARGE,
    OF_2012,
    OURS,
    RIVALS,
    SETTINGS,
    SIZES,
    SMALL,
    SMOKE,
    SMRF,
    TASKS,
)
from relforest.experiments.outcomes.statements import statements
from relforest.experiments.registry import heading
from relforest.experiments.samples import Samples
from relforest.experiments.sheets import Estimate, Sheet
from relforest.experiments.study import Study
from relforest.experiments.table import Table
from relforest.metrics import mean_interval
from relforest.reports.style import BLUE, GOLD, GREEN, GREY, INK, MARKERS, ORANGE, PINK, SERIES, mixed, styled

METHODS: Final = (OURS, SMRF, OF_2012, *RIVALS)
# SMRF trees in lighter shades of our color; rivals in others.
_SHADES: Final = dict(
    zip(METHODS, (BLUE, mixed(BLUE, 0.6), mixed(BLUE, 0.3), ORANGE, GOLD, GREY, PINK, GREEN), strict=True)
)
DIRECTIONS: Final = tuple(product(SIZES, SIZES))
_HARD: Final = tuple(task for task in TASKS if task != BALANCE)

LEAST_TRANSFER: Final = 0.50
LEAST_LEAD: Final = 0.05
LEAST_BALANCE: Final = 0.98
MOST_LOG10_P: Final = -6.0


def summarize(table: Table) -> Findings:
    """State scores, compare the outcome forest with rivals, repeat the source's statements."""
    samples = Samples.of(table, "part", "task", "trained", "tested", "method", "measure")
    return Findings(
        "",
        tuple(_claims(samples)) if samples.below("models") else (),
        tuple(sheet for sheet in (_scores(samples), statements(samples), _trees(samples)) if sheet.rows),
    )


def _claims(samples: Samples) -> Iterator[Claim]:
    """Yield what the outcome forest must reach."""
    behind = [
        mean_interval(ours - theirs).high
        for task, direction, rival in product(TASKS, DIRECTIONS, RIVALS)
        if len(ours := samples["models", task, *direction, OURS, "pss"]) > 1
        and len(ours) == len(theirs := samples["models", task, *direction, rival, "pss"])
    ]
    yield Claim(
        "lead over a rival where it is least, upper end of its 95 % interval",
        min(behind, default=np.nan),
        low=0.0,
    )
    if all(len(samples["models", task, SMALL, LARGE, OURS, "pss"]) for task in _HARD):
        means = {method: _transfer(samples, method) for method in (OURS, *RIVALS)}
        lead = means.pop(OURS) - np.nanmax(list(means.values()))
        yield Claim(
            "lead over the best rival, both directions of transfer, mean of two tasks",
            float(lead),
            low=LEAST_LEAD,
        )
        mean = np.mean([samples.mean(("models", task, SMALL, LARGE, OURS, "pss")).value for task in _HARD])
        yield Claim("PSS from small to large scenes, mean of two tasks", float(mean), low=LEAST_TRANSFER)
    balance = samples["models", BALANCE, SMALL, LARGE, OURS, "pss"]
    if len(balance):
        name = "balance scale: PSS from small to large scenes"
        yield Claim(name, float(balance.mean()), low=LEAST_BALANCE)
    chances = [
        float(samples[key].max())
        for key in product(["models"], TASKS, SIZES, SIZES, [OURS], ["log10 p"])
        if len(samples[key])
    ]
    yield Claim("largest log10 p of a test against chance", max(chances, default=np.nan), high=MOST_LOG10_P)


def _transfer(samples: Samples, method: str) -> float:
    """Return the mean score of a method in both directions of transfer, over the two harder tasks."""
    ways = ((SMALL, LARGE), (LARGE, SMALL))
    return float(
        np.mean([samples.mean(("models", task, *way, method, "pss")).value for task in _HARD for way in ways])
    )


def _scores(samples: Samples) -> Sheet:
    rows = []
    for task, (trained, tested), method in product(TASKS, DIRECTIONS, METHODS):
        found = {
            measure: samples["models", task, trained, tested, method, measure]
            for measure in ("pss", "best", "auc")
        }
        if len(found["pss"]):
            seconds = samples.mean(("models", task, trained, trained, method, "seconds")).value
            lost = float((found["best"] - found["pss"]).mean())
            estimates = (Estimate.of(found["pss"]), lost, float(found["auc"].mean()), seconds)
            rows.append((TASKS[task], f"{trained} -> {tested}", method, len(found["pss"]), *estimates))
    columns = {
        **dict.fromkeys(("task", "scenes", "method", "draws"), ""),
        "PSS": ".3f",
        "lost by the threshold": ".3f",
        "AUC": ".3f",
        "CPU s": ".1f",
    }
    caption = (
        "Peirce skill scores on new scenes (+-: 95 % of the mean over draws), how much the best threshold\n"
        "for these scenes would add, area under the curve, and time to learn"
    )
    return Sheet(caption, columns, tuple(rows))


def _trees(samples: Samples) -> Sheet:
    rows = []
    for task, size in product(TASKS, SIZES):
        for measure, values in samples.below("protocol", task, size, size, "all trees").items():
            rows.append((TASKS[task], size, measure, float(values.mean())))
    caption = "Trees without questions, and what questions compare"
    return Sheet(caption, {"task": "", "scenes": "", "": "", "share": ".2f"}, tuple(rows))


def figures(table: Table) -> Mapping[str, Figure]:
    """Draw bars of all models in all directions, and scores against the number of trees."""
    samples = Samples.of(table, "part", "task", "trained", "tested", "method", "measure")
    with styled():
        return {"scores.png": _bars(samples), "forest-size.png": _curve(samples)}


def _bars(samples: Samples) -> Figure:
    figure = Figure(figsize=(7.6, 6.4), layout="constrained")
    width = 0.85 / len(METHODS)
    for axes, task in zip(figure.subplots(len(TASKS), sharex=True), TASKS, strict=True):
        for place, method in enumerate(METHODS):
            found = [samples.mean(("models", task, *way, method, "pss")) for way in DIRECTIONS]
            at = np.arange(len(DIRECTIONS)) + (place - (len(METHODS) - 1) / 2) * width
            spreads = [each.spread or 0.0 for each in found]
            heights = [each.value for each in found]
            axes.bar(at, heights, 0.92 * width, yerr=spreads, color=_SHADES[method], ecolor=INK)
        axes.set_title(TASKS[task], loc="left")
        axes.set_ylabel("PSS")
        axes.set_ylim(0, 1)
    axes.set_xticks(range(len(DIRECTIONS)), [f"{a} \N{RIGHTWARDS ARROW} {b}" for a, b in DIRECTIONS])
    figure.legend(METHODS, loc="outside lower center", ncols=len(METHODS) // 2)
    return figure


def _curve(samples: Samples) -> Figure:
    figure = Figure(figsize=(7.6, 2.8), layout="constrained")
    for axes, task in zip(figure.subplots(1, len(TASKS), sharey=True), TASKS, strict=True):
        for number, way in enumerate(DIRECTIONS):
            found = {n: samples["protocol", task, *way, f"{n} + {n}", "pss"] for n in CURVE}
            drawn = {2 * n: values for n, values in found.items() if len(values)}
            axes.errorbar(
                list(drawn),
                [float(values.mean()) for values in drawn.values()],
                [float(values.std()) for values in drawn.values()],
                marker=MARKERS[number],
                markersize=4,
                color=SERIES[number],
                label=f"{way[0]} \N{RIGHTWARDS ARROW} {way[1]}",
            )
        axes.set_title(TASKS[task], loc="left")
        axes.set_xlabel("trees (bars: deviation over draws)")
    figure.axes[0].set_ylabel("PSS")
    figure.axes[-1].legend()
    return figure


STUDY: Final = Study(
    *heading(__package__),
    SETTINGS,
    SMOKE,
    compute,
    summarize,
    figures,
    choices={"datasets": lambda setting: setting.task, "methods": lambda setting: setting.part},
    unavailable=unavailable,
)
