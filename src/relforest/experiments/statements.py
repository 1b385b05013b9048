"""What the source says about its runs, judged by ours: statements, and tests between samples of runs."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Final, TypeAlias, final

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from relforest.experiments.sheets import Entry, Sheet
from relforest.experiments.table import Table

LEVEL: Final = 0.05
_FEWEST: Final = 2

Values: TypeAlias = NDArray[np.float64]
Sample: TypeAlias = Callable[[Table], Values]
"""Takes a number per run from the rows of a study, (runs,); none if these runs were not made."""


@final
@dataclass(frozen=True, slots=True)
class Judgement:
    """What our runs say about a statement.

    Parameters
    ----------
    ours : str
        Our numbers, in words.
    holds : bool
    p : float
        Of the test that was made; NaN if there was none.
    improves : float
        Probability that a run of the first sample has more than one of the second; NaN without two samples.
    """

    ours: str
    holds: bool
    p: float = math.nan
    improves: float = math.nan


Judge: TypeAlias = Callable[[Table], Judgement | None]
"""Judges a statement by the rows of a study; None if the runs that it is about were not made."""


@final
@dataclass(frozen=True, slots=True)
class Statement:
    """A sentence of the source about its experiments.

    Parameters
    ----------
    section : str
        Where it is, such as ``"7.4.1"``.
    words : str
    source : str
        The source's number.
    judge : callable
        Turns the rows of a study into a judgement, or None.
    """

    section: str
    words: str
    source: str
    judge: Judge


def statements_sheet(statements: Iterable[Statement], table: Table) -> Sheet:
    """Judge statements by the rows of a study."""
    caption = (
        "What the source says, and what is found here: interquartile means (runs), how likely a run of the\n"
        "first sample is above one of the second, and p of one-tailed t-tests over runs"
    )
    columns = {"the source says": "", "source": "", "here": "", "improves": ".2f", "p": ".1e", "verdict": ""}
    return Sheet(caption, columns, tuple(_row(each, each.judge(table)) for each in statements))


def above(one: Sample, other: Sample) -> Judge:
    """Return the judge of "the mean of one sample is above that of another one"."""
    return _compared(one, other, lambda p: p < LEVEL)


def not_above(one: Sample, other: Sample, level: float = LEVEL) -> Judge:
    """Return the judge of "the mean of one sample is not significantly above that of another one"."""
    return _compared(one, other, lambda p: p >= level)


def reached(one: Sample, other: Sample, bound: Callable[[Values], float]) -> Judge:
    """Return the judge of "the best run of one sample reaches a bound of another one", such as its mean."""

    def judge(table: Table) -> Judgement | None:
        values, others = one(table), other(table)
        if not min(len(values), len(others)):
            return None
        best, level = float(values.max()), float(bound(others))
        return Judgement(f"{best:.4g} / {level:.4g}", best >= level)

    return judge


def correlated(pairs: Callable[[Table], tuple[Values, Values]]) -> Judge:
    """Return the judge of "these numbers are correlated positively", by Pearson's coefficient."""

    def judge(table: Table) -> Judgement | None:
        one, other = pairs(table)
        if len(one) <= _FEWEST or not one.std() or not other.std():
            return None
        found = stats.pearsonr(one, other, alternative="greater")
        return Judgement(f"R = {found.statistic:.2f} ({len(one)})", bool(found.pvalue < LEVEL), found.pvalue)

    return judge


def interquartile_mean(values: Values) -> float:
    """Return the mean of the middle half of (n,) values."""
    return float(stats.trim_mean(values, 0.25))


def improvement(one: Values, other: Values) -> float:
    """Return how often a value of one sample is above one of another, pair by pair; ties count half."""
    lead = one[:, np.newaxis] - other
    return float((lead > 0.0).mean() + (lead == 0.0).mean() / 2)


def greater_p(sample: Values, other: Values) -> float:
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


def _compared(one: Sample, other: Sample, holds: Callable[[float], bool]) -> Judge:
    def judge(table: Table) -> Judgement | None:
        both = one(table), other(table)
        if min(map(len, both)) < _FEWEST:
            return None
        ours = " / ".join(f"{interquartile_mean(each):.4g} ({len(each)})" for each in both)
        p = greater_p(*both)
        return Judgement(ours, holds(p), p, improvement(*both))

    return judge


def _row(statement: Statement, found: Judgement | None) -> tuple[Entry, ...]:
    said = f"{statement.section} {statement.words}", statement.source
    if found is None:
        return *said, None, None, None, "not run"
    numbers = (None if math.isnan(number) else number for number in (found.improves, found.p))
    return *said, found.ours, *numbers, "holds" if found.holds else "does not hold"
