"""Trees in words."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

import numpy as np

from relforest.trees.nodes import ANSWERS, Instantiation, Leaf, Node, Question, variable_name
from relforest.volumes import Arc, Volume

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from relforest.scenes import Schema

_SPOKEN_WITH_VOWEL: Final = frozenset("AEFHILMNORSX")


def sentence(question: Question, fresh: tuple[int, ...] = ()) -> str:
    """A question as a statement that is true on its Yes branch.

    Parameters
    ----------
    question : Question
    fresh : tuple of int
        Variables that range over all remaining objects at this question; they are introduced with
        "there is".

    Examples
    --------
    >>> import numpy as np
    >>> from relforest import Attribute
    >>> from relforest.mappings import Mapping
    >>> from relforest.volumes import Ellipsoid
    >>> near = Ellipsoid(np.array([1.0]), np.eye(1), 2.1, 5, 0.1)
    >>> sentence(Question(Mapping("distance", Attribute("location", 2)), (0, 2), near, 1, 2, 3), (2,))
    'there is a C within 3.1 of A'
    """
    names = [variable_name(variable) for variable in question.variables]
    subject, verb_phrase = _statement(question, names)
    asked = [variable_name(variable) for variable in fresh]
    if not asked:
        return " ".join((subject, *verb_phrase))
    if asked == [subject]:
        verb, rest = verb_phrase
        introduction = f"there is {_with_article(subject)}"
        return f"{introduction} {rest}" if verb == "is" else f"{introduction} that {verb} {rest}"
    if len(asked) == 1:
        introduction = f"there is {_with_article(asked[0])}"
    else:
        introduction = f"there are {', '.join(asked[:-1])} and {asked[-1]}"
    return f"{introduction} such that {' '.join((subject, *verb_phrase))}"


def describe(schema: Schema, nodes: tuple[Node, ...]) -> str:
    """A whole tree: one line per question and leaf.

    Error leaves that decided no training scene are left out, since they have nothing to tell.
    """
    n_questions = sum(isinstance(node, Question) for node in nodes)
    n_leaves = sum(isinstance(node, Leaf) for node in nodes)
    title = f"SMRF tree with {_counted(n_questions, 'question')} and {_counted(n_leaves, 'leaf', 'leaves')}"
    return "\n".join((title, *_lines(schema, nodes)))


def leaf_summary(leaf: Leaf) -> str:
    """Probability and training counts of a leaf."""
    total = leaf.negatives + leaf.positives
    return f"{leaf.probability:.2f}  ({leaf.positives} of {_counted(total, 'scene')} positive)"


def fresh_variables(schema: Schema, n_bound: int, n_new: int) -> tuple[int, ...]:
    """Those of the newly bound variables that are no action arguments."""
    return tuple(range(max(n_bound, schema.n_parameters), n_bound + n_new))


def _lines(schema: Schema, nodes: tuple[Node, ...]) -> Iterator[str]:
    stack: list[tuple[int, int, int, str]] = [(0, 0, 0, "")]
    while stack:
        index, n_bound, indent, label = stack.pop()
        n_new = 0
        node = nodes[index]
        while isinstance(node, Instantiation):
            n_new += 1
            index = node.child
            node = nodes[index]
        margin = "    " * indent
        bound_now = range(n_bound, min(n_bound + n_new, schema.n_parameters))
        given = [f"{variable_name(v)} is the {schema.parameters[v]}" for v in bound_now]
        if isinstance(node, Leaf):
            yield f"{margin}{label}{leaf_summary(node)}"
            continue
        text = sentence(node, fresh_variables(schema, n_bound, n_new))
        where = f"{', '.join(given)}; " if given else ""
        yield f"{margin}{label}{where}{text}?"
        answers = zip(ANSWERS, (node.yes, node.no, node.error), strict=True)
        following = [
            (child, n_bound + n_new, indent + 1, f"{answer}: ")
            for answer, child in answers
            if answer != "error" or not _is_untried(nodes[child])
        ]
        stack.extend(reversed(following))


def _is_untried(node: Node) -> bool:
    return isinstance(node, Leaf) and node.negatives + node.positives == 0


def _statement(question: Question, names: list[str]) -> tuple[str, tuple[str, str]]:
    """Subject, verb and the rest of a question's statement."""
    attribute = question.mapping.attribute.name
    match question.mapping.operation:
        case "identity":
            return names[0], ("has", f"{attribute} {_region(question.volume)}")
        case "distance" if attribute == "location":
            return names[1], ("is", _span(question.volume, names[0]))
        case "distance":
            return names[1], ("has", f"{attribute} {_span(question.volume, names[0])}'s")
        case "difference":
            return names[1], ("has", f"{attribute} minus {names[0]}'s {_region(question.volume)}")
        case "reframe":
            frame = f"in the frame of {names[0]} facing {names[1]}"
        case _:
            frame = f"in the frame of {names[0]} facing {names[1]}, their distance being 1"
    place = f"{_region(question.volume)}, {frame}"
    return names[2], ("is", place if attribute == "location" else f"at {attribute} {place}")


def _span(volume: Volume, reference: str) -> str:
    low, high = _interval(volume)
    if low <= 0.0:
        return f"within {_number(high)} of {reference}"
    return f"between {_number(low)} and {_number(high)} from {reference}"


def _region(volume: Volume) -> str:
    if isinstance(volume, Arc):
        return f"within {_number(volume.radius)} rad of {_number(volume.mean)} rad"
    if volume.dim == 1:
        low, high = _interval(volume)
        return f"between {_number(low)} and {_number(high)}"
    reaches = [
        f"{_number(float(np.linalg.norm(axis)))} along {_vector(axis / (np.linalg.norm(axis) or 1.0))}"
        for axis in volume.axes
    ]
    farthest = float(np.linalg.norm(volume.axes[0]))
    # The centre of a small volume needs more digits than usual.
    decimals = 1 - math.floor(math.log10(farthest)) if 0.0 < farthest < 0.1 else 2
    centre = _vector(volume.mean, decimals)
    return f"near {centre}, reaching {', '.join(reaches[:-1])} and {reaches[-1]}"


def _interval(volume: Volume) -> tuple[float, float]:
    variance = 1.0 if isinstance(volume, Arc) else float(volume.covariance[0, 0])
    centre, half = float(np.ravel(volume.mean)[0]), volume.radius * math.sqrt(variance)
    return centre - half, centre + half


def _number(value: float) -> str:
    text = f"{value:.3g}"
    return "0" if text in {"-0", "0"} else text


def _vector(values: NDArray[np.float64], decimals: int = 2) -> str:
    return f"({', '.join(_number(round(float(value), decimals)) for value in values)})"


def _with_article(name: str) -> str:
    # By how the letter is spoken: an A, a B, an F.
    return f"{'an' if name in _SPOKEN_WITH_VOWEL else 'a'} {name}"


def _counted(count: int, noun: str, plural: str | None = None) -> str:
    return f"{count} {noun if count == 1 else plural or noun + 's'}"
