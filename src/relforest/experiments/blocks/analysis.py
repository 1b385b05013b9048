"""Table -> our blocks world beside the author's simulator, and what must hold."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from relforest.experiments.blocks.samples import Mean, Samples
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
    SETTLE,
    SETTLE_REFERENCE,
    SETTLE_TOLERANCE,
    SHARE_TOLERANCE,
    SMALL_FIRST,
    SPEED,
    TOTAL_REFERENCE,
    TOWERS,
    TRAINER,
)
from relforest.experiments.claims import Claim, Findings
from relforest.experiments.table import Table, aligned

TASK_TITLES = {TOWERS: "high towers", GROUPS: "colour grouping", ARCHES: "arch"}

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
    parts = (
        f"Steps of 0.01 s until dropped blocks lie still\n{_settle_text(samples)}",
        f"Steps until a block, grasped at its centre, hangs still at a height of 20\n{_lift_text(samples)}",
        f"Options (95 % interval of the mean; durations in seconds)\n{_option_text(samples)}",
        f"Totals of an episode (95 % interval of the mean)\n{_total_text(samples)}",
        f"Distances of random pairs of colours\n{_color_text(samples)}",
        f"Outcome tasks: shares of scenes\n{_outcome_text(samples)}",
        f"CPU time of an episode of high towers, one thread\n{_speed_text(samples)}",
    )
    return Findings("\n\n".join(parts), tuple(_claims(samples)))


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


def _settle_text(samples: Samples) -> str:
    rows = []
    for scenario in SCENARIOS:
        references = {name: row for (blocks, name), row in SETTLE_REFERENCE.items() if blocks == scenario}
        for name, found in {"ours": settle_numbers(samples, scenario), **references}.items():
            whole = [f"{found[column]:.0f}" for column in ("n", "mean", "median", "p90", "max")]
            rows.append((f"{scenario}, {name}", *whole, f"{found['over']:.1%}", f"{found['height']:.3f}"))
    return aligned(("", "drops", "mean", "median", "90 %", "longest", "> 500", "mean height"), rows)


def _lift_text(samples: Samples) -> str:
    rows = [
        (size, f"{samples.mean((LIFT, size, 'steps')).value:.0f}", str(author), str(plain))
        for size, (author, plain) in LIFT_REFERENCE.items()
    ]
    return aligned(("half sizes", "ours", AUTHOR, "a plain port"), rows)


def _option_text(samples: Samples) -> str:
    rows = []
    for key, references in OPTION_REFERENCE.items():
        part, policy, measure = key
        found = samples[key]
        digits = 0 if measure == "episode_steps" else 2
        known = ["-" if np.isnan(number) else f"{number:.{digits}f}" for number in references]
        title = f"{TASK_TITLES[part]}, {policy}: {measure.replace('_', ' ')}"
        spread = f"{found.std(ddof=1):.{digits}f}" if len(found) > 1 else "-"
        rows.append((title, str(len(found)), samples.mean(key).text(digits), spread, *known))
    return aligned(("", "n", "ours", "sd", AUTHOR, "a plain port"), rows)


def _total_text(samples: Samples) -> str:
    rows = []
    for part, policies in POLICIES.items():
        for policy in policies:
            totals = samples[part, policy, "total"]
            spread = f"{totals.std(ddof=1):.2f}" if len(totals) > 1 else "-"
            reference = TOTAL_REFERENCE.get(policy, ("-", "-")) if part == TOWERS else ("-", "-")
            title = f"{TASK_TITLES[part]}, {policy}"
            rows.append((title, str(len(totals)), Mean.of(totals).text(), spread, *reference))
    lines = [aligned(("", "n", "ours", "sd", AUTHOR, "a plain port"), rows)]
    for policy in POLICIES[ARCHES]:
        stands = samples[ARCHES, policy, "stands"]
        scores = samples[ARCHES, policy, "total"][stands > 0]
        lines.append(
            f"arch, {policy}: {Mean.of(stands).text()} of the episodes end with an arch, "
            f"of mean score {Mean.of(scores).text(1)}"
        )
    return "\n".join(lines)


def _color_text(samples: Samples) -> str:
    titles = ("25 %", "median", "largest", "share <= 30", "RGB: 25 %", "share <= 0.5")
    rows = []
    for sampling, reference in COLOR_REFERENCE.items():
        ours = [samples.mean((COLORS, sampling, name)).value for name in reference]
        for name, numbers in (("ours", ours), ("expected", list(reference.values()))):
            shown = [f"{number:.1f}" if number > 1 else f"{number:.3f}" for number in numbers]
            rows.append((f"{sampling}, {name}", *shown))
    return aligned(("", *titles), rows)


def _outcome_text(samples: Samples) -> str:
    rows = []
    for task in OUTCOME_TASKS:
        decided, labels = samples[OUTCOMES, task, "decided"], samples[OUTCOMES, task, "label"]
        rows.append((task, str(len(decided)), Mean.of(decided).text(), Mean.of(labels).text()))
    return aligned(("", "scenes", "decided", "true among these"), rows)


def _speed_text(samples: Samples) -> str:
    rows = []
    for policy in samples.measured(SPEED, POLICIES[TOWERS], "milliseconds"):
        milliseconds = samples.mean((SPEED, policy, "milliseconds"))
        steps = samples.mean((SPEED, policy, "steps")).value
        rate = 1000 * steps / milliseconds.value
        rows.append((policy, milliseconds.text(1), f"{steps:.0f}", f"{rate:,.0f}"))
    return aligned(("", "milliseconds", "steps", "steps a second"), rows)


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
        yield Claim(name, gain.value - gain.error, low=0.0)
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
