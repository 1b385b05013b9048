"""Table -> scores by concept and kind of test scenes, claims, one tree of each concept in words, a figure."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Final, final

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from relforest.experiments.claims import Claim, Findings
from relforest.experiments.concepts.run import compute
from relforest.experiments.concepts.settings import SETTINGS, SMOKE, STRICT_ALPHA, THRESHOLDS, TITLES
from relforest.experiments.headings import heading
from relforest.experiments.sheets import Passage, Sheet
from relforest.experiments.study import Study
from relforest.experiments.table import Table
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
    for (concept, test), own in table.groups("concept", "test").items():
        for alpha in np.unique(own.numbers("alpha")).tolist():
            yield ConceptTrees(str(concept), str(test), alpha, own.where(alpha=alpha))


def summarize(table: Table) -> Findings:
    """List the scores, compare their means with the thresholds, and print the first tree of each concept."""
    rows, claims = [], []
    for trees in concept_trees(table):
        rows.append(
            (
                TITLES[trees.concept],
                trees.test,
                f"{trees.alpha:g}",
                len(trees.rows),
                float(trees.pss.mean()),
                float(trees.pss.min()),
                trees.threshold,
                None if np.isnan(trees.best_ellipse) else trees.best_ellipse,
                float(trees.rows.numbers("leaves").mean()),
            )
        )
        if trees.threshold is not None:
            name = f"{TITLES[trees.concept]}, test scenes: {trees.test}: mean PSS"
            claims.append(Claim(name, float(trees.pss.mean()), low=trees.threshold))
    columns = {
        **dict.fromkeys(("concept", "test scenes", "alpha", "trees"), ""),
        "mean PSS": ".3f",
        "lowest": ".3f",
        "threshold": ".2f",
        "ellipse": ".3f",
        "leaves": ".1f",
    }
    caption = (
        "Peirce skill score of SMRF trees on test scenes like the training scenes, and on others\n"
        f"(thresholds are for alpha = {STRICT_ALPHA:g}; 0.05 is the level of the source;\n"
        "ellipse: what the best single ellipse scores on the same scenes; leaves: mean number)"
    )
    return Findings("", tuple(claims), (Sheet(caption, columns, tuple(rows)), *_told(table)))


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


def _told(table: Table) -> Iterator[Passage]:
    for (concept,), trees in table.where(alpha=STRICT_ALPHA).groups("concept").items():
        yield Passage(f"Learned for {TITLES[str(concept)]}:", str(trees.rows[0]["tree"]))


STUDY: Final = Study(*heading(__package__), SETTINGS, SMOKE, compute, summarize, figures)
