"""Table -> scores next to the source's, claims, and a figure of both."""

from __future__ import annotations

from collections.abc import Mapping

from matplotlib.figure import Figure

from relforest.experiments.claims import Claim, Findings
from relforest.experiments.covagg.settings import EXPECTED, TITLES
from relforest.experiments.table import Table, aligned
from relforest.metrics import MeanInterval, mean_interval
from relforest.reports.style import BLUE, GREY, styled


def scores(table: Table) -> dict[str, MeanInterval]:
    """Return the mean score of each data set and its 95 % interval (Student's t)."""
    return {
        str(data_set): mean_interval(table.where(data_set=data_set).numbers("pss"))
        for data_set in table.distinct("data_set")
    }


def standard_error(table: Table, data_set: str) -> float:
    """Return the standard error of the mean score of a data set."""
    pss = table.where(data_set=data_set).numbers("pss")
    return float(pss.std(ddof=1) / len(pss) ** 0.5)


def summarize(table: Table) -> Findings:
    """Compare ours with the source's scores and with the thresholds."""
    rows, claims = [], []
    for data_set, score in scores(table).items():
        expected, error = EXPECTED[data_set], standard_error(table, data_set)
        rows.append(
            (
                TITLES[data_set],
                f"{score.mean:.3f} +- {score.half_width:.3f}",
                f"{error:.3f}",
                f"{expected.source:.2f} +- {expected.half_width:.2f}",
                f"{expected.threshold:.2f}",
            )
        )
        name = f"{TITLES[data_set]}: mean PSS, at least {expected.threshold:.2f} less one standard error"
        claims.append(Claim(name, score.mean, low=expected.threshold - error))
    counts = ", ".join(str(score.count) for score in scores(table).values())
    text = (
        f"Mean Peirce skill score of covariant aggregation on {counts} pairs of training and test sets\n"
        "(+- half the width of the 95 % interval)\n\n"
        + aligned(("data set", "relforest", "std. error", "Table 3.2", "threshold"), rows)
    )
    return Findings(text, tuple(claims))


def figures(table: Table) -> Mapping[str, Figure]:
    """Draw our mean scores and the source's, each with its 95 % interval."""
    with styled():
        figure = Figure(figsize=(6.0, 2.6), layout="constrained")
        axes = figure.add_subplot()
        for place, (data_set, score) in enumerate(scores(table).items()):
            expected = EXPECTED[data_set]
            ours, source = ("relforest", "Palmer (2015), Table 3.2") if place == 0 else (None, None)
            axes.errorbar(score.mean, place - 0.12, xerr=score.half_width, fmt="o", color=BLUE, label=ours)
            axes.errorbar(
                expected.source, place + 0.12, xerr=expected.half_width, fmt="s", color=GREY, label=source
            )
        titles = [TITLES[name] for name in scores(table)]
        axes.set_yticks(range(len(titles)), titles)
        axes.invert_yaxis()
        axes.set_xlim(0, 1)
        axes.set_xlabel("mean Peirce skill score on test bags")
        axes.legend(loc="upper center", bbox_to_anchor=(0.5, 1.2), ncols=2)
    return {"scores.png": figure}
