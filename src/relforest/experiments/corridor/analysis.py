"""Table -> mean rewards and leaves, the source's statements, claims, and Figures 7.2 to 7.4."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from functools import partial
from typing import Any, Final

import numpy as np
from matplotlib.figure import Figure
from scipy import stats

from relforest.experiments.claims import Claim, Findings
from relforest.experiments.corridor import settings
from relforest.experiments.corridor.run import compute, learned
from relforest.experiments.registry import heading
from relforest.experiments.sheets import Entry, Estimate, Sheet
from relforest.experiments.statements import (
    LEVEL,
    Judge,
    Judgement,
    Sample,
    Statement,
    Values,
    above,
    greater_p,
    not_above,
    statements_sheet,
)
from relforest.experiments.study import Study, repeated
from relforest.experiments.table import Table
from relforest.reports.learning_figure import leaves_figure, reward_figure
from relforest.rl.settings import RPISettings

_FAST, _SLOW, _BITS, _UNTESTED = settings.CONDITIONS
_ACTIONS: Final = 2


def values(table: Table, condition: str, iteration: int, column: str) -> Values:
    """Return a column of all runs of a condition after an iteration, (runs,), maybe none; -1 = the last."""
    own = [row for row in table.rows if row["condition"] == condition]
    wanted = max((int(row["iteration"] or 0) for row in own), default=0) if iteration < 0 else iteration
    return np.array([row[column] for row in own if row["iteration"] == wanted], dtype=np.float64)


def below_p(sample: Values, bound: float) -> float:
    """Return the p-value of the one-tailed one-sample t-test of "the mean is below the bound"."""
    deviation = float(sample.std(ddof=1))
    if deviation == 0.0:
        return float(sample.mean() >= bound)
    return float(stats.t.cdf((sample.mean() - bound) / deviation * len(sample) ** 0.5, len(sample) - 1))


def _sample(condition: str, iteration: int = -1, column: str = "test_reward") -> Sample:
    return partial(values, condition=condition, iteration=iteration, column=column)


def _optimal(iteration: int) -> Judge:
    """Return the judge of "the mean reward is not significantly below the optimum"."""

    def judge(table: Table) -> Judgement | None:
        rewards = values(table, _FAST, iteration, "test_reward")
        if len(rewards) < 2:
            return None
        p = below_p(rewards, settings.OPTIMUM)
        return Judgement(f"{rewards.mean():.4g} / {settings.OPTIMUM} ({len(rewards)})", p >= LEVEL, p)

    return judge


def _endless(table: Table) -> Judgement | None:
    """Judge "every round adds trees, up to the limit of rounds"; a round adds one for each action at most."""
    trees, limit = values(table, _UNTESTED, 1, "trees"), RPISettings().max_rounds
    if not len(trees):
        return None
    least = int(trees.min())
    return Judgement(f"{least} trees in {limit} rounds ({len(trees)})", least > _ACTIONS * (limit - 1))


STATEMENTS: Final = (
    *(
        Statement("7.3.2", f"500 episodes, {when}: reward not below the optimum", "p < .5", _optimal(number))
        for when, number in (("one batch", 1), ("in the end", -1))
    ),
    Statement(
        "7.3.2",
        "one batch: 500 episodes give more reward than 10",
        "Figure 7.2",
        above(_sample(_FAST, 1), _sample(_SLOW, 1)),
    ),
    Statement(
        "7.3.2",
        "10 episodes, in the end: densities do not give more reward than bits alone",
        "p < .5",
        not_above(_sample(_SLOW), _sample(_BITS)),
    ),
    Statement(
        "7.3.2",
        "10 episodes, in the end: bits alone need more leaves",
        "p < 1e-11",
        above(_sample(_BITS, column="leaves"), _sample(_SLOW, column="leaves")),
    ),
    Statement("7.3.2", "500 episodes, trees untested: rounds add trees without end", "no end", _endless),
)
"""What the source says about the corridor."""


def summarize(table: Table) -> Findings:
    """State means and spreads by iteration, the source's statements, and the claims."""
    n_runs = max(len(runs.distinct("run")) for runs in table.groups("condition").values())
    spread = "mean +- standard deviation across runs"
    text = f"Corridor: {n_runs} runs per condition ({spread}; optimum {settings.OPTIMUM})"
    sheets = (
        statements_sheet(STATEMENTS, table),
        _sheet(table, "test_reward", ".2f"),
        _sheet(table, "leaves", ".1f"),
    )
    return Findings(text, tuple(_claims(table)), sheets)


def figures(table: Table) -> Mapping[str, Figure]:
    """Draw rewards by number of episodes, then rewards and leaves by features."""
    by_episodes = {"500 episodes": _runs(table, _FAST), "10 episodes": _runs(table, _SLOW)}
    by_features = {"densities and bits": _runs(table, _SLOW), "bits only": _runs(table, _BITS)}
    return {
        "figure-7.2.png": reward_figure(by_episodes, title="corridor", optimum=settings.OPTIMUM),
        "figure-7.3.png": reward_figure(by_features, title="corridor, 10 episodes", optimum=settings.OPTIMUM),
        "figure-7.4.png": leaves_figure(by_features, title="corridor, 10 episodes"),
    }


def _claims(table: Table) -> Iterator[Claim]:
    for (condition, iteration), threshold in settings.THRESHOLDS.items():
        if len(found := values(table, condition, iteration, "test_reward")):
            name = f"{settings.CONDITIONS[condition]}: mean test reward after iteration {iteration}"
            yield Claim(name, float(found.mean()), low=threshold)
    densities, bits = (
        [values(table, condition, -1, column) for column in ("test_reward", "leaves")]
        for condition in (_SLOW, _BITS)
    )
    if min(len(densities[0]), len(bits[0])) > 1:
        p_reward, p_leaves = greater_p(densities[0], bits[0]), greater_p(bits[1], densities[1])
        end = "than with densities, at the end"
        yield Claim(f"bits only: p of a lower reward {end}", p_reward, low=LEVEL)
        yield Claim(f"bits only: p of more leaves {end}", p_leaves, high=LEVEL)


def _runs(table: Table, condition: str) -> list[list[Mapping[str, Any]]]:
    own = table.where(condition=condition)
    return [list(own.where(run=run).rows) for run in own.distinct("run")]


def _sheet(table: Table, column: str, form: str) -> Sheet:
    rows: list[tuple[Entry, ...]] = []
    for iteration in np.unique(table.numbers("iteration")).astype(int).tolist():
        row: list[Entry] = [iteration]
        for condition in map(str, table.distinct("condition")):
            found = values(table, condition, iteration, column)
            deviation = float(found.std(ddof=1)) if len(found) > 1 else None
            row.append(Estimate(float(found.mean()), deviation) if len(found) else None)
        rows.append(tuple(row))
    titles = (settings.CONDITIONS[str(name)] for name in table.distinct("condition"))
    return Sheet(column, {"iteration": "", **dict.fromkeys(titles, form)}, tuple(rows))


STUDY: Final = Study(
    *heading(__package__),
    settings.SETTINGS,
    settings.SMOKE,
    compute,
    summarize,
    figures,
    sizes={
        "runs": repeated,
        "iterations": lambda setting, number: (replace(setting, iterations=number),),
        "episodes": lambda setting, number: (replace(setting, episodes=number),),
    },
    learned=learned,
)
