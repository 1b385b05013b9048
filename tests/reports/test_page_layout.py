from __future__ import annotations

from itertools import combinations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from relforest.reports.page_layout import MARGIN, arrange

LENGTHS = st.floats(0.5, 12.0)
PANEL = (2.0, 3.0)


@given(st.tuples(LENGTHS, LENGTHS), st.integers(0, 9), st.tuples(LENGTHS, st.floats(0.2, 1.0)))
def test_nothing_overlaps_or_leaves_the_page(
    tree: tuple[float, float], n_panels: int, head: tuple[float, float]
) -> None:
    page = arrange(tree, PANEL, n_panels, head=head)
    parts = [(*page.tree, *tree), *((x, y, *PANEL) for x, y in page.panels)]

    assert len(page.panels) == n_panels
    for x, y, width, height in parts:
        assert x >= MARGIN - 1e-9
        assert y >= MARGIN + head[1]
        assert x + width <= page.width - MARGIN + 1e-9
        assert y + height <= page.height - MARGIN + 1e-9
    for (x, y, width, height), (x2, y2, width2, height2) in combinations(parts, 2):
        apart = x + width <= x2 + 1e-9 or x2 + width2 <= x + 1e-9
        assert apart or y + height <= y2 + 1e-9 or y2 + height2 <= y + 1e-9


@pytest.mark.parametrize(("tree", "place"), [((3.0, 6.0), "beside"), ((12.0, 2.0), "below")])
def test_panels_stand_where_the_page_stays_compact(tree: tuple[float, float], place: str) -> None:
    page = arrange(tree, PANEL, 2, head=(1.0, 0.2))

    assert all((x > page.tree[0] + tree[0]) == (place == "beside") for x, _ in page.panels)
