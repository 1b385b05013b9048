"""Elementary statements about bound objects, such as "x of C is at most 3"."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final, Literal, final

from relforest.mappings import Mapping, Related
from relforest.support.documents import well_formed
from relforest.support.errors import InputError, ModelFormatError
from relforest.support.options import between, in_range

if TYPE_CHECKING:
    from relforest.scenes import Schema

Side = Literal["at most", "at least"]

_LARGEST: Final = 1e100
_SMALLEST: Final = 1 / _LARGEST


@final
@dataclass(frozen=True, slots=True)
class Bound:
    """One component of the point is at most, or at least, `limit`."""

    component: int
    side: Side
    limit: float
    absolute: bool = False  # whether the sign of the component is ignored


@final
@dataclass(frozen=True, slots=True)
class Near:
    """The point is close to `centre`: ``sum(((x_i - centre_i) / radius_i) ** 2) <= 1``."""

    component: int  # the first component that counts; as many as `centre` has
    centre: tuple[float, ...]
    radii: tuple[float, ...]
    """One or two numbers each; for an angle, the difference is taken on the circle."""


@final
@dataclass(frozen=True, slots=True)
class Is:
    """The category is number `category` of its attribute, or not; for ``same``, 1 = same, 0 = different."""

    category: int
    negated: bool = False


Test = Bound | Near | Is


@final
@dataclass(frozen=True, slots=True)
class Statement:
    """A mapping of bound objects, and what its value must be; false where the mapping is undefined."""

    mapping: Mapping | Related
    variables: tuple[int, ...]
    """The bound objects that it takes: first the action's arguments, then the free variables."""
    test: Test

    @property
    def n_parameters(self) -> int:
        """How many numbers it was fitted with: what it costs as a description."""
        return 2 * len(self.test.centre) if isinstance(self.test, Near) else 1


def is_category(mapping: Mapping | Related) -> bool:
    """Whether the value of a mapping is one of a few."""
    return mapping.space == "category"


def statement_to_dict(statement: Statement) -> dict[str, Any]:
    """Return the JSON form."""
    mapping = statement.mapping
    if isinstance(mapping, Related):
        document: dict[str, Any] = {"relation": mapping.name}
    else:
        document = {"operation": mapping.operation, "attribute": mapping.attribute.name}
    document |= {"variables": list(statement.variables)}
    match statement.test:
        case Bound(component, side, limit, absolute):
            return document | {"component": component, side: limit} | ({"absolute": True} if absolute else {})
        case Near(component, centre, radii):
            return document | {"component": component, "centre": list(centre), "radii": list(radii)}
        case Is(category, negated):
            return document | {"is not" if negated else "is": category}


def statement_from_dict(document: Any, schema: Schema, n_bound: int) -> Statement:  # noqa: ANN401
    """Read what `statement_to_dict` returned.

    There are `n_bound` arguments and free variables.

    Raises
    ------
    ModelFormatError
        If it is not such a document.
    """
    with well_formed("malformed statement"):
        mapping = _mapping(document, schema)
        variables = tuple(between("variable", each, 0, n_bound - 1) for each in document["variables"])
        if len(variables) != mapping.arity:
            raise InputError(f"{mapping.name} takes {mapping.arity} objects, got {len(variables)}")
        return Statement(mapping, variables, _test(document, mapping))


def _mapping(document: dict[str, Any], schema: Schema) -> Mapping | Related:
    if "relation" not in document:
        return Mapping(document["operation"], schema[document["attribute"]])
    known = {relation.name: relation for relation in schema.relations}
    if document["relation"] not in known:
        raise ModelFormatError(f"unknown relation {document['relation']!r:.50}")
    return Related(known[document["relation"]], between("objects", len(document["variables"]), 1, 2))


def _test(document: dict[str, Any], mapping: Mapping | Related) -> Test:
    for key in ("is", "is not"):
        if key in document:
            if not is_category(mapping):
                raise ModelFormatError(f"{mapping.name} is a number, but is tested as a category")
            n_values = 2 if mapping.arity == 2 else len(mapping.attribute.categories)
            return Is(between("category", document[key], 0, n_values - 1), key == "is not")
    if is_category(mapping):
        raise ModelFormatError(f"{mapping.name} is a category, but is tested as a number")
    component = between("component", document["component"], 0, mapping.dim - 1)
    if "centre" in document:
        centre, radii = ([_number(each) for each in document[key]] for key in ("centre", "radii"))
        if not 1 <= len(centre) == len(radii) <= min(2, mapping.dim - component) or min(radii) < _SMALLEST:
            raise ModelFormatError(
                f"centre and radii must be one or two numbers each, the radii at least {_SMALLEST:g}"
            )
        return Near(component, tuple(centre), tuple(radii))
    side: Side = "at most" if "at most" in document else "at least"
    absolute = document.get("absolute", False)
    if not isinstance(absolute, bool):
        raise ModelFormatError(f"absolute must be true or false, got {absolute!r:.50}")
    return Bound(component, side, _number(document[side]), absolute)


def _number(value: object) -> float:
    return float(in_range("number", value, -_LARGEST, _LARGEST))
