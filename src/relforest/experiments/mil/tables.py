"""Results -> the tables of the source with its own numbers beside ours, and some more."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence

import numpy as np

from relforest.experiments.mil.cells import Result, Results, mark
from relforest.experiments.mil.data import DATA_SETS, HELD_OUT
from relforest.experiments.mil.means import Mean, means
from relforest.experiments.mil.methods import COVAGG, IMPROVED, METHODS, OPTIMAL_BALL
from relforest.experiments.mil.published import SCORES, TIMES, Published
from relforest.experiments.mil.settings import N_COMPARISONS
from relforest.experiments.mil.sheets import (
    Sheet,
    published_score,
    published_time,
    score_text,
    time_decimals,
    time_text,
)

_SOURCE = "  source"
_MARKS = (
    "Marks > and <: CovAgg's is significantly more or less than this one (two-sample t-test; at .05 where "
    f"the other is better, corrected for {N_COMPARISONS} comparisons where CovAgg is)"
)


def sheets(results: Results) -> Iterator[Sheet]:
    """Yield all tables that there is anything for."""
    constant = [name for name in results.methods if not METHODS[name].is_tuned]
    tuned = [name for name in results.methods if METHODS[name].is_tuned]
    yield _data_sheet(results)
    yield _score_sheet(
        results,
        constant,
        f"Mean Peirce skill score and 95 % interval, constant parameters; -: stopped.\n{_MARKS}",
    )
    if tuned:
        yield _score_sheet(results, tuned, "Mean Peirce skill score, parameters tuned on separate draws")
        yield _parameter_sheet(results, tuned)
    yield _time_sheet(results, constant)
    if OPTIMAL_BALL in constant:
        yield _ratio_sheet(results, constant)
    yield _memory_sheet(results, results.methods)
    yield _mean_sheet(results)


def _titles(methods: Sequence[str]) -> tuple[str, ...]:
    return ("", *(METHODS[name].title for name in methods))


def _data_sheet(results: Results) -> Sheet:
    rows = []
    for name in results.data_sets:
        facts = _facts(results, name)
        if facts is not None:
            bags, instances = facts["n_bags"], facts["n_instances"]
            cells = (facts["n_features"], bags, facts["n_positive"], instances)
            rows.append(
                (DATA_SETS[name].title, *(f"{cell:.0f}" for cell in cells), f"{instances / bags:.1f}")
            )
    caption = "Data sets (of a synthetic one: training and test set of the first draw)"
    return Sheet(caption, ("", "dimensions", "bags", "positive", "instances", "per bag"), tuple(rows))


def _facts(results: Results, data_set: str) -> Mapping[str, float] | None:
    for method in results.methods:
        found = results.get(data_set, method)
        if found is not None and found.facts["n_bags"] is not None:
            return {name: float(value or 0) for name, value in found.facts.items()}
    return None


def _score_sheet(results: Results, methods: Sequence[str], caption: str) -> Sheet:
    def cell(data_set: str, result: Result, method: str) -> str:
        ours = results.get(data_set, COVAGG)
        compared = None if method == COVAGG or ours is None else ours.skill
        return score_text(result.skill, mark(compared, result.skill))

    return Sheet(caption, _titles(methods), _beside(results, methods, cell, SCORES, published_score))


def _time_sheet(results: Results, methods: Sequence[str]) -> Sheet:
    def cell(data_set: str, result: Result, method: str) -> str:
        ours = results.get(data_set, COVAGG)
        compared = None if method == COVAGG or ours is None else ours.seconds
        return time_text(result.seconds, mark(compared, result.seconds, is_cost=True))

    caption = "Mean CPU seconds of training and prediction, 95 % interval; -: stopped"
    return Sheet(caption, _titles(methods), _beside(results, methods, cell, TIMES, published_time))


def _beside(
    results: Results,
    methods: Sequence[str],
    cell: Callable[[str, Result, str], str],
    published: Mapping[tuple[str, str], Published],
    text: Callable[[Published | None], str],
) -> tuple[tuple[str, ...], ...]:
    """Return two rows per data set, our results and the source's."""
    rows = []
    for data_set in results.data_sets:
        found = [(name, results.get(data_set, name)) for name in methods]
        if any(result is not None for _, result in found):
            ours = [cell(data_set, result, name) if result else "" for name, result in found]
            source = [text(published.get((data_set, name))) for name in methods]
            rows.append((DATA_SETS[data_set].title, *ours))
            rows.append((_SOURCE, *source))
    return tuple(rows)


def _parameter_sheet(results: Results, methods: Sequence[str]) -> Sheet:
    rows = []
    for data_set in results.data_sets:
        found = [results.get(data_set, name) for name in methods]
        if any(found):
            rows.append((DATA_SETS[data_set].title, *map(_parameters, found)))
    return Sheet("Tuned parameters: C, factor of the heuristic gamma", _titles(methods), tuple(rows))


def _parameters(result: Result | None) -> str:
    if result is None or result.facts["C"] is None:
        return ""
    return f"{result.facts['C']:g}, {result.facts['gamma_factor']:g}"


def _ratio_sheet(results: Results, methods: Sequence[str]) -> Sheet:
    rows = []
    for data_set in results.data_sets:
        base = results.get(data_set, OPTIMAL_BALL)
        if base is not None and base.times and not base.is_stopped:
            seconds = float(np.mean(base.times))
            cells = [results.get(data_set, name) for name in methods]
            rows.append((DATA_SETS[data_set].title, *(_ratio(result, seconds) for result in cells)))
    caption = f"CPU time in that of {METHODS[OPTIMAL_BALL].title}"
    return Sheet(caption, _titles(methods), tuple(rows))


def _ratio(result: Result | None, seconds: float) -> str:
    if result is None:
        return ""
    if result.seconds is None:
        return "-"
    ratio = result.seconds.mean / seconds
    return f"{ratio:.{time_decimals(ratio)}f}"


def _memory_sheet(results: Results, methods: Sequence[str]) -> Sheet:
    rows = []
    for data_set in results.data_sets:
        found = [results.get(data_set, name) for name in methods]
        cells = ["" if result is None else f"{result.peak_bytes / 1e6:.0f}" for result in found]
        rows.append((DATA_SETS[data_set].title, *cells))
    caption = "Peak memory of the process in MB, Python and libraries included"
    return Sheet(caption, _titles(methods), tuple(rows))


def _mean_sheet(results: Results) -> Sheet:
    methods = [name for name in results.methods if not METHODS[name].is_tuned]
    rows = [
        (
            METHODS[name].title,
            *_mean_cells(means(results, name)),
            *_mean_cells(means(results, name, HELD_OUT)),
        )
        for name in methods
    ]
    improved = METHODS[IMPROVED].title
    caption = (
        "Mean over the data sets of mean Peirce skill scores, and over those held out: "
        f"{improved} was designed without them"
    )
    header = (
        "",
        *("data sets", "stopped", "stopped ones as 0", "without these", f"{improved} on the same"),
        *("held out", "stopped", "as 0", "without these", improved),
    )
    return Sheet(caption, header, tuple(rows))


def _mean_cells(mean: Mean) -> tuple[str, ...]:
    numbers = (mean.with_zeros, mean.of_finished, mean.improved_on_finished)
    texts = ["" if np.isnan(number) else f"{number + 0.0:.3f}" for number in numbers]
    return (str(mean.n_data_sets), str(mean.n_stopped), *texts)
