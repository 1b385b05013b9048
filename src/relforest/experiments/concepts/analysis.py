"""Table -> scores by concept and kind of test scenes, claims, one tree of each concept in words, a figure."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import final

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from relforest.experiments.claims import Claim, Findings
from relforest.experiments.concepts.settings import STRICT_ALPHA, THRESHOLDS, TITLES
from relforest.experiments.table import Table, aligned
from relforest.reports.style import BLUE, INK, ORANGE, styled


@final
@dataclass(frozen=True, slots=True, eq=False)
class ConceptTrees:
    """The trees of one concept and level on one kind of test scenes.

    Parameters
    ----------
    concept, test : str
    alpha : float
        Nominal level.
    rows : Table
        A row per tree.
    """

    concept: str
    test: str
    alpha: float
    rows: Table

    @property
    def pss(self) -> NDArray[np.float64]:
        """Peirce skill score of each tree."""
        return self.rows.numbers("pss")

    @property
    def best_ellipse(self) -> float:
        """Mean score of the best single ellipse on the same test scenes; NaN where there is none."""
        return float(self.rows.numbers("ellipse").mean())

    @property
    def threshold(self) -> float | None:
        """What the mean score must reach, if anything."""
        return THRESHOLDS.get((self.concept, self.test)) if self.alpha == STRICT_ALPHA else None


def concept_trees(table: Table) -> Iterator[ConceptTrees]:
    """Yield what belongs together, the strict level next to the source's."""
    for concept in table.distinct("concept"):
        own = table.where(concept=concept)
        for test in own.distinct("test"):
            there = own.where(test=test)
            for alpha in np.unique(there.numbers("alpha")).tolist():
                yield ConceptTrees(str(concept), str(test), alpha, there.where(alpha=alpha))


def summarize(table: Table) -> Findings:
    """List the scores, compare their means with the thresholds, and print the first tree of each concept."""
    rows, claims = [], []
    for trees in concept_trees(table):
        rows.append(
            (
                TITLES[trees.concept],
                trees.test,
                f"{trees.alpha:g}",
                str(len(trees.rows)),
                f"{trees.pss.mean():.3f}",
                f"{trees.pss.min():.3f}",
                "" if trees.threshold is None else f"{trees.threshold:.2f}",
                "" if np.isnan(trees.best_ellipse) else f"{trees.best_ellipse:.3f}",
                f"{trees.rows.numbers('leaves').mean():.1f}",
            )
        )
        if trees.threshold is not None:
            name = f"{TITLES[trees.concept]}, test scenes: {trees.test}: mean PSS"
            claims.append(Claim(name, float(trees.pss.mean()), low=trees.threshold))
    header = (
        "concept",
        "test scenes",
        "alpha",
        "trees",
        "mean PSS",
        "lowest",
        "threshold",
        "ellipse",
        "leaves",
    )
    text = (
        "Peirce skill score of SMRF trees on test scenes like the training scenes, and on others\n"
        f"(thresholds are for alpha = {STRICT_ALPHA:g}; 0.05 is the level of the source;\n"
        "ellipse: what the best single ellipse scores on the same scenes; leaves: mean number)\n\n"
        + aligned(header, rows)
    )
    return Findings(text + "\n\n" + _told(table), tuple(claims))


def figures(table: Table) -> Mapping[str, Figure]:
    """Draw the score of every tree next to the thresholds."""
    with styled():
        figure = Figure(figsize=(6.8, 4.2), layout="constrained")
        axes = figure.add_subplot()
        labels = []
        for place, trees in enumerate(concept_trees(table)):
            color = BLUE if trees.alpha == STRICT_ALPHA else ORANGE
            axes.plot(trees.pss, [place] * len(trees.pss), "o", color=color, alpha=0.6)
            if trees.threshold is not None:
                axes.plot([trees.threshold] * 2, [place - 0.3, place + 0.3], "-", color=INK)
            labels.append(f"{TITLES[trees.concept]}, {trees.test} ({trees.alpha:g})")
        axes.set_yticks(range(len(labels)), labels)
        axes.invert_yaxis()
        axes.set_xlim(right=1.01)
        axes.set_xlabel("Peirce skill score on test scenes (bars: thresholds)")
    return {"scores.png": figure}


def _told(table: Table) -> str:
    strict = table.where(alpha=STRICT_ALPHA)
    first = [strict.where(concept=concept).rows[0] for concept in strict.distinct("concept")]
    return "\n\n".join(f"Learned for {TITLES[str(row['concept'])]}:\n{row['tree']}" for row in first)
