"""Table -> scores by concept and kind of test scenes, claims, models of each concept in words, a figure."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Final, final

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from relforest.experiments.claims import Claim, Findings
from relforest.experiments.concepts.run import compute
from relforest.experiments.concepts.settings import (
    SETTINGS,
    SMOKE,
    STRICT_ALPHA,
    STRICT_TREE,
    THRESHOLDS,
    TITLES,
)
from relforest.experiments.headings import heading
from relforest.experiments.sheets import Passage, Sheet
from relforest.experiments.study import Study
from relforest.experiments.table import Table
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
    for (concept, test), there in table.groups("concept", "test").items():
        for (method,), own in there.groups("method").items():
            yield ConceptModels(str(concept), str(test), str(method), own)


def summarize(table: Table) -> Findings:
    """List the scores, compare means with thresholds, print the first tree and rule set of each concept."""
    rows, claims = [], []
    for models in concept_models(table):
        rows.append(
            (
                TITLES[models.concept],
                models.test,
                models.method,
                len(models.rows),
                float(models.pss.mean()),
                float(models.pss.min()),
                models.threshold,
                None if np.isnan(models.best_ellipse) else models.best_ellipse,
                float(models.rows.numbers("leaves").mean()),
            )
        )
        if models.threshold is not None:
            name = f"{TITLES[models.concept]}, test scenes: {models.test}: mean PSS"
            claims.append(Claim(name, float(models.pss.mean()), low=models.threshold))
    columns = {
        **dict.fromkeys(("concept", "test scenes", "method", "models"), ""),
        "mean PSS": ".3f",
        "lowest": ".3f",
        "threshold": ".2f",
        "ellipse": ".3f",
        "leaves": ".1f",
    }
    caption = (
        "Peirce skill score on test scenes like the training scenes, and on others\n"
        f"(thresholds are for trees with alpha = {STRICT_ALPHA:g}; 0.05 is the level of the source;\n"
        "ellipse: what the best single ellipse scores on the same scenes; leaves: mean number)"
    )
    return Findings("", tuple(claims), (Sheet(caption, columns, tuple(rows)), *_told(table)))


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


def _told(table: Table) -> Iterator[Passage]:
    for (concept, method), rows in table.groups("concept", "method").items():
        if method in {STRICT_TREE, "rules"}:
            yield Passage(f"Learned for {TITLES[str(concept)]}:", str(rows.cells("words")[0]))


STUDY: Final = Study(*heading(__package__), SETTINGS, SMOKE, compute, summarize, figures)
