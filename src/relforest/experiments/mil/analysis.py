"""Table -> the tables of the source with its own numbers beside ours, some more, and the claims."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from operator import attrgetter
from typing import Final

from relforest.experiments.claims import Findings
from relforest.experiments.mil.bounds import exceptions, verdicts
from relforest.experiments.mil.data import DATA_SETS, HELD_OUT, unavailable
from relforest.experiments.mil.methods import COVAGG, IMPROVED, METHODS, OPTIMAL_BALL
from relforest.experiments.mil.pictures import figures
from relforest.experiments.mil.published import SCORES, TIMES
from relforest.experiments.mil.results import Result, Results, mark, means
from relforest.experiments.mil.run import compute
from relforest.experiments.mil.settings import N_COMPARISONS, SETTINGS, SMOKE
from relforest.experiments.registry import heading
from relforest.experiments.sheets import Entry, Estimate, Format, Sheet
from relforest.experiments.study import Study
from relforest.experiments.table import Table
from relforest.metrics import SampleMoments

_SOURCE: Final = "  source"
_MARKS: Final = (
    "Marks > and <: CovAgg's is significantly more or less than this one (two-sample t-test; at .05 where "
    f"the other is better, corrected for {N_COMPARISONS} comparisons where CovAgg is)"
)
_SCORE: Final = ".2f"
_MOST_DECIMALS: Final = 4

_Cells = Callable[[str, str, Result], Entry]


def summarize(table: Table) -> Findings:
    """Lay the results out beside the source's, and hold them against the bounds."""
    results = Results.of(table)
    limit = min(setting.cpu_limit for setting in SETTINGS)
    return Findings("", tuple(verdicts(results, limit)), tuple(_sheets(results)))


def seconds_format(seconds: float) -> str:
    """Return the format with three digits of what is above a second, and two of what is below."""
    if seconds <= 0 or math.isnan(seconds):
        return ".2f"
    power = math.floor(math.log10(seconds))
    return f".{max(2 - power, 0) if power >= 0 else min(1 - power, _MOST_DECIMALS)}f"


def _sheets(results: Results) -> Iterator[Sheet]:
    """Yield all tables that there is anything for."""
    constant = [name for name in results.methods if not METHODS[name].is_tuned]
    tuned = [name for name in results.methods if METHODS[name].is_tuned]

    def sheet(caption: str, methods: Sequence[str], form: Format, cell: _Cells, **source: _Source) -> Sheet:
        columns = {"": "", **{METHODS[name].title: form for name in methods}}
        return Sheet(caption, columns, tuple(_rows(results, methods, cell, **source)))

    def skill(data_set: str, method: str, result: Result) -> Entry:
        return _compared(results.get(data_set, COVAGG), method, result, lambda found: found.skill)

    def seconds(data_set: str, method: str, result: Result) -> Entry:
        ours = results.get(data_set, COVAGG)
        return _compared(ours, method, result, lambda found: found.seconds, is_cost=True)

    def ratio(data_set: str, _method: str, result: Result) -> Entry:
        base = results.get(data_set, OPTIMAL_BALL)
        if base is None or base.seconds is None:
            return None
        return math.nan if result.seconds is None else result.seconds.mean / base.seconds.mean

    yield _data_sheet(results)
    caption = f"Mean Peirce skill score and 95 % interval, constant parameters; -: stopped.\n{_MARKS}"
    yield sheet(caption, constant, _SCORE, skill, source=SCORES)
    if tuned:
        caption = "Mean Peirce skill score, parameters tuned on separate draws"
        yield sheet(caption, tuned, _SCORE, skill, source=SCORES)
        yield sheet("Tuned parameters: C, factor of the heuristic gamma", tuned, "", _parameters)
    caption = "Mean CPU seconds of training and prediction, 95 % interval; -: stopped"
    yield sheet(caption, constant, seconds_format, seconds, source=TIMES)
    if OPTIMAL_BALL in constant:
        yield sheet(f"CPU time in that of {METHODS[OPTIMAL_BALL].title}", constant, seconds_format, ratio)
    caption = "Peak memory of the process in MB, Python and libraries included"
    yield sheet(caption, results.methods, ".0f", lambda _set, _method, result: result.peak_bytes / 1e6)
    yield _mean_sheet(results, constant)
    if found := tuple(exceptions(results)):
        columns = {"": "", "ours": _SCORE, "source": _SCORE, "reason": ""}
        yield Sheet("Known differences from the source, without a claim", columns, found)


_Source = Mapping[tuple[str, str], Estimate]


def _rows(
    results: Results, methods: Sequence[str], cell: _Cells, source: _Source | None = None
) -> Iterator[tuple[Entry, ...]]:
    """Yield a row per data set with results of these methods, and another one with the source's."""
    for data_set in results.data_sets:
        found = {name: results.get(data_set, name) for name in methods}
        if any(found.values()):
            yield (
                DATA_SETS[data_set].title,
                *(result and cell(data_set, name, result) for name, result in found.items()),
            )
            if source is not None:
                yield (_SOURCE, *(source.get((data_set, name)) for name in methods))


def _compared(
    ours: Result | None,
    method: str,
    result: Result,
    moments: Callable[[Result], SampleMoments | None],
    *,
    is_cost: bool = False,
) -> Estimate:
    """Return a mean with its interval, marked where it differs from covariant aggregation's."""
    own = moments(result)
    if own is None:
        return Estimate(math.nan)
    other = None if method == COVAGG or ours is None else moments(ours)
    return Estimate(own.mean, own.interval().half_width or None, mark(other, own, is_cost=is_cost))


def _parameters(_data_set: str, _method: str, result: Result) -> Entry:
    chosen = result.facts["C"], result.facts["gamma_factor"]
    return None if chosen[0] is None else f"{chosen[0]:g}, {chosen[1]:g}"


def _data_sheet(results: Results) -> Sheet:
    rows = []
    for name in results.data_sets:
        found = (results.get(name, method) for method in results.methods)
        sizes = (result.facts for result in found if result is not None)
        for facts in [facts for facts in sizes if facts["n_bags"] is not None][:1]:
            bags, instances = float(facts["n_bags"] or 0), float(facts["n_instances"] or 0)
            counts = (facts["n_features"], facts["n_bags"], facts["n_positive"], facts["n_instances"])
            rows.append((DATA_SETS[name].title, *counts, instances / bags))
    caption = "Data sets (of a synthetic one: training and test set of the first draw)"
    columns = dict.fromkeys(("", "dimensions", "bags", "positive", "instances"), "")
    return Sheet(caption, {**columns, "per bag": ".1f"}, tuple(rows))


def _mean_sheet(results: Results, methods: Sequence[str]) -> Sheet:
    improved = METHODS[IMPROVED].title
    rows = []
    for method in methods:
        row: list[Entry] = [METHODS[method].title]
        for mean in (means(results, method), means(results, method, HELD_OUT)):
            numbers = (mean.with_zeros, mean.of_finished, mean.improved_on_finished)
            row += [mean.n_data_sets, mean.n_stopped]
            row += [None if math.isnan(number) else number for number in numbers]
        rows.append(tuple(row))
    caption = (
        "Mean over the data sets of mean Peirce skill scores, and over those held out: "
        f"{improved} was designed without them"
    )
    titles = (
        *("", "data sets", "stopped", "stopped ones as 0", "without these", f"{improved} on the same"),
        *("held out", "of these stopped", "these as 0", "the others", improved),
    )
    return Sheet(caption, dict.fromkeys(titles, ".3f"), tuple(rows))


STUDY: Final = Study(
    *heading(__package__),
    SETTINGS,
    SMOKE,
    compute,
    summarize,
    figures,
    compiles=False,
    choices={"methods": attrgetter("method"), "datasets": attrgetter("data_set")},
    unavailable=unavailable,
)
