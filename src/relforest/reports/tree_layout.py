"""Positions of the nodes in the drawing of a tree.

Lengths are in inches; x grows to the right, y downwards from the top of the root.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final, final

from relforest.trees import Instantiation, Node
from relforest.trees.nodes import children

SIDE_GAP: Final = 0.16
ANSWER_GAP: Final = 0.52
BINDING_GAP: Final = 0.14

Size = tuple[float, float]


@final
@dataclass(frozen=True, slots=True)
class Box:
    """The position of a node: its left, right, top and bottom edges."""

    left: float
    right: float
    top: float
    bottom: float

    @property
    def centre(self) -> float:
        """Horizontal position of the middle."""
        return (self.left + self.right) / 2

    def moved(self, right: float, down: float) -> Box:
        """Return the box, moved."""
        return Box(self.left + right, self.right + right, self.top + down, self.bottom + down)

    def beside(self, other: Box) -> bool:
        """Return whether two boxes overlap vertically, so that their sides could touch."""
        return self.top < other.bottom + SIDE_GAP and other.top < self.bottom + SIDE_GAP


@final
@dataclass(frozen=True, slots=True)
class Layout:
    """The positions of all nodes, by node index, and their total size."""

    boxes: tuple[Box, ...]
    width: float
    height: float


def lay_out(nodes: Sequence[Node], sizes: Sequence[Size]) -> Layout:
    """Lay out a tree from top to bottom, with children as close together as their subtrees allow.

    Nodes are depth first, as in `Tree.nodes`, and each has a size (width, height).
    """
    subtrees: list[dict[int, Box]] = [{} for _ in nodes]
    # Children come after their parents, so in reverse order every subtree is complete when needed.
    for index in range(len(nodes) - 1, -1, -1):
        width, height = sizes[index]
        own = Box(-width / 2, width / 2, 0.0, height)
        gap = BINDING_GAP if isinstance(nodes[index], Instantiation) else ANSWER_GAP
        below = children(nodes[index])
        subtrees[index] = {index: own}
        for position, subtree in enumerate(_side_by_side([subtrees[child] for child in below], below)):
            down = own.bottom + gap
            subtrees[index] |= {node: box.moved(0.0, down) for node, box in subtree.items()}
            subtrees[below[position]] = {}
    boxes = subtrees[0]
    left = min(box.left for box in boxes.values())
    placed = tuple(boxes[index].moved(-left, 0.0) for index in range(len(nodes)))
    return Layout(placed, max(box.right for box in placed), max(box.bottom for box in placed))


def _side_by_side(subtrees: Sequence[dict[int, Box]], roots: Sequence[int]) -> list[dict[int, Box]]:
    """Place subtrees next to each other, with their roots centred around 0."""
    placed: list[dict[int, Box]] = []
    for subtree in subtrees:
        shift = 0.0
        for left in (box for earlier in placed for box in earlier.values()):
            for right in subtree.values():
                if left.beside(right):
                    shift = max(shift, left.right + SIDE_GAP - right.left)
        placed.append({node: box.moved(shift, 0.0) for node, box in subtree.items()})
    if not placed:
        return placed
    middle = (placed[0][roots[0]].centre + placed[-1][roots[-1]].centre) / 2
    return [{node: box.moved(-middle, 0.0) for node, box in subtree.items()} for subtree in placed]
