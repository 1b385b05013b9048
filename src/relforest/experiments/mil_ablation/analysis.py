"""Table -> mean scores of all variants, what each part contributes, and a figure."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from operator import attrgetter
from typing import Final

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray
from scipy.special import stdtrit

from relforest.experiments.claims import Claim, Findings
from relforest.experiments.mil_ablation.run import compute
from relforest.experiments.mil_ablation.settings import (
    COMMITTEE,
    MODELLED,
    PUBLISHED,
    SETTINGS,
    SMOKE,
    TITLES,
)
from relforest.experiments.registry import heading
from relforest.experiments.sheets import Entry, Estimate, Sheet
from relforest.experiments.study import Study
from relforest.experiments.table import Table
from relforest.reports.style import BLUE, GREY, styled

# What the committee must not lose where the published algorithm is at home, in standard errors of the
# difference.
_TOLERATED = 2.0
_AT_HOME = ("covariant1", "covariant2")


def scores(table: Table, variant: str, data_set: str) -> NDArray[np.float64]:
    """Return the scores of a variant on the draws of a data set, (n_draws,)."""
    return table.where(variant=variant, data_set=data_set).numbers("pss")


def mean_over_sets(table: Table, variant: str, data_sets: Sequence[str]) -> float:
    """Return the mean over data sets of a variant's mean scores."""
    return float(np.mean([scores(table, variant, data_set).mean() for data_set in data_sets]))


def change(table: Table, variant: str, data_sets: Sequence[str]) -> Estimate:
    """Return how much better a variant is than the committee, averaged over data sets.

    Both are compared draw by draw. The 95 % interval is that of a mean of independent means (Welch and
    Satterthwaite). It takes draws as independent, which folds of Musk 1 are not quite, as they share bags;
    and it says nothing of other data sets than these.
    """
    differences = [scores(table, variant, name) - scores(table, COMMITTEE, name) for name in data_sets]
    variances = np.array([values.var(ddof=1) / len(values) for values in differences])
    freedom = np.array([len(values) - 1 for values in differences])
    half = 0.0
    if variances.any():
        together = variances.sum() ** 2 / (variances**2 / freedom).sum()
        half = float(stdtrit(together, 0.975) * np.sqrt(variances.sum()) / len(data_sets))
    return Estimate(float(np.mean([values.mean() for values in differences])), half)


def summarize(table: Table) -> Findings:
    """Compare every variant with the committee."""
    sets, variants = _names(table, "data_set"), _names(table, "variant")
    others = [name for name in sets if name not in MODELLED]
    blocks = {"": sets, "*": others} if 0 < len(others) < len(sets) else {"": sets}
    rows = []
    for variant in variants:
        row: list[Entry] = [variant]
        for block in blocks.values():
            is_other = variant != COMMITTEE
            row += [
                mean_over_sets(table, variant, block),
                change(table, variant, block) if is_other else None,
            ]
        rows.append((*row, *(float(scores(table, variant, name).mean()) for name in sets)))
    caption = (
        "Mean Peirce skill score over the data sets, the change that a variant makes to it (+- half the\n"
        "width of the 95 % interval), and the mean of each data set"
    )
    if len(blocks) > 1:
        left_out = ", ".join(TITLES[name] for name in sets if name in MODELLED)
        caption += f"\n*: without the sets modelled on published ones ({left_out})"
    columns = {"variant": ""}
    for sign in blocks:
        columns |= {f"mean{sign}": ".3f", f"change{sign}": "+.3f"}
    columns |= {TITLES[name]: ".2f" for name in sets}
    return Findings("", tuple(_claims(table, sets)), (Sheet(caption, columns, tuple(rows)),))


def _names(table: Table, column: str) -> list[str]:
    return list(map(str, table.distinct(column)))


def _claims(table: Table, sets: Sequence[str]) -> Iterator[Claim]:
    gain = mean_over_sets(table, COMMITTEE, sets) - mean_over_sets(table, PUBLISHED, sets)
    yield Claim(f"mean PSS of the committee over {len(sets)} data sets, less that of CovAgg", gain, low=0.1)
    for name in _AT_HOME:
        claim = f"{TITLES[name]}: committee less CovAgg, at least 0 less two standard errors"
        if name not in sets:
            yield Claim(claim, missing=(TITLES[name],))
            continue
        difference = scores(table, COMMITTEE, name) - scores(table, PUBLISHED, name)
        error = float(difference.std(ddof=1) / len(difference) ** 0.5)
        yield Claim(claim, float(difference.mean()), low=-_TOLERATED * error)


def figures(table: Table) -> Mapping[str, Figure]:
    """Draw the change that every variant makes, with its 95 % interval."""
    sets = _names(table, "data_set")
    variants = [name for name in _names(table, "variant") if name != COMMITTEE]
    with styled():
        figure = Figure(figsize=(6.0, 0.6 + 0.25 * len(variants)), layout="constrained")
        axes = figure.add_subplot()
        for place, variant in enumerate(variants):
            found = change(table, variant, sets)
            axes.errorbar(found.value, place, xerr=found.spread, fmt="o", color=BLUE)
        axes.axvline(0.0, color=GREY)
        axes.set_yticks(range(len(variants)), variants)
        axes.invert_yaxis()
        axes.set_xlabel("change of the mean Peirce skill score against the whole committee")
    return {"changes.png": figure}


STUDY: Final = Study(
    *heading(__package__),
    SETTINGS,
    SMOKE,
    compute,
    summarize,
    figures,
    choices={"datasets": attrgetter("data_set")},
)
