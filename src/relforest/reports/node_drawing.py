"""The nodes of a tree as shapes with text, and the lines between them.

As in Figure 4.1 of Palmer (2015), instantiations are parallelograms, questions are rounded boxes and leaves
are rectangles. Lengths are in inches.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final, final

from matplotlib.axes import Axes
from matplotlib.patches import FancyBboxPatch, Patch, Polygon, Rectangle

from relforest.reports.style import BLUE, GREY, INK, PAPER, mixed, probability_color
from relforest.reports.text_size import line_height, shortened, text_width, wrapped
from relforest.reports.tree_layout import Box, Layout, Size
from relforest.reports.tree_path import TreePath
from relforest.trees import Instantiation, Question, Tree
from relforest.trees.nodes import ANSWERS, AnyLeaf, Leaf, Node, variable_name
from relforest.trees.text import introduced, sentence

_QUESTION_WIDTH: Final = 2.5
_LEAF_WIDTH: Final = 0.95
_PADDING: Final = 0.08
_SLANT: Final = 0.12
_SMALL: Final = 7.0
_TEXT: Final = 8.5
_LARGE: Final = 11.0
_LIT: Final = BLUE
_ANSWERED: Final = 0.62
"""Where on an edge its answer stands, as a share of it."""


@final
@dataclass(frozen=True, slots=True)
class NodeText:
    """The text of a node: a tag in small type, lines in normal type, and the resulting size."""

    tag: str
    lines: tuple[str, ...]
    size: Size


def node_texts(tree: Tree, names: dict[int, str], path: TreePath | None = None) -> tuple[NodeText, ...]:
    """Return the text of every node.

    Questions have short names, such as ``"Q1"``, by node index; on a path, instantiations show the bound
    objects.
    """
    new = introduced(tree.schema, tree.nodes)
    texts = []
    for index, node in enumerate(tree.nodes):
        if isinstance(node, Question):
            texts.append(_question_text(names[index], node, new[index]))
        elif isinstance(node, AnyLeaf):
            texts.append(_leaf_text(tree.leaves.index(index), node))
        else:
            on_path = path if path is not None and index in path.nodes else None
            texts.append(_binding_text(tree, tree.n_bound[index], on_path))
    return tuple(texts)


def draw_tree(
    axes: Axes, tree: Tree, texts: tuple[NodeText, ...], layout: Layout, path: TreePath | None = None
) -> None:
    """Draw all nodes and edges into axes in inches, with y pointing down."""
    lit = frozenset() if path is None else frozenset(path.nodes)
    for index, node in enumerate(tree.nodes):
        box = layout.boxes[index]
        if isinstance(node, Question):
            for answer, child in zip(ANSWERS, (node.yes, node.no, node.error), strict=True):
                below = layout.boxes[child]
                _draw_edge(axes, (box, below), answer, lit={index, child} <= lit)
        elif isinstance(node, Instantiation):
            _draw_edge(axes, (box, layout.boxes[node.child]), "", lit=index in lit)
    for index, node in enumerate(tree.nodes):
        _draw_node(axes, node, texts[index], layout.boxes[index], lit=index in lit)


def _question_text(name: str, question: Question, fresh: tuple[int, ...]) -> NodeText:
    # The panel of the same name has the figures.
    text = sentence(question, fresh, exact=f"see {name}")
    lines = wrapped(text, _QUESTION_WIDTH - 2 * _PADDING, _TEXT)
    height = line_height(_SMALL) + len(lines) * line_height(_TEXT) + 2 * _PADDING
    widest = max(text_width(line, _TEXT) for line in lines)
    width = min(max(widest + 2 * _PADDING, 1.5), _QUESTION_WIDTH)
    tag = f"{name}  {question.mapping.name}"
    return NodeText(shortened(tag, width - 2 * _PADDING, _SMALL), tuple(lines), (width, height))


def _leaf_text(ordinal: int, leaf: AnyLeaf) -> NodeText:
    says = leaf.says.removeprefix("probability ")
    total = leaf.negatives + leaf.positives
    counts = f"{leaf.positives} of {total}" if isinstance(leaf, Leaf) else leaf.counts_in_words
    counts = counts if total else "no scenes"
    widest = max(text_width(counts, _TEXT), text_width(says, _LARGE, "bold"))
    width = max(_LEAF_WIDTH, widest + 2 * _PADDING)
    height = line_height(_SMALL) + line_height(_LARGE) + line_height(_TEXT) + 1.5 * _PADDING
    return NodeText(f"leaf {ordinal}", (says, counts), (width, height))


def _binding_text(tree: Tree, variable: int, path: TreePath | None) -> NodeText:
    letter, parameters = variable_name(variable), tree.schema.parameters
    if path is not None:
        witness = path.witnesses[variable]
        text = f"{letter} = {'no object' if witness is None else witness}"
    elif variable < len(parameters):
        named = parameters[variable] != letter
        text = f"{letter}: {parameters[variable] if named else 'argument'}"
    else:
        text = f"{letter}: any object"
    text = shortened(text, _QUESTION_WIDTH, _TEXT)
    size = (text_width(text, _TEXT) + 2 * (_PADDING + _SLANT), line_height(_TEXT) + _PADDING)
    return NodeText("", (text,), size)


def _draw_node(axes: Axes, node: Node, text: NodeText, box: Box, *, lit: bool) -> None:
    corner, size = (box.left, box.top), (box.right - box.left, box.bottom - box.top)
    if isinstance(node, AnyLeaf):
        seen = node.negatives + node.positives > 0
        fill = probability_color(node.probability) if seen and isinstance(node, Leaf) else PAPER
        _add(axes, Rectangle(corner, *size, facecolor=fill, linestyle="-" if seen else ":"), lit=lit)
        ink = INK if seen or lit else GREY
        y = _write(axes, text.tag, (box.centre, box.top + _PADDING / 2), size=_SMALL, color=ink)
        y = _write(
            axes,
            text.lines[0],
            (box.centre, y),
            size=_LARGE,
            color=ink,
            fontweight="bold" if seen else "normal",
        )
        _write(axes, text.lines[1], (box.centre, y), size=_TEXT, color=ink)
    elif isinstance(node, Question):
        shape = "round,pad=0,rounding_size=0.12"
        _add(axes, FancyBboxPatch(corner, *size, boxstyle=shape, facecolor=PAPER), lit=lit)
        y = _write(axes, text.tag, (box.centre, box.top + _PADDING), size=_SMALL, color=GREY)
        for line in text.lines:
            y = _write(axes, line, (box.centre, y), size=_TEXT)
    else:
        left, right = box.left + _SLANT, box.right - _SLANT
        corners = [(left, box.top), (box.right, box.top), (right, box.bottom), (box.left, box.bottom)]
        fill = mixed(_LIT, 0.2) if lit else mixed(GREY, 0.15)
        _add(axes, Polygon(corners, closed=True, facecolor=fill), lit=lit)
        _write(axes, text.lines[0], (box.centre, box.top + _PADDING / 2), size=_TEXT)


def _add(axes: Axes, shape: Patch, *, lit: bool) -> None:
    shape.set(edgecolor=_LIT if lit else GREY, linewidth=2.2 if lit else 0.9, clip_on=False)
    axes.add_patch(shape)


def _draw_edge(axes: Axes, boxes: tuple[Box, Box], answer: str, *, lit: bool) -> None:
    above, below = boxes
    axes.plot(
        [above.centre, below.centre],
        [above.bottom, below.top],
        color=_LIT if lit else GREY,
        linewidth=2.2 if lit else 0.9,
        linestyle=":" if answer == "error" and not lit else "-",
        zorder=0.5,
        clip_on=False,
    )
    if answer:
        x = above.centre + _ANSWERED * (below.centre - above.centre)
        y = above.bottom + _ANSWERED * (below.top - above.bottom)
        style: dict[str, Any] = {"ha": "center", "va": "center", "color": GREY if answer == "error" else INK}
        box = {"facecolor": PAPER, "edgecolor": "none", "pad": 1.5}
        weight = "bold" if lit else "normal"
        axes.text(x, y, answer.capitalize(), fontsize=_TEXT, fontweight=weight, bbox=box, **style)


def _write(axes: Axes, text: str, at: tuple[float, float], *, size: float, **style: Any) -> float:  # noqa: ANN401
    """Write a centred line with its top at ``at``, and return the top of the next line."""
    height = line_height(size)
    style = {"ha": "center", "va": "center", "color": INK, "parse_math": False, "clip_on": False, **style}
    axes.text(at[0], at[1] + height / 2, text, fontsize=size, **style)
    return at[1] + height
