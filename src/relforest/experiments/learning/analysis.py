"""Table -> what the source says, rewards by training episodes and method, and claims."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from functools import partial
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from relforest.experiments.claims import Claim, Findings
from relforest.experiments.learning import settings
from relforest.experiments.learning.figures import figures
from relforest.experiments.learning.run import compute, learned, unavailable
from relforest.experiments.learning.settings import LearningSetting
from relforest.experiments.learning.statements import STATEMENTS, measured
from relforest.experiments.registry import question_of
from relforest.experiments.sheets import Entry, Sheet, Span
from relforest.experiments.statements import interquartile_mean, statements_sheet
from relforest.experiments.study import Study, repeated
from relforest.experiments.table import Table

_DRAWS: Final = 5000
_FEW: Final = 3


def interval(values: NDArray[np.float64]) -> Span | None:
    """Return the 95 % bootstrap interval of the interquartile mean of (n,) values; None for fewer than 3."""
    if len(values) < _FEW:
        return None
    draws = np.random.default_rng(0).choice(values, (_DRAWS, len(values)))
    low, high = np.percentile(stats.trim_mean(draws, 0.25, axis=1), (2.5, 97.5)).tolist()
    return Span(low, high)


def summarize(task: str, table: Table) -> Findings:
    """State what the source says and is found here, rewards by method and episodes, and the goals reached."""
    titles = {"condition": "", "episodes": "", "runs": "", "mean": _form(task)}
    titles |= dict.fromkeys(("interquartile mean", "95 %", "least", "most"), _form(task))
    sheets = [statements_sheet(STATEMENTS[task], table)]
    for played in table.distinct("played"):
        rows = tuple(_rows(table, str(played)))
        sheets.append(Sheet(f"Reward per episode in {played}, learned in {task}", titles, rows))
    return Findings("", tuple(_claims(task, table)), tuple(sheets))


def _rows(table: Table, played: str) -> Iterator[tuple[Entry, ...]]:
    own = table.where(played=played)
    for condition in map(str, own.distinct("condition")):
        for episodes in np.unique(own.where(condition=condition).numbers("episodes")).astype(int).tolist():
            found = measured(table, played, condition, episodes)
            ends = (float(found.min()), float(found.max()))
            middle = interquartile_mean(found)
            yield condition, episodes, len(found), float(found.mean()), middle, interval(found), *ends


def _claims(task: str, table: Table) -> Iterator[Claim]:
    ours, hand = settings.OURS, settings.HAND[task]
    found = partial(measured, table)
    for episodes, goal in settings.GOALS[task].items():
        name = f"{ours}: mean reward after {episodes} episodes"
        if len(own := found(task, ours, episodes)):
            yield Claim(name, float(own.mean()), low=goal)
        else:
            yield Claim(name, low=goal, missing=("so long a run",))
    if task in settings.LEAST and len(own := found(task, ours, settings.LEAST[task][0])):
        episodes, goal = settings.LEAST[task]
        yield Claim(f"{ours}: least reward of a run after {episodes} episodes", float(own.min()), low=goal)
    for episodes in settings.GOALS[task]:
        both = found(task, ours, episodes), found(task, settings.LINEAR, episodes)
        if min(map(len, both)) > 1:
            p = float(stats.ttest_ind(*both, equal_var=False, alternative="greater").pvalue)
            name = f"{ours}: p of no more reward than {settings.LINEAR} after {episodes} episodes"
            yield Claim(name, p, high=0.05)
    if len(found(task, hand, 0)):
        yield from _AGAINST_HAND[task](table)


def _keepaway_claims(table: Table) -> Iterator[Claim]:
    found, ours, end, task = partial(measured, table), settings.OURS, 1000, settings.KEEPAWAY
    if not len(own := found(task, ours, end)):
        return
    for other, episodes in ((settings.HAND[task], 0), (settings.SARSA, 6000)):
        if len(level := found(task, other, episodes)):
            name = f"{ours}: least reward of a run after {end} episodes, bound: {other}"
            yield Claim(
                name + (f" after {episodes}" if episodes else ""), float(own.min()), low=float(level.mean())
            )
    for larger in settings.LARGER:
        if len(there := found(larger, ours, end)):
            low = settings.TRANSFER.get(larger, float(found(larger, settings.HAND[task], 0).mean()))
            yield Claim(
                f"{ours}: mean reward in {larger} without learning there", float(there.mean()), low=low
            )


def _tower_claims(table: Table) -> Iterator[Claim]:
    ours, hand, end = settings.OURS, settings.HAND[settings.TOWERS], 1000
    own, level = (measured(table, settings.TOWERS, *each) for each in ((ours, end), (hand, 0)))
    if len(own) == len(level):
        # Run by run, both have played the same draws.
        p = float(stats.ttest_rel(own, level, alternative="greater").pvalue)
        yield Claim(f"{ours}: p of no more reward than {hand} after {end} episodes", p, high=0.05)


def _arch_claims(table: Table) -> Iterator[Claim]:
    end = 3000
    name = f"{settings.OURS}: share of test episodes that end with an arch after {end} episodes"
    if len(measured(table, settings.ARCH, settings.OURS, end)):
        rows = table.where(played=settings.ARCH, condition=settings.OURS, episodes=end)
        yield Claim(name, float(rows.numbers("paid").mean()), low=settings.STANDING)
    else:
        yield Claim(name, low=settings.STANDING, missing=("so long a run",))
    yield from _mean_claim(table, settings.ARCH, 1500)


def _mean_claim(table: Table, task: str, end: int) -> Iterator[Claim]:
    ours, hand = settings.OURS, settings.HAND[task]
    own, level = (measured(table, task, *each) for each in ((ours, end), (hand, 0)))
    if len(own):
        name = f"{ours}: mean reward after {end} episodes, bound: {hand}"
        yield Claim(name, float(own.mean()), low=float(level.mean()))


_AGAINST_HAND: Final[Mapping[str, Callable[[Table], Iterator[Claim]]]] = {
    settings.KEEPAWAY: _keepaway_claims,
    settings.TOWERS: _tower_claims,
    settings.COLORS: partial(_mean_claim, task=settings.COLORS, end=2000),
    settings.ARCH: _arch_claims,
}


def _form(task: str) -> str:
    return ".1f" if task == settings.KEEPAWAY else ".2f"


def _study(name: str, task: str) -> Study[LearningSetting]:
    return Study(
        name,
        question_of(name),
        settings.SETTINGS[task],
        settings.SMOKE[task],
        compute,
        partial(summarize, task),
        partial(figures, task),
        choices={"methods": lambda setting: setting.condition},
        sizes={"runs": repeated, "iterations": LearningSetting.longer, "episodes": LearningSetting.larger},
        unavailable=unavailable,
        learned=learned,
    )


KEEPAWAY: Final = _study("keepaway-learning", settings.KEEPAWAY)
TOWERS: Final = _study("high-towers-learning", settings.TOWERS)
COLORS: Final = _study("color-learning", settings.COLORS)
ARCH: Final = _study("arch-learning", settings.ARCH)
