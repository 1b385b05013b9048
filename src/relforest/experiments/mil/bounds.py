"""Results -> claims: what must hold of the numbers measured.

A claim about data sets or methods that were not chosen is not made.
"""

from __future__ import annotations

from collections.abc import Iterator

from relforest.experiments.claims import Claim
from relforest.experiments.mil.cells import Result, Results
from relforest.experiments.mil.data import DATA_SETS, N_FOLDS
from relforest.experiments.mil.means import means
from relforest.experiments.mil.methods import COVAGG, IMPROVED, METHODS, PEERS
from relforest.experiments.mil.published import SCORES
from relforest.experiments.mil.settings import (
    ALPHA,
    EXPLAINED,
    FASTER_ON,
    FASTER_THAN,
    LONGEST_FOLD,
    MOST_BYTES,
    N_DRAWS,
    PEER_TOLERANCE,
    REPRODUCED,
    STANDARD,
)
from relforest.metrics import Moments, two_sample_p_value


def claims(results: Results, cpu_limit: float) -> Iterator[Claim]:
    """Yield all claims that the results allow.

    Parameters
    ----------
    results : Results
    cpu_limit : float
        CPU seconds that a method which was stopped would have needed at least.
    """
    yield from _reproduction(results)
    yield from _peers(results)
    yield from _speed(results, cpu_limit)
    yield from _lead(results)
    yield from _memory(results)


def exceptions(results: Results) -> Iterator[str]:
    """Yield a line for every peer of which no agreement with the source is claimed."""
    for (data_set, method), reason in EXPLAINED.items():
        found = results.get(data_set, method)
        source = SCORES[data_set, method].mean
        if found is not None and found.skill is not None and source is not None:
            difference = found.skill.mean - source
            title = f"{DATA_SETS[data_set].title}, {METHODS[method].title}"
            yield f"{title}: {found.skill.mean:.2f}, source {source:.2f} ({difference:+.2f}): {reason}"


def _reproduction(results: Results) -> Iterator[Claim]:
    for data_set in (*REPRODUCED, *STANDARD):
        found = results.get(data_set, COVAGG)
        if found is not None:
            is_exact = data_set in REPRODUCED
            relation = "not significantly different from" if is_exact else "not significantly below"
            name = f"{DATA_SETS[data_set].title}: CovAgg {relation} the source's, p"
            yield Claim(name, _p_value(found, data_set, is_exact=is_exact), low=ALPHA)


def _p_value(found: Result, data_set: str, *, is_exact: bool) -> float:
    """Return the p-value of the difference from the source; 1 for a better score if that is allowed."""
    published = SCORES[data_set, COVAGG]
    ours = found.skill
    if ours is None or published.mean is None:
        return float("nan")
    if not is_exact and ours.mean >= published.mean:
        return 1.0
    count = N_FOLDS if data_set in STANDARD else N_DRAWS
    # The source prints the half width to .01, so that its spread is known to .005 of it at best.
    source = Moments.from_interval(published.mean, published.half_width or 0.0, count)
    return two_sample_p_value(ours, source)


def _peers(results: Results) -> Iterator[Claim]:
    for data_set in REPRODUCED:
        for method in PEERS:
            found, published = results.get(data_set, method), SCORES.get((data_set, method))
            if found is None or published is None or (data_set, method) in EXPLAINED:
                continue
            source = float("nan") if published.mean is None else published.mean
            ours = float("nan") if found.skill is None else found.skill.mean
            name = f"{DATA_SETS[data_set].title}, {METHODS[method].title}: difference from the source"
            yield Claim(name, abs(ours - source), high=PEER_TOLERANCE)


def _speed(results: Results, cpu_limit: float) -> Iterator[Claim]:
    for data_set in FASTER_ON:
        ours = results.get(data_set, COVAGG)
        peers = {name: results.get(data_set, name) for name in FASTER_THAN}
        times = {name: _seconds(peer, cpu_limit) for name, peer in peers.items() if peer is not None}
        if ours is not None and times:
            own = float("nan") if ours.seconds is None else ours.seconds.mean
            listed = ", ".join(METHODS[name].title for name in times)
            name = f"{DATA_SETS[data_set].title}: CPU time of the fastest of {listed} in CovAgg's"
            yield Claim(name, min(times.values()) / own if own else float("nan"), low=1.0)
    for data_set, limit in LONGEST_FOLD.items():
        ours = results.get(data_set, COVAGG)
        if ours is not None:
            longest = max(ours.times) if ours.times and not ours.is_stopped else float("nan")
            yield Claim(
                f"{DATA_SETS[data_set].title}: CovAgg's longest fold, CPU seconds", longest, high=limit
            )


def _seconds(result: Result, cpu_limit: float) -> float:
    return cpu_limit if result.seconds is None else result.seconds.mean


def _lead(results: Results) -> Iterator[Claim]:
    whole = set(DATA_SETS)
    compared = [name for name in PEERS if all(results.get(data_set, name) is not None for data_set in whole)]
    is_whole = all(results.get(data_set, IMPROVED) is not None for data_set in whole)
    if compared and is_whole:
        leads = {name: means(results, name).lead for name in compared}
        best = min(leads, key=lambda name: leads[name])
        title = METHODS[IMPROVED].title
        name = f"lead of {title} in the mean score of {len(whole)} data sets, over {METHODS[best].title}"
        yield Claim(name, leads[best], low=0.0)


def _memory(results: Results) -> Iterator[Claim]:
    for data_set, limit in MOST_BYTES.items():
        found = {name: results.get(data_set, name) for name in results.methods}
        peaks = {name: result.peak_bytes for name, result in found.items() if result is not None}
        if peaks:
            most = max(peaks, key=lambda name: peaks[name])
            name = f"{DATA_SETS[data_set].title}: largest memory, MB ({METHODS[most].title})"
            yield Claim(name, peaks[most] / 1e6, high=limit / 1e6)
