"""Table -> our blocks world beside the author's simulator, and what must hold."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Final

import numpy as np
from numpy.typing import NDArray

from relforest.experiments.blocks.pictures import figures
from relforest.experiments.blocks.run import compute
from relforest.experiments.blocks.samples import Samples
from relforest.experiments.blocks.settings import (
    ARCHES,
    AUTHOR,
    BOUNDS,
    CAREFUL,
    COLOR_REFERENCE,
    COLORS,
    GROUPS,
    LAB_TOLERANCE,
    LARGE_FIRST,
    LIFT,
    LIFT_REFERENCE,
    LIFT_TOLERANCE,
    MANUAL,
    MANUAL_RGB,
    OPTION_REFERENCE,
    OUTCOME_TASKS,
    OUTCOMES,
    POLICIES,
    RANDOM,
    RANDOM_RGB,
    SCENARIOS,
    SETTINGS,
    SETTLE,
    SETTLE_REFERENCE,
    SETTLE_TOLERANCE,
    SHARE_TOLERANCE,
    SMALL_FIRST,
    SMOKE,
    SPEED,
    TASK_TITLES,
    TOTAL_REFERENCE,
    TOWERS,
    TRAINER,
)
from relforest.experiments.claims import Claim, Findings
from relforest.experiments.headings import heading
from relforest.experiments.sheets import Entry, Estimate, Format, Sheet
from relforest.experiments.study import Study
from relforest.experiments.table import Table

_ORDERED = (
    (TOWERS, SMALL_FIRST, RANDOM),
    (TOWERS, LARGE_FIRST, SMALL_FIRST),
    (GROUPS, MANUAL, RANDOM),
    (GROUPS, MANUAL_RGB, RANDOM_RGB),
    (ARCHES, TRAINER, RANDOM),
    (ARCHES, CAREFUL, TRAINER),
)


def summarize(table: Table) -> Findings:
    """State what was measured beside what the author's simulator gave, and whether it lies where it must."""
    samples = Samples.of(table)
    sheets = (_settle, _lift, _options, _totals, _arches, _colors, _outcomes, _speed)
    return Findings("", tuple(_claims(samples)), tuple(sheet(samples) for sheet in sheets))


def settle_numbers(samples: Samples, scenario: str) -> dict[str, float]:
    """Return the count, mean, median, 90 % quantile and maximum of the steps of a drop, and what it left."""
    steps = samples[SETTLE, scenario, "steps"]
    median, p90 = np.percentile(steps, (50, 90))
    return {
        "n": float(len(steps)),
        "mean": float(steps.mean()),
        "median": float(median),
        "p90": float(p90),
        "max": float(steps.max()),
        "over": float((steps > 500).mean()),
        "height": samples.mean((SETTLE, scenario, "height")).value,
    }


def _settle(samples: Samples) -> Sheet:
    rows: list[tuple[Entry, ...]] = []
    for scenario in SCENARIOS:
        references = {name: row for (blocks, name), row in SETTLE_REFERENCE.items() if blocks == scenario}
        for name, found in {"ours": settle_numbers(samples, scenario), **references}.items():
            numbers = (found[column] for column in ("n", "mean", "median", "p90", "max", "over", "height"))
            rows.append((f"{scenario}, {name}", *map(float, numbers)))
    whole = dict.fromkeys(("drops", "mean", "median", "90 %", "longest"), ".0f")
    columns = {"": "", **whole, "> 500": ".1%", "mean height": ".3f"}
    return Sheet("Steps of 0.01 s until dropped blocks lie still", columns, tuple(rows))


def _lift(samples: Samples) -> Sheet:
    rows = tuple(
        (size, samples.mean((LIFT, size, "steps")).value, *references)
        for size, references in LIFT_REFERENCE.items()
    )
    caption = "Steps until a block, grasped at its centre, hangs still at a height of 20"
    return Sheet(caption, {"half sizes": "", "ours": ".0f", AUTHOR: "", "a plain port": ""}, rows)


def _options(samples: Samples) -> Sheet:
    rows = tuple(
        (
            f"{TASK_TITLES[part]}, {policy}: {measure.replace('_', ' ')}",
            *_described(samples[part, policy, measure]),
            *references,
        )
        for (part, policy, measure), references in OPTION_REFERENCE.items()
    )
    caption = "Options (95 % interval of the mean; durations in seconds)"
    return Sheet(caption, _beside(lambda value: ".0f" if value >= 100 else ".2f"), rows)


def _totals(samples: Samples) -> Sheet:
    rows = tuple(
        (
            f"{TASK_TITLES[part]}, {policy}",
            *_described(samples[part, policy, "total"]),
            *TOTAL_REFERENCE.get((part, policy), (math.nan, math.nan)),
        )
        for part, policies in POLICIES.items()
        for policy in policies
    )
    return Sheet("Totals of an episode (95 % interval of the mean)", _beside(".2f"), rows)


def _described(values: NDArray[np.float64]) -> tuple[int, Estimate, float]:
    """Return the number of values, their mean and their standard deviation."""
    return len(values), Estimate.of(values), float(values.std(ddof=1)) if len(values) > 1 else math.nan


def _beside(form: Format) -> dict[str, Format]:
    return {"": "", "n": "", **dict.fromkeys(("ours", "sd", AUTHOR, "a plain port"), form)}


def _arches(samples: Samples) -> Sheet:
    rows = []
    for policy in POLICIES[ARCHES]:
        stands, totals = samples[ARCHES, policy, "stands"], samples[ARCHES, policy, "total"]
        rows.append((policy, Estimate.of(stands), Estimate.of(totals[stands > 0])))
    columns = {"": "", "share of episodes": ".2f", "mean score": ".1f"}
    return Sheet("Episodes that end with an arch", columns, tuple(rows))


def _colors(samples: Samples) -> Sheet:
    titles = ("25 %", "median", "largest", "share <= 30", "RGB: 25 %", "share <= 0.5")
    rows: list[tuple[Entry, ...]] = []
    for sampling, reference in COLOR_REFERENCE.items():
        ours = (samples.mean((COLORS, sampling, name)).value for name in reference)
        rows += [(f"{sampling}, ours", *ours), (f"{sampling}, expected", *reference.values())]
    columns = dict.fromkeys(titles, lambda value: ".1f" if value > 1 else ".3f")
    return Sheet("Distances of random pairs of colours", {"": "", **columns}, tuple(rows))


def _outcomes(samples: Samples) -> Sheet:
    rows = []
    for task in OUTCOME_TASKS:
        decided, labels = samples[OUTCOMES, task, "decided"], samples[OUTCOMES, task, "label"]
        rows.append((task, len(decided), Estimate.of(decided), Estimate.of(labels)))
    columns = {"": "", "scenes": "", "decided": ".2f", "true among these": ".2f"}
    return Sheet("Outcome tasks: shares of scenes", columns, tuple(rows))


def _speed(samples: Samples) -> Sheet:
    rows = []
    for policy in samples.measured(SPEED, POLICIES[TOWERS], "milliseconds"):
        milliseconds = samples.mean((SPEED, policy, "milliseconds"))
        steps = samples.mean((SPEED, policy, "steps")).value
        rows.append((policy, milliseconds, steps, 1000 * steps / milliseconds.value))
    columns = {"": "", "milliseconds": ".1f", "steps": ".0f", "steps a second": ",.0f"}
    return Sheet("CPU time of an episode of high towers, one thread", columns, tuple(rows))


def _claims(samples: Samples) -> Iterator[Claim]:
    yield from _settle_claims(samples)
    for size, (author, _) in LIFT_REFERENCE.items():
        low, high = author * (1 - LIFT_TOLERANCE), author * (1 + LIFT_TOLERANCE)
        yield Claim(f"lift of {size}, steps", samples.mean((LIFT, size, "steps")).value, low=low, high=high)
    for key, (low, high) in BOUNDS.items():
        part, policy, measure = key
        name = f"{TASK_TITLES[part]}, {policy}: {measure.replace('_', ' ')}"
        yield Claim(name, samples.mean(key).value, low=low, high=high)
    for part, better, worse in _ORDERED:
        gain = samples.mean((part, better, "total")).minus(samples.mean((part, worse, "total")))
        name = f"{TASK_TITLES[part]}, {better} above {worse}: lower end of the 95 % interval"
        yield Claim(name, gain.low, low=0.0)
    yield from _color_claims(samples)


def _settle_claims(samples: Samples) -> Iterator[Claim]:
    for scenario in SCENARIOS:
        found, reference = settle_numbers(samples, scenario), SETTLE_REFERENCE[scenario, AUTHOR]
        for name, tolerance in SETTLE_TOLERANCE.items():
            low, high = reference[name] * (1 - tolerance), reference[name] * (1 + tolerance)
            yield Claim(f"{scenario}: {name} of the steps of a drop", found[name], low=low, high=high)


def _color_claims(samples: Samples) -> Iterator[Claim]:
    for sampling, reference in COLOR_REFERENCE.items():
        for name, tolerance in (("lab_q25", LAB_TOLERANCE), ("lab_q50", LAB_TOLERANCE)):
            measured = samples.mean((COLORS, sampling, name)).value
            low, high = reference[name] - tolerance, reference[name] + tolerance
            title = f"{sampling}: {name.removeprefix('lab_q')} % quantile of CIEDE2000"
            yield Claim(title, measured, low=low, high=high)
        for name, title in (("lab_near", "CIEDE2000 <= 30"), ("rgb_near", "RGB distance <= 0.5")):
            measured = samples.mean((COLORS, sampling, name)).value
            low, high = reference[name] - SHARE_TOLERANCE, reference[name] + SHARE_TOLERANCE
            yield Claim(f"{sampling}: share with {title}", measured, low=low, high=high)


STUDY: Final = Study(*heading(__package__), SETTINGS, SMOKE, compute, summarize, figures, compiles=False)
