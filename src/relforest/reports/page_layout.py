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


def arrange(
    tree: tuple[float, float], panel: tuple[float, float], n_panels: int, *, head: tuple[float, float]
) -> Page:
    """Place panels beside or below a tree, whichever comes closest to a landscape page.

    Parameters
    ----------
    tree, panel, head : (width, height)
        Sizes of the tree, of each panel and of the lines above them.
    n_panels : int
    """
    pages = []
    for columns in range(1, max(n_panels, 1) + 1):
        rows = math.ceil(n_panels / columns)
        block = (columns * panel[0], rows * panel[1]) if n_panels else (0.0, 0.0)
        grid = (n_panels, columns)
        pages += [_page(tree, panel, grid, block, head=head, beside=beside) for beside in (True, False)]
    return min(pages, key=lambda page: (max(page.width, _SHAPE * page.height), page.width * page.height))


def _page(
    tree: tuple[float, float],
    panel: tuple[float, float],
    grid: tuple[int, int],
    block: tuple[float, float],
    *,
    head: tuple[float, float],
    beside: bool,
) -> Page:
    n_panels, columns = grid
    gap = GAP if n_panels else 0.0
    top = MARGIN + head[1] + 0.12
    if beside:
        inner = (tree[0] + gap + block[0], max(tree[1], block[1]))
    else:
        inner = (max(tree[0], block[0]), tree[1] + gap + block[1])
    width = max(inner[0], head[0], _LEAST_WIDTH)
    spare = (width - inner[0]) / 2
    tree_left = MARGIN + (spare if beside else (width - tree[0]) / 2)
    first = (
        (MARGIN + spare + tree[0] + gap, top)
        if beside
        else (MARGIN + (width - block[0]) / 2, top + tree[1] + gap)
    )
    places = tuple(
        (first[0] + (number % columns) * panel[0], first[1] + (number // columns) * panel[1])
        for number in range(n_panels)
    )
    return Page(width + 2 * MARGIN, inner[1] + top + MARGIN, (tree_left, top), places)
