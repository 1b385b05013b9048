"""Table -> scores by concept and kind of test scenes, claims, models of each concept in words, a figure."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import final

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from relforest.experiments.claims import Claim, Findings
from relforest.experiments.concepts.settings import STRICT_ALPHA, STRICT_TREE, THRESHOLDS, TITLES
from relforest.experiments.table import Cell, Table, aligned
from relforest.reports.style import BLUE, INK, ORANGE, styled


@final
@dataclass(frozen=True, slots=True, eq=False)
class ConceptModels:
    """The models of one concept and method on one kind of test scenes.

    Parameters
    ----------
    concept, test, method : str
    rows : Table
        A row per model.
    """

    concept: str
    test: str
    method: str
    rows: Table

    @property
    def pss(self) -> NDArray[np.float64]:
        """Peirce skill score of each model."""
        return self.rows.numbers("pss")

    @property
    def best_ellipse(self) -> float:
        """Mean score of the best single ellipse on the same test scenes; NaN where there is none."""
        return float(self.rows.numbers("ellipse").mean())

    @property
    def threshold(self) -> float | None:
        """What the mean score must reach, if anything."""
        return THRESHOLDS.get((self.concept, self.test)) if self.method == STRICT_TREE else None


def concept_models(table: Table) -> Iterator[ConceptModels]:
    """Yield what belongs together, the methods next to each other."""
    for concept in table.distinct("concept"):
        own = table.where(concept=concept)
        for test in own.distinct("test"):
            there = own.where(test=test)
            for method in there.distinct("method"):
                yield ConceptModels(str(concept), str(test), str(method), there.where(method=method))


def summarize(table: Table) -> Findings:
    """List the scores, compare means with thresholds, print the first tree and rule set of each concept."""
    rows, claims = [], []
    for models in concept_models(table):
        rows.append(
            (
                TITLES[models.concept],
                models.test,
                models.method,
                str(len(models.rows)),
                f"{models.pss.mean():.3f}",
                f"{models.pss.min():.3f}",
                "" if models.threshold is None else f"{models.threshold:.2f}",
                "" if np.isnan(models.best_ellipse) else f"{models.best_ellipse:.3f}",
                f"{models.rows.numbers('leaves').mean():.1f}",
            )
        )
        if models.threshold is not None:
            name = f"{TITLES[models.concept]}, test scenes: {models.test}: mean PSS"
            claims.append(Claim(name, float(models.pss.mean()), low=models.threshold))
    header = (
        "concept",
        "test scenes",
        "method",
        "models",
        "mean PSS",
        "lowest",
        "threshold",
        "ellipse",
        "leaves",
    )
    text = (
        "Peirce skill score on test scenes like the training scenes, and on others\n"
        f"(thresholds are for trees with alpha = {STRICT_ALPHA:g}; 0.05 is the level of the source;\n"
        "ellipse: what the best single ellipse scores on the same scenes; leaves: mean number)\n\n"
        + aligned(header, rows)
    )
    return Findings(text + "\n\n" + _told(table), tuple(claims))


def figures(table: Table) -> Mapping[str, Figure]:
    """Draw the score of every model next to the thresholds."""
    with styled():
        figure = Figure(figsize=(6.8, 4.2), layout="constrained")
        axes = figure.add_subplot()
        labels = []
        for place, models in enumerate(concept_models(table)):
            color = BLUE if models.method == STRICT_TREE else ORANGE
            axes.plot(models.pss, [place] * len(models.pss), "o", color=color, alpha=0.6)
            if models.threshold is not None:
                axes.plot([models.threshold] * 2, [place - 0.3, place + 0.3], "-", color=INK)
            labels.append(f"{TITLES[models.concept]}, {models.test}: {models.method}")
        axes.set_yticks(range(len(labels)), labels)
        axes.invert_yaxis()
        axes.set_xlim(right=1.01)
        axes.set_xlabel("Peirce skill score on test scenes (bars: thresholds)")
    return {"scores.png": figure}


def _told(table: Table) -> str:
    first: dict[tuple[Cell, Cell], Cell] = {}
    for row in table.rows:
        if row["method"] in {STRICT_TREE, "rules"}:
            first.setdefault((row["concept"], row["method"]), row["words"])
    return "\n\n".join(f"Learned for {TITLES[str(concept)]}:\n{said}" for (concept, _), said in first.items())
