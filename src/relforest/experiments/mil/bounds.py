"""Results -> claims: what must hold of the numbers measured.

Claims about data sets or methods that were left out are not made but listed.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from types import MappingProxyType
from typing import Final

from relforest.experiments.claims import Claim
from relforest.experiments.mil.data import COMPARED, DATA_SETS, HELD_OUT, N_FOLDS
from relforest.experiments.mil.methods import COVAGG, IMPROVED, METHODS, PEERS
from relforest.experiments.mil.published import SCORES
from relforest.experiments.mil.results import Result, Results, means
from relforest.experiments.mil.settings import (
    ALPHA,
    EXPLAINED,
    FASTER_ON,
    FASTER_THAN,
    LEAST,
    LONGEST_FOLD,
    MOST_BYTES,
    N_DRAWS,
    PEER_TOLERANCE,
    REPRODUCED,
    STANDARD,
)
from relforest.metrics import Moments, two_sample_p_value

_WHOLES: Final[Mapping[str, Sequence[str]]] = MappingProxyType(
    {
        f"{len(COMPARED)} data sets": COMPARED,
        f"{len(HELD_OUT)} data sets that it was not designed with": HELD_OUT,
    }
)


def verdicts(results: Results, cpu_limit: float) -> Iterator[Claim]:
    """Yield all claims of the study, also those that cannot be made because something was left out.

    Parameters
    ----------
    results : Results
    cpu_limit : float
        CPU seconds that a method which was stopped would have needed at least.
    """
    yield from _reproduction(results)
    yield from _least(results)
    yield from _peers(results)
    yield from _speed(results, cpu_limit)
    for which, whole in _WHOLES.items():
        yield _lead(results, which, whole)
    yield from _memory(results)


def exceptions(results: Results) -> Iterator[tuple[str, float, float, str]]:
    """Yield name, score, the source's, and the reason of every peer that is farther off than tolerated."""
    for (data_set, method), reason in EXPLAINED.items():
        found, source = results.get(data_set, method), SCORES[data_set, method].value
        if found is not None and found.skill is not None and abs(found.skill.mean - source) > PEER_TOLERANCE:
            title = f"{DATA_SETS[data_set].title}, {METHODS[method].title}"
            yield title, found.skill.mean, source, reason


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


def _reproduction(results: Results) -> Iterator[Claim]:
    for data_set in (*REPRODUCED, *STANDARD):
        found = results.get(data_set, COVAGG)
        is_exact = data_set in REPRODUCED
        relation = "not significantly different from" if is_exact else "not significantly below"
        name = f"{DATA_SETS[data_set].title}: CovAgg {relation} the source's, p"
        if found is None:
            yield Claim(name, missing=_missing(results, [data_set], [COVAGG]))
        else:
            yield Claim(name, _p_value(found, data_set, is_exact=is_exact), low=ALPHA)


def _least(results: Results) -> Iterator[Claim]:
    for data_set, least in LEAST.items():
        found = results.get(data_set, COVAGG)
        name = f"{DATA_SETS[data_set].title}: CovAgg's mean score, at least {least} less one standard error"
        if found is None:
            yield Claim(name, missing=_missing(results, [data_set], [COVAGG]))
        elif found.skill is None:
            yield Claim(name, low=least)
        else:
            error = found.skill.std / found.skill.count**0.5
            yield Claim(name, found.skill.mean, low=least - error)


def _p_value(found: Result, data_set: str, *, is_exact: bool) -> float:
    """Return the p-value of the difference from the source; 1 for a better score if that is allowed."""
    published = SCORES[data_set, COVAGG]
    ours = found.skill
    if ours is None:
        return float("nan")
    if not is_exact and ours.mean >= published.value:
        return 1.0
    count = N_FOLDS if data_set in STANDARD else N_DRAWS
    # The source prints the half width to .01, so that its spread is known to .005 of it at best.
    source = Moments.from_interval(published.value, published.spread or 0.0, count)
    return two_sample_p_value(ours, source)


def _peers(results: Results) -> Iterator[Claim]:
    for data_set in REPRODUCED:
        for method in PEERS:
            found, published = results.get(data_set, method), SCORES.get((data_set, method))
            if published is None or (data_set, method) in EXPLAINED:
                continue
            name = f"{DATA_SETS[data_set].title}, {METHODS[method].title}: difference from the source"
            if found is None:
                yield Claim(name, missing=_missing(results, [data_set], [method]))
                continue
            ours = float("nan") if found.skill is None else found.skill.mean
            yield Claim(name, abs(ours - published.value), high=PEER_TOLERANCE)


def _speed(results: Results, cpu_limit: float) -> Iterator[Claim]:
    for data_set in FASTER_ON:
        ours = results.get(data_set, COVAGG)
        peers = {name: results.get(data_set, name) for name in FASTER_THAN}
        times = {name: _seconds(peer, cpu_limit) for name, peer in peers.items() if peer is not None}
        listed = ", ".join(METHODS[name].title for name in times or FASTER_THAN)
        name = f"{DATA_SETS[data_set].title}: CPU time of the fastest of {listed} in CovAgg's"
        if ours is None or not times:
            missing = _missing(results, [data_set], [COVAGG])
            yield Claim(name, missing=missing or _missing(results, [data_set], FASTER_THAN))
            continue
        own = float("nan") if ours.seconds is None else ours.seconds.mean
        yield Claim(name, min(times.values()) / own if own else float("nan"), low=1.0)
    for data_set, limit in LONGEST_FOLD.items():
        ours = results.get(data_set, COVAGG)
        name = f"{DATA_SETS[data_set].title}: CovAgg's longest fold, CPU seconds"
        if ours is None:
            yield Claim(name, missing=_missing(results, [data_set], [COVAGG]))
            continue
        longest = max(ours.times) if ours.times and not ours.is_stopped else float("nan")
        yield Claim(name, longest, high=limit)


def _seconds(result: Result, cpu_limit: float) -> float:
    return cpu_limit if result.seconds is None else result.seconds.mean


def _lead(results: Results, which: str, whole: Sequence[str]) -> Claim:
    compared = [name for name in PEERS if not _missing(results, whole, [name])]
    name = f"lead of {METHODS[IMPROVED].title} in the mean score of {which}, over the best"
    missing = _missing(results, whole, [IMPROVED])
    if missing or not compared:
        return Claim(f"{name} peer", missing=missing or ("every peer on at least one of them",))
    leads = {name: means(results, name, whole).lead for name in compared}
    best = min(leads, key=lambda name: leads[name])
    return Claim(f"{name} of {len(leads)} peers, {METHODS[best].title}", leads[best], low=0.0)


def _memory(results: Results) -> Iterator[Claim]:
    for data_set, limit in MOST_BYTES.items():
        found = {name: results.get(data_set, name) for name in results.methods}
        peaks = {name: result.peak_bytes for name, result in found.items() if result is not None}
        name = f"{DATA_SETS[data_set].title}: largest memory, MB"
        if not peaks:
            yield Claim(name, missing=_missing(results, [data_set], results.methods))
            continue
        most = max(peaks, key=lambda name: peaks[name])
        yield Claim(f"{name} ({METHODS[most].title})", peaks[most] / 1e6, high=limit / 1e6)
