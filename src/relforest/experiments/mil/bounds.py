"""Results -> claims: what must hold of the numbers measured.

Claims about data sets or methods that were left out are not made but listed.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from itertools import product
from typing import Final

from relforest.experiments.claims import Claim
from relforest.experiments.mil import settings
from relforest.experiments.mil.data import COMPARED, DATA_SETS, HELD_OUT, N_FOLDS
from relforest.experiments.mil.methods import COVAGG, IMPROVED, METHODS, PEERS
from relforest.experiments.mil.published import SCORES
from relforest.experiments.mil.results import Result, Results, means
from relforest.metrics import SampleMoments, two_sample_p_value

_WHOLES: Final[Mapping[str, Sequence[str]]] = {
    f"{len(COMPARED)} data sets": COMPARED,
    f"{len(HELD_OUT)} data sets that it was not designed with": HELD_OUT,
}


def verdicts(results: Results, cpu_limit: float) -> Iterator[Claim]:
    """Yield all claims of the study, also those that cannot be made because something was left out.

    A method that was stopped would have needed `cpu_limit` CPU seconds at least.
    """
    yield from _scores(results)
    yield from _peers(results)
    yield from _speed(results, cpu_limit)
    for which, whole in _WHOLES.items():
        yield _lead(results, which, whole)
    yield from _memory(results)


def exceptions(results: Results) -> Iterator[tuple[str, float, float, str]]:
    """Yield name, score, the source's, and the reason of every peer that is farther off than tolerated."""
    for (data_set, method), reason in settings.EXPLAINED.items():
        ours, source = results.mean(data_set, method), SCORES[data_set, method].value
        if abs(ours - source) > settings.PEER_TOLERANCE:
            yield f"{DATA_SETS[data_set].title}, {METHODS[method].title}", ours, source, reason


def _claim(
    results: Results, data_set: str, method: str, about: str, measured: Callable[[Result], float]
) -> Claim:
    """Return a number about a method on a data set as a claim without bounds, if there is a result."""
    found, name = results.get(data_set, method), f"{DATA_SETS[data_set].title}{about}"
    if found is None:
        return Claim(name, missing=_missing(results, [data_set], [method]))
    return Claim(name, measured(found))


def _missing(results: Results, data_sets: Sequence[str], methods: Sequence[str]) -> tuple[str, ...]:
    """Name what there is nothing of: whole data sets, whole methods, and single cells."""
    missing = []
    for data_set in data_sets:
        for method in methods:
            title, other = DATA_SETS[data_set].title, METHODS[method].title
            if data_set not in results.data_sets:
                missing.append(title)
            elif method not in results.methods:
                missing.append(other)
            elif results.get(data_set, method) is None:
                missing.append(f"{other} on {title}")
    return tuple(dict.fromkeys(missing))


def _mean(result: Result) -> float:
    return math.nan if result.skill is None else result.skill.mean


def _scores(results: Results) -> Iterator[Claim]:
    """Compare covariant aggregation with the source's scores, and on synthetic sets with thresholds."""
    for data_set in (*settings.REPRODUCED, *settings.STANDARD):
        is_exact = data_set in settings.REPRODUCED
        about = f": CovAgg not significantly {'different from' if is_exact else 'below'} the source's, p"
        test = partial(_p_value, data_set=data_set, is_exact=is_exact)
        yield replace(_claim(results, data_set, COVAGG, about, test), low=settings.ALPHA)
    for data_set, least in settings.LEAST.items():
        about = f": CovAgg's mean score, at least {least} less one standard error"
        found = results.get(data_set, COVAGG)
        skill = None if found is None else found.skill
        error = 0.0 if skill is None else skill.std / skill.count**0.5
        yield replace(_claim(results, data_set, COVAGG, about, _mean), low=least - error)


def _p_value(found: Result, data_set: str, *, is_exact: bool) -> float:
    """Return the p-value of the difference from the source; 1 for a better score if that is allowed."""
    published, ours = SCORES[data_set, COVAGG], found.skill
    if ours is None:
        return math.nan
    if not is_exact and ours.mean >= published.value:
        return 1.0
    count = N_FOLDS if data_set in settings.STANDARD else settings.N_DRAWS
    # The source prints the half width to .01, so that its spread is known to .005 of it at best.
    source = SampleMoments.from_interval(published.value, published.spread or 0.0, count)
    return two_sample_p_value(ours, source)


def _peers(results: Results) -> Iterator[Claim]:
    for data_set, method in product(settings.REPRODUCED, PEERS):
        published = SCORES.get((data_set, method))
        if published is not None and (data_set, method) not in settings.EXPLAINED:
            about = f", {METHODS[method].title}: difference from the source"
            difference = partial(_difference, source=published.value)
            yield replace(_claim(results, data_set, method, about, difference), high=settings.PEER_TOLERANCE)


def _difference(found: Result, source: float) -> float:
    return abs(_mean(found) - source)


def _speed(results: Results, cpu_limit: float) -> Iterator[Claim]:
    for data_set in settings.FASTER_ON:
        peers = {name: results.get(data_set, name) for name in settings.FASTER_THAN}
        times = {name: _seconds(peer, cpu_limit) for name, peer in peers.items() if peer is not None}
        listed = ", ".join(METHODS[name].title for name in times or settings.FASTER_THAN)
        about = f": CPU time of the fastest of {listed} in CovAgg's"
        ratio = partial(_ratio, fastest=min(times.values(), default=math.nan))
        claim = replace(_claim(results, data_set, COVAGG, about, ratio), low=1.0)
        is_alone = not times and not claim.missing
        missing = _missing(results, [data_set], settings.FASTER_THAN) if is_alone else claim.missing
        yield replace(claim, missing=missing)
    for data_set, limit in settings.LONGEST_FOLD.items():
        yield replace(
            _claim(results, data_set, COVAGG, ": CovAgg's longest fold, CPU seconds", _longest), high=limit
        )


def _seconds(result: Result, cpu_limit: float) -> float:
    return cpu_limit if result.seconds is None else result.seconds.mean


def _ratio(ours: Result, fastest: float) -> float:
    return fastest / ours.seconds.mean if ours.seconds is not None and ours.seconds.mean else math.nan


def _longest(ours: Result) -> float:
    return math.nan if ours.is_stopped else max(ours.times)


def _lead(results: Results, which: str, whole: Sequence[str]) -> Claim:
    compared = [name for name in PEERS if not _missing(results, whole, [name])]
    name = f"lead of {METHODS[IMPROVED].title} in the mean score of {which}, over the best"
    missing = _missing(results, whole, [IMPROVED])
    if missing or not compared:
        return Claim(f"{name} peer", missing=missing or ("every peer on at least one of them",))
    leads = {name: means(results, name, whole).lead for name in compared}
    best = min(leads, key=lambda name: leads[name])
    return Claim(f"{name} of {len(leads)} baselines, {METHODS[best].title}", leads[best], low=0.0)


def _memory(results: Results) -> Iterator[Claim]:
    for data_set, limit in settings.MOST_BYTES.items():
        found = {name: results.get(data_set, name) for name in results.methods}
        peaks = {name: result.peak_bytes for name, result in found.items() if result is not None}
        name = f"{DATA_SETS[data_set].title}: largest memory, MB"
        if not peaks:
            yield Claim(name, missing=_missing(results, [data_set], results.methods))
            continue
        most = max(peaks, key=lambda name: peaks[name])
        yield Claim(f"{name} ({METHODS[most].title})", peaks[most] / 1e6, high=limit / 1e6)
