"""Table -> mean rewards and leaves, t-tests as in the source, claims, and Figures 7.2 to 7.4."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, Final

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray
from scipy import stats

from relforest.experiments.claims import Claim, Findings
from relforest.experiments.corridor import settings
from relforest.experiments.corridor.run import compute, learned
from relforest.experiments.registry import heading
from relforest.experiments.sheets import Entry, Estimate, Sheet
from relforest.experiments.study import Study
from relforest.experiments.table import Table
from relforest.reports.learning_figure import leaves_figure, reward_figure

_FAST, _SLOW, _BITS = settings.CONDITIONS


def values(table: Table, condition: str, iteration: int, column: str) -> NDArray[np.float64]:
    """Return a column of all runs of a condition after an iteration, (runs,); -1 = the last iteration."""
    own = table.where(condition=condition)
    wanted = int(own.numbers("iteration").max()) if iteration < 0 else iteration
    return own.where(iteration=wanted).numbers(column)


def greater_p(sample: NDArray[np.float64], other: NDArray[np.float64]) -> float:
    """Return the p-value of the one-tailed two-sample t-test of "the first mean is greater".

    Samples without any spread, for which the test is undefined, give 0 or 1 by their means.
    """
    described = [(float(x.mean()), float(x.std(ddof=1)), len(x)) for x in (sample, other)]
    (mean, deviation, _), (other_mean, other_deviation, _) = described
    if deviation == other_deviation == 0.0:
        return float(mean <= other_mean)
    # From the moments, because SciPy warns of lost precision where one sample is constant.
    found = stats.ttest_ind_from_stats(*described[0], *described[1], alternative="greater")
    return float(found.pvalue)


def below_p(sample: NDArray[np.float64], bound: float) -> float:
    """Return the p-value of the one-tailed one-sample t-test of "the mean is below the bound"."""
    deviation = float(sample.std(ddof=1))
    if deviation == 0.0:
        return float(sample.mean() >= bound)
    return float(stats.t.cdf((sample.mean() - bound) / deviation * len(sample) ** 0.5, len(sample) - 1))


def summarize(table: Table) -> Findings:
    """State means and spreads by iteration, the source's comparisons, and the claims."""
    claims = [
        Claim(
            f"{settings.CONDITIONS[condition]}: mean test reward after iteration {iteration}",
            float(values(table, condition, iteration, "test_reward").mean()),
            low=threshold,
        )
        for (condition, iteration), threshold in settings.THRESHOLDS.items()
        if _has(table, condition, iteration)
    ]
    rewards, leaves = (
        greater_p(values(table, one, -1, column), values(table, other, -1, column))
        for one, other, column in ((_SLOW, _BITS, "test_reward"), (_BITS, _SLOW, "leaves"))
    )
    claims += [
        Claim("bits only: p of a lower reward than with densities, at the end", rewards, low=settings.ALPHA),
        Claim("bits only: p of more leaves than with densities, at the end", leaves, high=settings.ALPHA),
    ]
    n_runs = len(table.where(condition=_FAST).distinct("run"))
    spread = "mean +- standard deviation across runs"
    text = f"Corridor: {n_runs} runs per condition ({spread}; optimum {settings.OPTIMUM})"
    tests = tuple(_tests(table, rewards, leaves))
    sheets = (
        _sheet(table, "test_reward", ".2f"),
        _sheet(table, "leaves", ".1f"),
        Sheet("One-tailed t-tests", {"": "", "p": ".2g", "source": ""}, tests),
    )
    return Findings(text, tuple(claims), sheets)


def figures(table: Table) -> Mapping[str, Figure]:
    """Draw rewards by number of episodes, then rewards and leaves by features."""
    by_episodes = {"500 episodes": _runs(table, _FAST), "10 episodes": _runs(table, _SLOW)}
    by_features = {"densities and bits": _runs(table, _SLOW), "bits only": _runs(table, _BITS)}
    return {
        "figure-7.2.png": reward_figure(by_episodes, title="corridor", optimum=settings.OPTIMUM),
        "figure-7.3.png": reward_figure(by_features, title="corridor, 10 episodes", optimum=settings.OPTIMUM),
        "figure-7.4.png": leaves_figure(by_features, title="corridor, 10 episodes"),
    }


def _has(table: Table, condition: str, iteration: int) -> bool:
    return iteration in table.where(condition=condition).distinct("iteration")


def _runs(table: Table, condition: str) -> list[list[Mapping[str, Any]]]:
    own = table.where(condition=condition)
    return [list(own.where(run=run).rows) for run in own.distinct("run")]


def _sheet(table: Table, column: str, form: str) -> Sheet:
    rows: list[tuple[Entry, ...]] = []
    for iteration in np.unique(table.numbers("iteration")).astype(int).tolist():
        row: list[Entry] = [iteration]
        for condition in map(str, table.distinct("condition")):
            found = values(table, condition, iteration, column) if _has(table, condition, iteration) else None
            row.append(None if found is None else Estimate(float(found.mean()), float(found.std(ddof=1))))
        rows.append(tuple(row))
    titles = (settings.CONDITIONS[str(name)] for name in table.distinct("condition"))
    return Sheet(column, {"iteration": "", **dict.fromkeys(titles, form)}, tuple(rows))


def _tests(table: Table, rewards: float, leaves: float) -> Iterator[tuple[Entry, ...]]:
    p_optimum = below_p(values(table, _FAST, -1, "test_reward"), settings.OPTIMUM)
    first = greater_p(values(table, _FAST, 1, "test_reward"), values(table, _SLOW, 1, "test_reward"))
    end = "10 episodes, at the end"
    yield "500 episodes, at the end: reward below the optimum", p_optimum, "not significant"
    yield "after iteration 1: reward with 500 episodes above that with 10", first, None
    yield f"{end}: reward of bits below that of densities", rewards, f"< {settings.SOURCE_REWARD_P}"
    yield f"{end}: leaves of bits above those of densities", leaves, f"< {settings.SOURCE_LEAVES_P}"
    for condition, title in settings.CONDITIONS.items():
        before, after = (values(table, condition, iteration, "test_reward") for iteration in (0, -1))
        yield f"{title}: reward at the end above that before", greater_p(after, before), None


STUDY: Final = Study(
    *heading(__package__),
    settings.SETTINGS,
    settings.SMOKE,
    compute,
    summarize,
    figures,
    learned=learned,
)
