"""Conditions in words."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final, NamedTuple

from relforest.forests.statements import Bound, Is, Near, Statement, Test
from relforest.mappings import Related
from relforest.support.numerals import ends, number

if TYPE_CHECKING:
    from relforest.forests.conditions import Condition
    from relforest.scenes import Attribute, Relation, Schema

_AXES: Final = ("x", "y", "z")
_LETTERS: Final = "CD"
_AUXILIARY: Final = frozenset({"is", "can", "may", "must", "was"})
# Numbers that are never below zero: an interval that begins there has one end.
_POSITIVE: Final = frozenset({"distance", "scaled_distance", "bearing"})


class _Phrase(NamedTuple):
    """A statement as subject and predicate.

    It may tell which object is meant, by its category, "has ...", or by what it is related to.
    """

    subject: str
    predicate: str
    is_category: bool = False
    is_relation: bool = False


class _Range(NamedTuple):
    """What a test allows a number to be."""

    low: float
    high: float
    absolute: bool = False


def sentence(condition: Condition, schema: Schema) -> str:
    """Return a condition as a sentence without a full stop.

    Arguments go by their names, and a free variable is "some object", whose categories come first.

    Examples
    --------
    >>> from relforest import Attribute, Schema
    >>> from relforest.forests import Condition
    >>> from relforest.forests.statements import Bound, Is, Statement
    >>> from relforest.mappings import Mapping
    >>> location = Attribute("location", 2)
    >>> team = Attribute("team", kind="category", categories=["own", "opponent"])
    >>> near = Statement(Mapping("distance", location), (0, 1), Bound(0, "at most", 3.0))
    >>> other = Statement(Mapping("identity", team), (1,), Is(1))
    >>> sentence(Condition(1, (other, near)), Schema([location, team], ["passer"]))
    'some object with team opponent is within 3 of the passer'
    """
    n_arguments = schema.n_parameters
    alone = condition.n_free == 1 and condition.at_least == 1
    names = [name if len(name) == 1 else f"the {name}" for name in schema.parameters]
    names += [""] if alone else list(_LETTERS[: condition.n_free])
    phrases = [_phrase(statement, names) for statement in condition.statements]
    if condition.n_free == 0:
        return _joined([f"{phrase.subject} {phrase.predicate}" for phrase in phrases])
    if alone:
        own = [phrase for phrase in phrases if not phrase.subject]
        rest = [f"{phrase.subject} {phrase.predicate}" for phrase in phrases if phrase.subject]
        return "; ".join([_some_object(own) if own else "there is another object", *rest])
    about = _joined([f"{phrase.subject} {phrase.predicate}" for phrase in phrases])
    if condition.every:
        return f"every object C has another, D, such that {about}"
    letters = " and ".join(names[n_arguments:])
    if condition.at_least == 1:
        return f"there are objects {letters} such that {about}"
    things = "objects" if condition.n_free == 1 else "pairs of objects"
    return f"there are at least {condition.at_least} {things} {letters} such that {about}"


def _some_object(phrases: list[_Phrase]) -> str:
    """Return what is true of some object, beginning with its categories, then its relations."""
    categories = [phrase.predicate for phrase in phrases if phrase.is_category]
    related = [phrase.predicate for phrase in phrases if phrase.is_relation]
    others = [phrase.predicate for phrase in phrases if not phrase.is_category and not phrase.is_relation]
    told = next(each for each in (others, related, categories) if each)
    said = "some object"
    if categories and told is not categories:
        said += f" with {' and '.join(each.removeprefix('has ') for each in categories)}"
    if related and told is not related:
        said += f" that {' and '.join(related)}"
    return f"{said} {_joined(told)}"


def _phrase(statement: Statement, names: list[str]) -> _Phrase:
    mapping, test = statement.mapping, statement.test
    if isinstance(mapping, Related):
        return _relation(mapping.relation, test, [names[variable] for variable in statement.variables])
    attribute = mapping.attribute
    *others, subject = (names[variable] for variable in statement.variables)
    # An object without a name of its own is the subject.
    if mapping.arity == 2 and "" in others:
        others, subject = [subject], ""
    others = [other or "it" for other in others]
    if isinstance(test, Is):
        if mapping.operation == "same":
            likeness = "the same" if (test.category == 1) != test.negated else "another"
            joint = "as" if likeness == "the same" else "than"
            return _Phrase(subject, f"has {likeness} {attribute.name} {joint} {others[0]}", is_category=True)
        does = "does not have" if test.negated else "has"
        said = f"{does} {attribute.name} {attribute.categories[test.category]}"
        return _Phrase(subject, said, is_category=not test.negated)
    if isinstance(test, Near) and len(test.centre) == 2:
        return _Phrase(subject, _ellipse(statement, test, others))
    return _Phrase(subject, _number(statement, _range(test, mapping.operation), others))


def _relation(relation: Relation, test: Test, names: list[str]) -> _Phrase:
    # Without direction, an object without a name of its own is the subject, or else the last one.
    subject, *others = names if relation.directed or not names[0] else names[::-1]
    is_denied = isinstance(test, Is) and (test.category == 1) == test.negated
    other = (others[0] or "it") if others else "any other object" if is_denied else "another object"
    verb = _denied(relation.name) if is_denied else relation.name
    return _Phrase(subject, f"{verb} {other}", is_relation=True)


def _denied(verb: str) -> str:
    """Return the negation of a verb in the third person, with whatever follows it."""
    first, _, rest = verb.partition(" ")
    if first in _AUXILIARY:
        return f"{first} not {rest}".rstrip()
    if first == "has":
        base = "have"
    elif first.endswith("ies"):
        base = f"{first[:-3]}y"
    elif first.endswith(("ches", "shes", "sses", "xes", "zes", "oes")):
        base = first[:-2]
    else:
        base = first.removesuffix("s")
    return f"does not {base} {rest}".rstrip()


def _range(test: Bound | Near, operation: str) -> _Range:
    if isinstance(test, Near):
        low, high = test.centre[0] - test.radii[0], test.centre[0] + test.radii[0]
        if operation == "bearing" and high >= math.pi:
            high = math.inf
        if operation in _POSITIVE and low <= 0.0:
            low = 0.0 if math.isinf(high) else -math.inf
        return _Range(low, high)
    if test.side == "at most":
        return _Range(-math.inf, test.limit, test.absolute)
    return _Range(test.limit, math.inf, test.absolute)


def _number(statement: Statement, limits: _Range, others: list[str]) -> str:
    mapping, attribute = statement.mapping, statement.mapping.attribute
    where = _as_to(attribute)
    component = statement.test.component if isinstance(statement.test, (Bound, Near)) else 0
    if mapping.operation in _POSITIVE and limits.high == 0.0:
        return _nowhere_else(mapping.operation, others, where)
    match mapping.operation:
        case "identity":
            return f"has {_component(attribute, component)} {_limits(limits)}"
        case "distance":
            return f"is {_distance(limits)} {others[0]}" + where
        case "scaled_distance":
            far = _limits(limits)
            return f"is {far} times as far from {others[0]} as {others[1]} is" + where
        case "bearing":
            turned = _Range(math.degrees(limits.low), math.degrees(limits.high))
            return f"is seen from {others[0]} {_limits(turned)} degrees away from {others[1]}" + where
        case "difference":
            part = _component(attribute, component)
            if limits.absolute and math.isinf(limits.high):
                return f"differs in {part} by at least {number(limits.low)} from {others[0]}"
            return f"has {part} {_difference(limits)} that of {others[0]}"
        case "reframe" | "scaled_reframe":
            return _in_frame(limits, component, others, scaled=mapping.operation != "reframe") + where
    raise AssertionError(mapping.operation)


def _nowhere_else(operation: str, others: list[str], where: str) -> str:
    """Say that a distance or an angle is 0, which is hardly ever true: what counts is how small it is."""
    if operation == "bearing":
        return f"is seen from {others[0]} in the direction of {others[1]}{where}"
    return f"is like {others[0]}{where}" if where else f"is where {others[0]} is"


def _component(attribute: Attribute, component: int) -> str:
    if attribute.dim == 1:
        return attribute.name
    if attribute.role == "location" and attribute.dim <= len(_AXES):
        return _AXES[component]
    return f"component {component + 1} of {attribute.name}"


def _as_to(attribute: Attribute) -> str:
    return "" if attribute.role == "location" else f" in {attribute.name}"


def _limits(limits: _Range) -> str:
    if math.isinf(limits.low):
        return f"at most {number(limits.high)}"
    if math.isinf(limits.high):
        return f"at least {number(limits.low)}"
    low, high = ends(limits.low, limits.high)
    return f"between {low} and {high}"


def _distance(limits: _Range) -> str:
    if limits.low <= 0.0 and math.isfinite(limits.high):
        return f"within {number(limits.high)} of"
    return f"{_limits(limits)} from"


def _difference(limits: _Range) -> str:
    low, high = limits.low, limits.high
    if limits.absolute:
        return f"within {number(high)} of"
    if -math.inf < low < 0.0 and high < math.inf:
        if high <= 0.0:
            return f"{_limits(_Range(-high, -low))} below"
        return f"from {number(-low)} below to {number(high)} above"
    return _signed(limits, "above", "below")


def _signed(limits: _Range, more: str, less: str) -> str:
    """Return limits of a number whose sign has a name; an end of the wrong sign is told by the other name."""
    low, high = limits.low, limits.high
    if math.isinf(low) and high < 0.0:
        return f"at least {number(-high)} {less}"
    if math.isinf(high) and low < 0.0:
        return f"at most {number(-low)} {less}"
    return f"{_limits(limits)} {more}"


def _in_frame(limits: _Range, component: int, others: list[str], *, scaled: bool) -> str:
    start, end = others
    if component == 0 and scaled:
        way = f", towards {end} or away from it" if limits.absolute else f" to {end}"
        return f"is {_limits(limits)} of the way from {start}{way}"
    if component == 0:
        both = f"{_limits(limits)} in front of or behind"
        far = both if limits.absolute else _signed(limits, "in front of", "behind")
        return f"is {far} {start}, facing {end}"
    if limits.absolute:
        is_beyond = math.isinf(limits.high)
        far = f"at least {number(limits.low)} from" if is_beyond else f"within {number(limits.high)} of"
    else:
        far = _signed(limits, "left of", "right of")
    return f"is {far} the line from {start} to {end}{' (in its lengths)' if scaled else ''}"


def _ellipse(statement: Statement, test: Near, others: list[str]) -> str:
    mapping = statement.mapping
    centre = f"({number(test.centre[0])}, {number(test.centre[1])})"
    axes = f"{number(test.radii[0])} and {number(test.radii[1])}"
    start, end = others[0] if others else "", others[-1] if others else ""
    where = {
        "identity": "",
        "difference": f", {start} at (0, 0)",
        "reframe": f", {start} at (0, 0) facing {end} along (1, 0)",
        "scaled_reframe": f", {start} at (0, 0) and {end} at (1, 0)",
    }[mapping.operation]
    verb = "is" if mapping.attribute.role == "location" else f"has {mapping.attribute.name}"
    return f"{verb} in the ellipse around {centre} with half-axes {axes}{where}"


def _joined(parts: list[str]) -> str:
    return parts[0] if len(parts) == 1 else f"{', '.join(parts[:-1])} and {parts[-1]}" if parts else ""
