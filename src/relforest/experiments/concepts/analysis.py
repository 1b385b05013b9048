"""Table -> scores by concept and kind of test scenes, claims, one tree of each concept in words, a figure."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from matplotlib.figure import Figure

from relforest.experiments.claims import Claim, Findings
from relforest.experiments.concepts.settings import THRESHOLDS, TITLES
from relforest.experiments.table import Table, aligned
from relforest.reports.style import BLUE, INK, styled


def cells(table: Table) -> Iterator[tuple[str, str, Table]]:
    """Yield concept, kind of test scenes, and the rows of both."""
    for concept in table.distinct("concept"):
        own = table.where(concept=concept)
        for test in own.distinct("test"):
            yield str(concept), str(test), own.where(test=test)


def summarize(table: Table) -> Findings:
    """State the scores, compare their means with the thresholds, and tell the first tree of each concept."""
    rows, claims = [], []
    for concept, test, own in cells(table):
        pss, leaves = own.numbers("pss"), own.numbers("leaves")
        threshold = THRESHOLDS.get((concept, test))
        rows.append(
            (
                TITLES[concept],
                test,
                str(len(own)),
                f"{pss.mean():.3f}",
                f"{pss.min():.3f}",
                "" if threshold is None else f"{threshold:.2f}",
                f"{leaves.mean():.1f}",
            )
        )
        if threshold is not None:
            name = f"{TITLES[concept]}, test scenes: {test}: mean PSS"
            claims.append(Claim(name, float(pss.mean()), low=threshold))
    header = ("concept", "test scenes", "trees", "mean PSS", "lowest", "threshold", "mean leaves")
    text = (
        "Peirce skill score of SMRF trees on test scenes like the training scenes, and on others\n\n"
        + aligned(header, rows)
    )
    return Findings(text + "\n\n" + _trees(table), tuple(claims))


def figures(table: Table) -> Mapping[str, Figure]:
    """Draw the score of every tree next to the thresholds."""
    with styled():
        figure = Figure(figsize=(6.4, 3.2), layout="constrained")
        axes = figure.add_subplot()
        labels = []
        for place, (concept, test, own) in enumerate(cells(table)):
            pss = own.numbers("pss")
            axes.plot(pss, [place] * len(pss), "o", color=BLUE, alpha=0.6)
            if (concept, test) in THRESHOLDS:
                axes.plot([THRESHOLDS[concept, test]] * 2, [place - 0.3, place + 0.3], "-", color=INK)
            labels.append(f"{TITLES[concept]} ({test})")
        axes.set_yticks(range(len(labels)), labels)
        axes.invert_yaxis()
        axes.set_xlim(right=1.01)
        axes.set_xlabel("Peirce skill score on test scenes (bars: thresholds)")
    return {"scores.png": figure}


def _trees(table: Table) -> str:
    first = [table.where(concept=concept) for concept in table.distinct("concept")]
    return "\n\n".join(
        f"Learned for {TITLES[str(own.cells('concept')[0])]}:\n{own.cells('tree')[0]}" for own in first
    )
