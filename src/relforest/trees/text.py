"""Trees in words."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final, NamedTuple

from relforest.support.numerals import ends, number, rounded, vector
from relforest.trees.bounds import Bounds
from relforest.trees.nodes import (
    ANSWERS,
    AnyLeaf,
    ClassLeaf,
    Instantiation,
    MeanLeaf,
    Node,
    Question,
    children,
    counted,
    variable_name,
)
from relforest.trees.places import AXIS_NAMES, SIDES, place
from relforest.trees.regions import Interval, interval, region, span
from relforest.volumes import Arc, Slab

if TYPE_CHECKING:
    from collections.abc import Iterator

    from relforest.mappings import Mapping
    from relforest.scenes import Schema
    from relforest.volumes import Ellipsoid, Volume

_SPOKEN_WITH_VOWEL: Final = frozenset("AEFHILMNORSX")
_ORIENTATION: Final = "left and right are as on a map, with x to the right and y upwards"


class _Statement(NamedTuple):
    """The parts of what a question states: that `subject` `verb` `lead`, and exactly `exact`."""

    subject: str
    verb: str
    lead: str
    exact: str


def sentence(question: Question, fresh: tuple[int, ...] = (), *, exact: str | None = None) -> str:
    """Return a question as a statement that is true on its Yes branch.

    Where the volume allows it, plain words come first and the exact figures after a colon.

    Parameters
    ----------
    question : Question
    fresh : tuple of int
        Variables that range over all remaining objects at this question; they are introduced with
        "there is".
    exact : str, optional
        Replaces the exact figures where plain words come first.

    Examples
    --------
    >>> import numpy as np
    >>> from relforest import Attribute
    >>> from relforest.mappings import Mapping
    >>> from relforest.volumes import Ellipsoid
    >>> near = Ellipsoid(np.array([1.0]), np.eye(1), 2.1, 5, 0.1)
    >>> sentence(Question(Mapping("distance", Attribute("location", 2)), (0, 2), near, 1, 2, 3), (2,))
    'there is a C within 3.1 of A'
    >>> middle = Ellipsoid(np.array([0.5, 0.0]), np.eye(2), 0.2, 5, 0.1)
    >>> between = Question(Mapping("scaled_reframe", Attribute("location", 2)), (0, 1, 2), middle, 1, 2, 3)
    >>> sentence(between)
    'C is around the middle of the way from A to B: within 0.2 of (0.5, 0), with A at (0, 0) and B at (1, 0)'
    """
    said = _statement(question)
    rest = f"{said.lead}: {exact or said.exact}" if said.lead else said.exact
    return _introduced(said, rest, fresh)


def describe(schema: Schema, nodes: tuple[Node, ...], *, other: str | None = "LABEL") -> str:
    """Return a whole tree in words: one line per question and leaf.

    Error leaves that decided no training scene are left out.

    The label of the negative class is `other`, for `one_sided_hint`, which is added unless it is None.
    """
    questions = [node for node in nodes if isinstance(node, Question)]
    n_leaves = sum(isinstance(node, AnyLeaf) for node in nodes)
    lines = [
        f"SMRF tree with {counted(len(questions), 'question')} and {counted(n_leaves, 'leaf', 'leaves')}"
    ]
    lines += _lines(schema, nodes)
    leads = [_statement(question).lead for question in questions]
    if any(side in lead for lead in leads for side in SIDES):
        lines.append(_ORIENTATION)
    remark = "" if other is None else one_sided_hint(nodes, other)
    return "\n".join((*lines, remark) if remark else lines)


def one_sided_hint(nodes: tuple[Node, ...], other: str = "LABEL") -> str:
    """Return what to do about a tree that predicts one class only; empty for any other tree.

    The label of the other class is `other`.
    """
    prediction = _sole_prediction(nodes)
    if prediction is None:
        return ""
    word = "positive" if prediction else "negative"
    return (
        f"every leaf predicts {word}: relforest fit --positive {other} looks for what exists in scenes of "
        "the other class"
    )


def introduced(schema: Schema, nodes: tuple[Node, ...]) -> dict[int, tuple[int, ...]]:
    """Return, for the index of each question, its new variables that range over objects."""
    return {index: _fresh(schema, new) for index, new in _newly_bound(nodes).items()}


def _newly_bound(nodes: tuple[Node, ...]) -> dict[int, range]:
    """Return, for the index of each question, the variables that are bound right before it."""
    found: dict[int, range] = {}
    bound = [range(0)] * len(nodes)
    for index, node in enumerate(nodes):
        new = bound[index]
        if isinstance(node, Instantiation):
            bound[node.child] = range(new.start, new.stop + 1)
        elif isinstance(node, Question):
            found[index] = new
            for child in children(node):
                bound[child] = range(new.stop, new.stop)
    return found


def _fresh(schema: Schema, new: range) -> tuple[int, ...]:
    """Return those of newly bound variables that are not action arguments."""
    return tuple(variable for variable in new if variable >= schema.n_parameters)


def _sole_prediction(nodes: tuple[Node, ...]) -> bool | None:
    """Return the prediction that all leaves share, None if they differ.

    Leaves that decided no training scene count only if none decided any.
    """
    leaves = [node for node in nodes if isinstance(node, AnyLeaf)]
    if any(isinstance(leaf, (MeanLeaf, ClassLeaf)) for leaf in leaves):
        return None
    tried = [leaf for leaf in leaves if leaf.n_scenes] or leaves
    predictions = {leaf.probability >= 0.5 for leaf in tried}
    return predictions.pop() if len(predictions) == 1 else None


def _lines(schema: Schema, nodes: tuple[Node, ...]) -> Iterator[str]:
    new = _newly_bound(nodes)
    # The indent and the answer of each node that is told.
    told = {0: ""}
    for index, node in enumerate(nodes):
        if index not in told:
            continue
        lead = told[index]
        if isinstance(node, Instantiation):
            told[node.child] = lead
        elif isinstance(node, AnyLeaf):
            yield f"{lead}{node.summary}"
        else:
            yield f"{lead}{_given(schema, new[index])}{sentence(node, _fresh(schema, new[index]))}"
            indent = " " * (len(lead) - len(lead.lstrip()) + 4)
            told |= {c: f"{indent}{answer}: " for answer, c in zip(ANSWERS, children(node), strict=True)}
            if _is_untried(nodes[node.error]):
                del told[node.error]


def _given(schema: Schema, new: range) -> str:
    names = [(variable_name(each), schema.parameters[each]) for each in new if each < schema.n_parameters]
    told = [f"{letter} is the {name}" for letter, name in names if letter != name]
    return f"{', '.join(told)}; " if told else ""


def _is_untried(node: Node) -> bool:
    return isinstance(node, AnyLeaf) and node.n_scenes == 0


def _introduced(said: _Statement, rest: str, fresh: tuple[int, ...]) -> str:
    whole = f"{said.subject} {said.verb} {rest}"
    asked = [variable_name(variable) for variable in fresh]
    if not asked:
        return whole
    if len(asked) > 1:
        return f"there are {', '.join(asked[:-1])} and {asked[-1]} such that {whole}"
    introduction = f"there is {_with_article(asked[0])}"
    if asked == [said.subject]:
        return f"{introduction} {'with ' if said.verb == 'has' else ''}{rest}"
    return f"{introduction} such that {whole}"


def _statement(question: Question) -> _Statement:
    mapping, volume = question.mapping, question.volume
    names = [variable_name(variable) for variable in question.variables]
    distance = mapping.operation == "distance"
    if mapping.space == "category":
        return _Statement(names[-1], "has", "", _category(mapping, int(interval(volume)[1]), names[0]))
    # An object is at a place, and has anything else.
    compared = distance or mapping.operation in {"scaled_distance", "bearing"}
    located = mapping.attribute.role == "location" and (compared or volume.dim > 1)
    owners = names if located else [f"{name}'s" for name in names]
    bounds = question.bounds
    if isinstance(volume, Slab) and not bounds:
        bounds = (Bounds(volume.axis, *interval(volume.interval)),)
    if isinstance(volume, Slab) or (volume.dim > 1 and bounds):
        return _coordinates(mapping, volume, bounds, names)
    limits = (bounds[0].low, bounds[0].high) if bounds else interval(volume)
    if distance:
        exact = _distance(_from_zero(limits), owners[0])
    elif compared:
        exact = _seen_from(mapping.operation, limits, owners)
    elif mapping.operation == "identity":
        exact = span(limits) if bounds else region(volume)
    elif mapping.operation == "difference" and not located:
        is_number = volume.dim == 1 and not isinstance(volume, Arc)
        exact = _difference(limits, owners[0]) if is_number else _relative(volume, owners[0])
    else:
        exact = f"{region(volume)}, {_frame(mapping.operation, owners, volume.dim)}"
    if located:
        return _Statement(names[-1], "is", place(mapping, volume, names), exact)
    return _Statement(names[-1], "has", "", f"{mapping.attribute.name} {exact}")


def _coordinates(
    mapping: Mapping, volume: Volume, bounds: tuple[Bounds, ...], names: list[str]
) -> _Statement:
    located = mapping.attribute.role == "location"
    owners = names if located else [f"{name}'s" for name in names]
    if located and volume.dim <= len(AXIS_NAMES):
        components, owner = [AXIS_NAMES[each.axis] for each in bounds], names[-1]
    else:
        components = [f"component {each.axis + 1}" for each in bounds]
        owner = f"{names[-1]}'s {mapping.attribute.name}"
    limits = [(each.low, each.high) for each in bounds]
    lead = frame = ""
    if mapping.operation == "difference":
        said = [_difference(each, f"{names[0]}'s") for each in limits]
    else:
        said = [span(each) for each in limits]
    if mapping.operation not in {"identity", "difference"}:
        lead = place(mapping, volume, names, bounds)
        frame = f", {_frame(mapping.operation, owners, volume.dim)}"
    if lead:
        told = " and ".join(f"{name} {each}" for name, each in zip(components, said, strict=True))
        return _Statement(names[-1], "is", lead, f"{told}{frame}")
    subjects = [f"{name} of {owner}" for name in components]
    told = " and ".join(f"{name} is {each}" for name, each in zip(subjects, said, strict=True))
    return _Statement(subjects[0], "is", "", told.removeprefix(f"{subjects[0]} is ") + frame)


def _category(mapping: Mapping, number: int, reference: str) -> str:
    name = mapping.attribute.name
    if mapping.operation == "same":
        return f"the same {name} as {reference}" if number == 1 else f"another {name} than {reference}"
    return f"{name} {mapping.attribute.categories[number]}"


def _seen_from(operation: str, limits: tuple[float, float], names: list[str]) -> str:
    if operation == "scaled_distance":
        return f"{span(_from_zero(limits))} times as far from {names[0]} as {names[1]}"
    low, high = _from_zero((math.degrees(limits[0]), math.degrees(limits[1])))
    high = math.inf if high >= 180.0 else high
    if math.isinf(low) and math.isinf(high):
        turned = "any number of"
    elif math.isinf(low) or math.isinf(high):
        turned = span((float(number(low)), high) if math.isinf(high) else (low, float(number(high))))
    else:
        turned = span((low, high))
    return f"{turned} degrees from {names[1]}, seen from {names[0]}"


def _from_zero(limits: Interval) -> Interval:
    """Return the limits of a number that is never below zero, without a lower end that says nothing."""
    low, high = limits
    if math.isinf(high) or high <= 0.0 or low == -math.inf or ends(max(low, 0.0), high)[0] != "0":
        return limits
    return -math.inf, float(ends(0.0, high)[1])


def _frame(operation: str, names: list[str], dim: int) -> str:
    origin, unit = (vector([first, *[0.0] * (dim - 1)], 0.0) for first in (0.0, 1.0))
    start = f"with {names[0]} at {origin}"
    if operation == "difference":
        return start
    if operation == "reframe":
        return f"{start} and {names[1]} straight along {unit}"
    return f"{start} and {names[1]} at {unit}"


def _distance(limits: Interval, reference: str) -> str:
    if math.isinf(limits[0]):
        return f"within {rounded(limits[1], 0.0)} of {reference}"
    return f"{span(limits)} from {reference}"


def _relative(volume: Ellipsoid | Arc, reference: str) -> str:
    extent = region(volume)
    centred = extent.removesuffix(" of 0 rad")
    return f"relative to {reference} {extent}" if centred == extent else f"{centred} of {reference}"


def _difference(limits: Interval, reference: str) -> str:
    low, high = limits
    if math.isinf(low) or math.isinf(high):
        return _beyond(limits, reference)
    low_text, high_text = ends(low, high)
    if low == high == 0.0:
        return f"equal to {reference}"
    if abs(low + high) <= (high - low) / 100:
        return f"within {high_text} of {reference}"
    if low_text == "0":
        return f"up to {high_text} more than {reference}"
    if high_text == "0":
        return f"up to {low_text.removeprefix('-')} less than {reference}"
    if low > 0.0:
        return f"{span((low, high))} more than {reference}"
    if high < 0.0:
        return f"{span((-high, -low))} less than {reference}"
    return f"between {low_text.removeprefix('-')} less and {high_text} more than {reference}"


def _beyond(limits: Interval, reference: str) -> str:
    end, side, other = limits[0], "at least", "at most"
    if math.isinf(end):
        end, side, other = limits[1], other, side
    if end == 0.0:
        return f"{side} {reference}"
    side, way = (side, "more") if end > 0.0 else (other, "less")
    return f"{side} {rounded(abs(end), 0.0)} {way} than {reference}"


def _with_article(name: str) -> str:
    # By how the letter is spoken: an A, a B, an F.
    return f"{'an' if name in _SPOKEN_WITH_VOWEL else 'a'} {name}"
