"""Table -> false-positive rates, the interval in which a calibrated test would lie, claims and a figure."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Final, final

from matplotlib.figure import Figure
from scipy import stats

from relforest.experiments.calibration.run import compute
from relforest.experiments.calibration.settings import ALPHA, PERMUTATION, SETTINGS, SMOKE
from relforest.experiments.claims import Claim, Findings
from relforest.experiments.registry import heading
from relforest.experiments.sheets import Sheet, Span
from relforest.experiments.study import Study
from relforest.experiments.table import Table
from relforest.reports.style import BLUE, INK, ORANGE, PALE, styled


@final
@dataclass(frozen=True, slots=True)
class Rate:
    """How often one test accepted a question on noise."""

    test: str
    objects: str
    """The test with its level, and the number of objects of a scene."""
    n_sets: int
    n_accepted: int
    """Scene sets, and those in which a question was accepted."""

    @property
    def rate(self) -> float:
        """The false-positive rate."""
        return self.n_accepted / self.n_sets

    @property
    def interval(self) -> tuple[float, float]:
        """The central 95 % of the rates that a test of level `ALPHA` shows on this number of sets."""
        low, high = (float(stats.binom.ppf(share, self.n_sets, ALPHA)) for share in (0.025, 0.975))
        return low / self.n_sets, high / self.n_sets


def rates(table: Table) -> Iterator[Rate]:
    """Yield the rate of each test at each size."""
    for (test, objects), own in table.groups("test", "objects").items():
        yield Rate(str(test), str(objects), len(own), int(own.numbers("accepted").sum()))


def summarize(table: Table) -> Findings:
    """State the rates; that of the permutation test must lie in the interval of a calibrated test.

    The claim is about the permutation test; the likelihood ratio test is only reported.
    """
    all_rates = list(rates(table))
    rows = []
    for found in all_rates:
        low, high = found.interval
        counts = (found.n_sets, found.n_accepted)
        is_inside = low <= found.rate <= high
        rows.append((found.test, found.objects, *counts, found.rate, Span(low, high), is_inside))
    caption = (
        f"How often a tree grew where labels were shuffled (alpha = {ALPHA} if not stated; sets of "
        f"{table.cells('scenes')[0]} scenes, one 2-D attribute)"
    )
    titles = ("test", "objects", "sets", "accepted", "rate", "95 % of a calibrated test", "inside")
    *_, claimed = (found for found in all_rates if found.test == PERMUTATION)
    name = f"{claimed.test} test, scenes of {claimed.objects} objects: false-positive rate"
    low, high = claimed.interval
    sheet = Sheet(caption, dict.fromkeys(titles, ".3f"), tuple(rows))
    return Findings("", (Claim(name, claimed.rate, low=low, high=high),), (sheet,))


def figures(table: Table) -> Mapping[str, Figure]:
    """Draw the rate of each test at each size, over the interval of a calibrated test."""
    with styled():
        figure = Figure(figsize=(6.0, 2.8), layout="constrained")
        axes = figure.add_subplot()
        labels = []
        for place, found in enumerate(rates(table)):
            low, high = found.interval
            axes.barh(place, high - low, left=low, height=0.7, color=PALE)
            axes.plot(found.rate, place, "o", color=BLUE if found.test == PERMUTATION else ORANGE)
            labels.append(f"{found.test}, {found.objects} objects")
        axes.axvline(ALPHA, color=INK, linewidth=0.8)
        axes.set_yticks(range(len(labels)), labels)
        axes.invert_yaxis()
        axes.set_xlim(0, 1)
        axes.set_xlabel("false-positive rate (band: 95 % of a calibrated test)")
    return {"rates.png": figure}


STUDY: Final = Study(*heading(__package__), SETTINGS, SMOKE, compute, summarize, figures)
