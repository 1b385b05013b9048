"""Table -> scores by concept and test scenes, claims, models of each concept in words, a figure."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Final

import numpy as np
from matplotlib.figure import Figure

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
from relforest.experiments.registry import heading
from relforest.experiments.sheets import Passage, Sheet
from relforest.experiments.study import Study
from relforest.experiments.table import Table
from relforest.reports.style import BLUE, INK, ORANGE, styled


def concept_models(table: Table) -> Iterator[tuple[str, str, str, Table]]:
    """Yield concept, test scenes, method and a row per model; the methods next to each other."""
    for (concept, test), there in table.groups("concept", "test").items():
        for (method,), own in there.groups("method").items():
            yield str(concept), str(test), str(method), own


def threshold(concept: str, test: str, method: str) -> float | None:
    """Return what the mean score must reach, if anything."""
    return THRESHOLDS.get((concept, test)) if method == STRICT_TREE else None


def summarize(table: Table) -> Findings:
    """List the scores, compare means with thresholds, print the first tree and rule set of each concept."""
    rows, claims = [], []
    for concept, test, method, own in concept_models(table):
        title, least = TITLES[concept], threshold(concept, test, method)
        pss, leaves, ellipse = (own.numbers(name) for name in ("pss", "leaves", "ellipse"))
        mean, best = float(pss.mean()), float(ellipse.mean())
        scores = (mean, float(pss.min()), least, None if np.isnan(best) else best)
        rows.append((title, test, method, len(own), *scores, float(leaves.mean())))
        if least is not None:
            claims.append(Claim(f"{title}, test scenes: {test}: mean PSS", mean, low=least))
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
        for place, (concept, test, method, own) in enumerate(concept_models(table)):
            pss, least = own.numbers("pss"), threshold(concept, test, method)
            color = BLUE if method == STRICT_TREE else ORANGE
            axes.plot(pss, [place] * len(pss), "o", color=color, alpha=0.6)
            if least is not None:
                axes.plot([least] * 2, [place - 0.3, place + 0.3], "-", color=INK)
            labels.append(f"{TITLES[concept]}, {test}: {method}")
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
