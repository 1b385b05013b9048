"""Table -> mean scores of all variants, what each part contributes, and a figure."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray
from scipy.special import stdtrit

from relforest.experiments.claims import Claim, Findings
from relforest.experiments.mil_ablation.settings import COMMITTEE, PUBLISHED, TITLES
from relforest.experiments.table import Table, aligned
from relforest.metrics import MeanInterval
from relforest.reports.style import BLUE, GREY, styled

# What the committee must not lose where the published algorithm is at home, in standard errors of the
# difference.
_TOLERATED = 2.0
_AT_HOME = ("covariant1", "covariant2")


def scores(table: Table, variant: str, data_set: str) -> NDArray[np.float64]:
    """Return the scores of a variant on the draws of a data set, (n_draws,)."""
    return table.where(variant=variant, data_set=data_set).numbers("pss")


def mean_over_sets(table: Table, variant: str) -> float:
    """Return the mean over the data sets of a variant's mean scores."""
    sets = map(str, table.distinct("data_set"))
    return float(np.mean([scores(table, variant, data_set).mean() for data_set in sets]))


def loss(table: Table, variant: str) -> MeanInterval:
    """Return by how much a variant is worse than the committee, averaged over the data sets.

    Both are compared draw by draw. The 95 % interval is that of a mean of independent means (Welch and
    Satterthwaite); it says nothing of other data sets than these.
    """
    sets = list(map(str, table.distinct("data_set")))
    differences = [scores(table, COMMITTEE, name) - scores(table, variant, name) for name in sets]
    variances = np.array([values.var(ddof=1) / len(values) for values in differences])
    freedom = np.array([len(values) - 1 for values in differences])
    mean = float(np.mean([values.mean() for values in differences]))
    half = 0.0
    if variances.any():
        together = variances.sum() ** 2 / (variances**2 / freedom).sum()
        half = float(stdtrit(together, 0.975) * np.sqrt(variances.sum()) / len(sets))
    return MeanInterval(mean, mean - half, mean + half, 0.95, len(sets))


def summarize(table: Table) -> Findings:
    """Compare every variant with the committee."""
    sets, variants = list(map(str, table.distinct("data_set"))), list(map(str, table.distinct("variant")))
    rows = []
    for variant in variants:
        worse = loss(table, variant)
        change = "" if variant == COMMITTEE else f"{-worse.mean:+.3f} +- {worse.half_width:.3f}"
        cells = [f"{scores(table, variant, name).mean():.2f}" for name in sets]
        rows.append((variant, f"{mean_over_sets(table, variant):.3f}", change, *cells))
    claims = [
        Claim(
            "mean PSS of the committee over the data sets, less that of CovAgg",
            mean_over_sets(table, COMMITTEE) - mean_over_sets(table, PUBLISHED),
            low=0.1,
        )
    ]
    for name in [name for name in _AT_HOME if name in sets]:
        difference = scores(table, COMMITTEE, name) - scores(table, PUBLISHED, name)
        error = float(difference.std(ddof=1) / len(difference) ** 0.5)
        claims.append(
            Claim(
                f"{TITLES[name]}: committee less CovAgg, at least 0 less two standard errors",
                float(difference.mean()),
                low=-_TOLERATED * error,
            )
        )
    text = (
        "Mean Peirce skill score over the data sets, the change that a variant makes to it (+- half the\n"
        "width of the 95 % interval), and the mean of each data set\n\n"
        + aligned(("variant", "mean", "change", *(TITLES[name] for name in sets)), rows)
    )
    return Findings(text, tuple(claims))


def figures(table: Table) -> Mapping[str, Figure]:
    """Draw the change that every variant makes, with its 95 % interval."""
    variants = [name for name in map(str, table.distinct("variant")) if name != COMMITTEE]
    with styled():
        figure = Figure(figsize=(6.0, 0.6 + 0.25 * len(variants)), layout="constrained")
        axes = figure.add_subplot()
        for place, variant in enumerate(variants):
            worse = loss(table, variant)
            axes.errorbar(-worse.mean, place, xerr=worse.half_width, fmt="o", color=BLUE)
        axes.axvline(0.0, color=GREY)
        axes.set_yticks(range(len(variants)), variants)
        axes.invert_yaxis()
        axes.set_xlabel("change of the mean Peirce skill score against the whole committee")
    return {"changes.png": figure}
