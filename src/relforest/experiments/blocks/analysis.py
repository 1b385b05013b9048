"""Table -> our blocks world beside the author's simulator, and what must hold."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Final

import numpy as np
from numpy.typing import NDArray

from relforest.experiments.blocks import settings
from relforest.experiments.blocks.pictures import figures
from relforest.experiments.blocks.run import compute
from relforest.experiments.claims import Claim, Findings
from relforest.experiments.registry import heading
from relforest.experiments.samples import Samples
from relforest.experiments.sheets import Entry, Estimate, Format, Sheet
from relforest.experiments.study import Study
from relforest.experiments.table import Table

_ORDERED = (
    (settings.TOWERS, settings.SMALL_FIRST, settings.RANDOM),
    (settings.TOWERS, settings.LARGE_FIRST, settings.SMALL_FIRST),
    (settings.GROUPS, settings.MANUAL, settings.RANDOM),
    (settings.GROUPS, settings.MANUAL_RGB, settings.RANDOM_RGB),
    (settings.ARCHES, settings.TRAINER, settings.RANDOM),
    (settings.ARCHES, settings.CAREFUL, settings.TRAINER),
)


def summarize(table: Table) -> Findings:
    """State what was measured beside what the author's simulator gave, and whether it lies where it must."""
    samples = Samples.of(table, "part", "condition", "measure")
    sheets = (_settle, _lift, _options, _totals, _arches, _colors, _outcomes, _speed)
    return Findings("", tuple(_claims(samples)), tuple(sheet(samples) for sheet in sheets))


def settle_numbers(samples: Samples, scenario: str) -> dict[str, float]:
    """Return the count, mean, median, 90 % quantile and maximum of the steps of a drop, and what it left."""
    steps = samples[settings.SETTLE, scenario, "steps"]
    median, p90 = np.percentile(steps, (50, 90))
    return {
        "n": float(len(steps)),
        "mean": float(steps.mean()),
        "median": float(median),
        "p90": float(p90),
        "max": float(steps.max()),
        "over": float((steps > 500).mean()),
        "height": samples.mean((settings.SETTLE, scenario, "height")).value,
    }


def _settle(samples: Samples) -> Sheet:
    rows: list[tuple[Entry, ...]] = []
    for scenario in settings.SCENARIOS:
        references = {
            name: row for (blocks, name), row in settings.SETTLE_REFERENCE.items() if blocks == scenario
        }
        for name, found in {"ours": settle_numbers(samples, scenario), **references}.items():
            numbers = (found[column] for column in ("n", "mean", "median", "p90", "max", "over", "height"))
            rows.append((f"{scenario}, {name}", *map(float, numbers)))
    whole = dict.fromkeys(("drops", "mean", "median", "90 %", "longest"), ".0f")
    columns = {"": "", **whole, "> 500": ".1%", "mean height": ".3f"}
    return Sheet("Steps of 0.01 s until dropped blocks lie still", columns, tuple(rows))


def _lift(samples: Samples) -> Sheet:
    rows = tuple(
        (size, samples.mean((settings.LIFT, size, "steps")).value, *references)
        for size, references in settings.LIFT_REFERENCE.items()
    )
    caption = "Steps until a block, grasped at its centre, hangs still at a height of 20"
    return Sheet(caption, {"half sizes": "", "ours": ".0f", settings.AUTHOR: "", "a plain port": ""}, rows)


def _options(samples: Samples) -> Sheet:
    rows = tuple(
        (
            f"{settings.TASK_TITLES[part]}, {policy}: {measure.replace('_', ' ')}",
            *_described(samples[part, policy, measure]),
            *references,
        )
        for (part, policy, measure), references in settings.OPTION_REFERENCE.items()
    )
    caption = "Options (95 % interval of the mean; durations in seconds)"
    return Sheet(caption, _beside(lambda value: ".0f" if value >= 100 else ".2f"), rows)


def _totals(samples: Samples) -> Sheet:
    rows = tuple(
        (
            f"{settings.TASK_TITLES[part]}, {policy}",
            *_described(samples[part, policy, "total"]),
            *settings.TOTAL_REFERENCE.get((part, policy), (math.nan, math.nan)),
        )
        for part, policies in settings.POLICIES.items()
        for policy in policies
    )
    return Sheet("Totals of an episode (95 % interval of the mean)", _beside(".2f"), rows)


def _described(values: NDArray[np.float64]) -> tuple[int, Estimate, float]:
    """Return the number of values, their mean and their standard deviation."""
    return len(values), Estimate.of(values), float(values.std(ddof=1)) if len(values) > 1 else math.nan


def _beside(form: Format) -> dict[str, Format]:
    return {"": "", "n": "", **dict.fromkeys(("ours", "sd", settings.AUTHOR, "a plain port"), form)}


def _arches(samples: Samples) -> Sheet:
    rows = []
    for policy in settings.POLICIES[settings.ARCHES]:
        stands, totals = samples[settings.ARCHES, policy, "stands"], samples[settings.ARCHES, policy, "total"]
        rows.append((policy, Estimate.of(stands), Estimate.of(totals[stands > 0])))
    columns = {"": "", "share of episodes": ".2f", "mean score": ".1f"}
    return Sheet("Episodes that end with an arch", columns, tuple(rows))


def _colors(samples: Samples) -> Sheet:
    titles = ("25 %", "median", "largest", "share <= 30", "RGB: 25 %", "share <= 0.5")
    rows: list[tuple[Entry, ...]] = []
    for sampling, reference in settings.COLOR_REFERENCE.items():
        ours = (samples.mean((settings.COLORS, sampling, name)).value for name in reference)
        rows += [(f"{sampling}, ours", *ours), (f"{sampling}, expected", *reference.values())]
    columns = dict.fromkeys(titles, lambda value: ".1f" if value > 1 else ".3f")
    return Sheet("Distances of random pairs of colors", {"": "", **columns}, tuple(rows))


def _outcomes(samples: Samples) -> Sheet:
    rows: list[tuple[Entry, ...]] = []
    for task in settings.OUTCOME_TASKS:
        keys = [(settings.OUTCOMES, task, name) for name in ("decided", "label")]
        rows.append((task, len(samples[keys[0]]), *map(samples.mean, keys)))
    columns = {"": "", "scenes": "", "decided": ".2f", "true among these": ".2f"}
    return Sheet("Outcome tasks: shares of scenes", columns, tuple(rows))


def _speed(samples: Samples) -> Sheet:
    rows = []
    for policy in settings.POLICIES[settings.TOWERS]:
        milliseconds = samples.mean((settings.SPEED, policy, "milliseconds"))
        if math.isnan(milliseconds.value):
            continue
        steps = samples.mean((settings.SPEED, policy, "steps")).value
        rows.append((policy, milliseconds, steps, 1000 * steps / milliseconds.value))
    columns = {"": "", "milliseconds": ".1f", "steps": ".0f", "steps a second": ",.0f"}
    return Sheet("CPU time of an episode of high towers, one thread", columns, tuple(rows))


def _claims(samples: Samples) -> Iterator[Claim]:
    for scenario in settings.SCENARIOS:
        found = settle_numbers(samples, scenario)
        reference = settings.SETTLE_REFERENCE[scenario, settings.AUTHOR]
        for name, share in settings.SETTLE_TOLERANCE.items():
            title = f"{scenario}: {name} of the steps of a drop"
            yield _around(title, found[name], reference[name], share * reference[name])
    for size, (author, _) in settings.LIFT_REFERENCE.items():
        steps = samples.mean((settings.LIFT, size, "steps")).value
        yield _around(f"lift of {size}, steps", steps, author, settings.LIFT_TOLERANCE * author)
    for key, (low, high) in settings.BOUNDS.items():
        part, policy, measure = key
        name = f"{settings.TASK_TITLES[part]}, {policy}: {measure.replace('_', ' ')}"
        yield Claim(name, samples.mean(key).value, low=low, high=high)
    for part, better, worse in _ORDERED:
        gain = samples.mean((part, better, "total")).minus(samples.mean((part, worse, "total")))
        name = f"{settings.TASK_TITLES[part]}, {better} above {worse}: lower end of the 95 % interval"
        yield Claim(name, gain.low, low=0.0)
    for sampling, expected in settings.COLOR_REFERENCE.items():
        for name, title, tolerance in _COLOR_CLAIMS:
            measured = samples.mean((settings.COLORS, sampling, name)).value
            yield _around(f"{sampling}: {title}", measured, expected[name], tolerance)


_COLOR_CLAIMS: Final = (
    ("lab_q25", "25 % quantile of CIEDE2000", settings.LAB_TOLERANCE),
    ("lab_q50", "50 % quantile of CIEDE2000", settings.LAB_TOLERANCE),
    ("lab_near", "share with CIEDE2000 <= 30", settings.SHARE_TOLERANCE),
    ("rgb_near", "share with RGB distance <= 0.5", settings.SHARE_TOLERANCE),
)


def _around(name: str, measured: float, expected: float, tolerance: float) -> Claim:
    return Claim(name, measured, low=expected - tolerance, high=expected + tolerance)


STUDY: Final = Study(
    *heading(__package__), settings.SETTINGS, settings.SMOKE, compute, summarize, figures, compiles=False
)
