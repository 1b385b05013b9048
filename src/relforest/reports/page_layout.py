"""The layout of head, tree and panels on a page; lengths are in inches from the top left corner."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final, final

MARGIN: Final = 0.25
GAP: Final = 0.35
_SHAPE: Final = 1.5
_LEAST_WIDTH: Final = 3.6

Place = tuple[float, float]
"""From the left and from the top; also a width and a height."""


@final
@dataclass(frozen=True, slots=True)
class Page:
    """A page, with the top left corners of the tree and of each panel."""

    width: float
    height: float
    tree: Place
    panels: tuple[Place, ...]

    def at(self, place: Place) -> Place:
        """Return a place in shares of the page, counted from the bottom left corner as Matplotlib does."""
        return place[0] / self.width, 1.0 - place[1] / self.height

    def bounds(self, place: Place, width: float, height: float) -> tuple[float, float, float, float]:
        """Return left, bottom, width and height of a part with its top left corner at a place; see `at`."""
        left, bottom = self.at((place[0], place[1] + height))
        return left, bottom, width / self.width, height / self.height


def arrange(tree: Place, panel: Place, n_panels: int, *, head: Place) -> Page:
    """Place panels beside or below a tree, whichever comes closest to a landscape page.

    Sizes are (width, height): of the tree, of each panel, and of the lines above them (`head`).
    """
    pages = [
        _page(tree, panel, (n_panels, columns), head=head, beside=beside)
        for columns in range(1, max(n_panels, 1) + 1)
        for beside in (True, False)
    ]
    return min(pages, key=lambda page: (max(page.width, _SHAPE * page.height), page.width * page.height))


def _page(tree: Place, panel: Place, grid: tuple[int, int], *, head: Place, beside: bool) -> Page:
    """Return the page with a number of panels in a number of columns, beside or below the tree."""
    n_panels, columns = grid
    block = (columns * panel[0], math.ceil(n_panels / columns) * panel[1]) if n_panels else (0.0, 0.0)
    gap = GAP if n_panels else 0.0
    top = MARGIN + head[1] + 0.12
    if beside:
        inner = (tree[0] + gap + block[0], max(tree[1], block[1]))
    else:
        inner = (max(tree[0], block[0]), tree[1] + gap + block[1])
    width = max(inner[0], head[0], _LEAST_WIDTH)
    left = MARGIN + (width - (inner[0] if beside else tree[0])) / 2
    first = (left + tree[0] + gap, top)
    if not beside:
        first = (MARGIN + (width - block[0]) / 2, top + tree[1] + gap)
    places = tuple(
        (first[0] + (number % columns) * panel[0], first[1] + (number // columns) * panel[1])
        for number in range(n_panels)
    )
    return Page(width + 2 * MARGIN, inner[1] + top + MARGIN, (left, top), places)
