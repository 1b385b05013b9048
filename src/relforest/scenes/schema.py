"""The description of objects: named attributes and the arguments of an action.

The names and defaults follow Palmer (2015), section 4.3: which mapping functions an attribute takes part in
belongs to the schema, because every extra function costs significance in the test of a tree's candidate
questions.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Final, Literal, TypeVar, cast, final

from relforest.support.errors import InputError, ModelFormatError
from relforest.support.options import at_least, one_of

Kind = Literal["euclidean", "angle", "category"]
Role = Literal["location", "color", "extent", "property"]
_Name = TypeVar("_Name")

KINDS: Final[tuple[Kind, ...]] = ("euclidean", "angle", "category")
ROLES: Final[tuple[Role, ...]] = ("location", "color", "extent", "property")
OPERATION_NAMES: Final = (
    *("identity", "distance", "difference", "reframe", "scaled_reframe"),
    *("scaled_distance", "bearing", "same"),
)

OPERATIONS_BY_KIND: Final[dict[Kind, tuple[str, ...]]] = {
    "euclidean": OPERATION_NAMES[:-1],
    "angle": ("identity", "difference"),
    "category": ("identity", "same"),
}
PLANAR_OPERATIONS: Final = ("reframe", "scaled_reframe", "bearing")
_OPERATIONS_BY_ROLE: Final[dict[Role, tuple[str, ...]]] = {
    "color": ("identity", "difference"),
    "extent": ("identity",),
}
_ROLES_BY_NAME: Final[dict[str, Role]] = {
    "location": "location",
    "position": "location",
    "color": "color",
    "colour": "color",
    "extent": "extent",
    "extent_ratio": "extent",
}


@final
@dataclass(frozen=True, slots=True, init=False)
class Attribute:
    """One property of an object: a vector of ``dim`` numbers, an angle, or a category.

    Parameters
    ----------
    name : str
        Unique within a schema; it appears in the sentences of a tree.
    dim : int
        Number of components, at least 1.
    kind : {"euclidean", "angle", "category"}, optional
        An angle is in radians with period 2 pi and has ``dim`` 1. A category is one of a few names, such as a
        team; it has ``dim`` 1, and `Scenes.matrix` contains its number in ``categories``. Default:
        ``"angle"`` for the name ``"orientation"`` with ``dim`` 1, otherwise ``"euclidean"``.
    operations : iterable of str, optional
        Operations of `OPERATION_NAMES` that the attribute takes part in. The defaults give the functions of
        Palmer (2015), section 4.3: identity and difference for a color, identity for extents and angles, and
        identity, distance, difference and (in two dimensions) both reframes for anything else. A category
        has its own two: identity, and whether two objects are of the same category.
    categories : iterable of str, optional
        The names that a category can have. If there are none, the reader of scenes takes those of the data,
        sorted.
    role : {"location", "color", "extent", "property"}, optional
        What the attribute means, which decides how sentences speak of it ("is within 3 of" a location) and
        the default operations. Default: that of the names location, position, color, color, extent and
        extent_ratio, otherwise ``"property"``.

    Raises
    ------
    InputError
        If the name is empty, or the other parameters do not go together.

    Examples
    --------
    >>> Attribute("location", 2).operations
    ('identity', 'distance', 'difference', 'reframe', 'scaled_reframe')
    >>> Attribute("orientation").kind
    'angle'
    >>> Attribute("team", kind="category", categories=["home", "guest"]).operations
    ('identity', 'same')
    """

    name: str
    dim: int
    kind: Kind
    operations: tuple[str, ...]
    categories: tuple[str, ...]
    role: Role

    def __init__(
        self,
        name: str,
        dim: int = 1,
        kind: str | None = None,
        operations: Iterable[str] | None = None,
        categories: Iterable[str] = (),
        role: str | None = None,
    ) -> None:
        _check_name("attribute", name)
        if name == "id":
            raise InputError(
                "an attribute cannot be named 'id', the key of an object's identifier: rename it"
            )
        dim = at_least(f"dim of attribute {name!r}", dim, 1)
        checked = _resolve_kind(name, dim, kind)
        meaning = _resolve_role(name, checked, role)
        chosen = (
            _default_operations(dim, checked, meaning)
            if operations is None
            else _check_operations(name, dim, checked, operations)
        )
        object.__setattr__(self, "name", name)
        object.__setattr__(self, "dim", dim)
        object.__setattr__(self, "kind", checked)
        object.__setattr__(self, "operations", chosen)
        object.__setattr__(self, "categories", _check_categories(name, checked, categories))
        object.__setattr__(self, "role", meaning)

    def with_categories(self, categories: Iterable[str]) -> Attribute:
        """Return the same attribute with other categories."""
        return Attribute(self.name, self.dim, self.kind, self.operations, categories, self.role)

    def to_dict(self) -> dict[str, object]:
        """Return the attribute as plain JSON values."""
        document: dict[str, object] = {
            "name": self.name,
            "dim": self.dim,
            "kind": self.kind,
            "operations": list(self.operations),
        }
        if self.kind == "category":
            document["categories"] = list(self.categories)
        if self.role != _resolve_role(self.name, self.kind, None):
            document["role"] = self.role
        return document

    @classmethod
    def from_dict(cls, document: object) -> Attribute:
        """Read what `to_dict` wrote.

        Raises
        ------
        ModelFormatError
            If the document does not describe an attribute.
        """
        keys: tuple[str, ...] = ("name", "dim", "kind", "operations")
        if isinstance(document, dict) and document.get("kind") == "category":
            keys += ("categories",)
        if isinstance(document, dict) and "role" in document:
            keys += ("role",)
        entries = _entries(document, keys, "attribute")
        name, dim, kind = entries["name"], entries["dim"], entries["kind"]
        if not (isinstance(name, str) and isinstance(dim, int) and isinstance(kind, str)):
            raise ModelFormatError(
                f"not an attribute: {document!r:.200}; expected a name, an integer dim and a kind"
            )
        try:
            return cls(
                name,
                dim,
                kind,
                _strings(entries["operations"], f"operations of attribute {name!r}"),
                _strings(entries.get("categories", []), f"categories of attribute {name!r}"),
                cast("str | None", entries.get("role")),
            )
        except InputError as error:
            raise ModelFormatError(str(error)) from error


@final
@dataclass(frozen=True, slots=True)
class Relation:
    """What two objects of a scene may stand in, such as contact: it is given, not computed from attributes.

    Parameters
    ----------
    name : str
        A verb in the third person, as in "C touches D": ``"touches"``, ``"is bonded to"``, ``"passes to"``.
    directed : bool
        Whether "C passes to D" differs from "D passes to C". By default, whichever object is named first, the
        other one stands in the relation to it as well.

    Raises
    ------
    InputError
        If the name is empty or not printable.
    """

    name: str
    directed: bool = False

    def __post_init__(self) -> None:
        _check_name("relation", self.name)
        if not isinstance(self.directed, bool):
            raise InputError(f"directed of relation {self.name!r} must be True or False: {self.directed!r}")

    def to_dict(self) -> dict[str, object]:
        """Return the relation as plain JSON values."""
        return {"name": self.name, "directed": self.directed}

    @classmethod
    def from_dict(cls, document: object) -> Relation:
        """Read what `to_dict` wrote; `ModelFormatError` if the document does not describe a relation."""
        name, directed = _entries(document, ("name", "directed"), "relation").values()
        try:
            return cls(cast("str", name), cast("bool", directed))
        except InputError as error:
            raise ModelFormatError(str(error)) from error


@final
@dataclass(frozen=True, slots=True, init=False)
class Schema:
    """The ordered attributes of all objects, the names of the action arguments, and relations of objects.

    Parameters
    ----------
    attributes : iterable of Attribute
        At least one, with different names. Their components are the columns of `Scenes.matrix`, in this
        order.
    parameters : iterable of str
        Names of the arguments that each scene binds to one of its objects (may be empty).
    relations : iterable of Relation or str
        What `Scenes.pairs` contains (may be empty); a plain name is that of a relation without direction.

    Raises
    ------
    InputError
        If attributes are missing or a name occurs twice.
    """

    attributes: tuple[Attribute, ...]
    parameters: tuple[str, ...]
    relations: tuple[Relation, ...]

    def __init__(
        self,
        attributes: Iterable[Attribute],
        parameters: Iterable[str] = (),
        relations: Iterable[Relation | str] = (),
    ) -> None:
        attributes, parameters = tuple(attributes), _name_tuple("argument", parameters)
        if not attributes:
            raise InputError("a schema needs at least one attribute: name what is known about the objects")
        for attribute in attributes:
            if not isinstance(attribute, Attribute):
                raise InputError(f"a schema is made of Attribute values, got {attribute!r}")
        for parameter in parameters:
            _check_name("argument", parameter)
        _check_unique("attribute", [attribute.name for attribute in attributes])
        _check_unique("argument", parameters)
        related = tuple(map(as_relation, _name_tuple("relation", relations)))
        _check_unique("relation", [relation.name for relation in related])
        for relation in related:
            if relation.name in [attribute.name for attribute in attributes]:
                raise InputError(f"an attribute and a relation are named {relation.name!r}: rename one")
        object.__setattr__(self, "attributes", attributes)
        object.__setattr__(self, "parameters", parameters)
        object.__setattr__(self, "relations", related)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the attributes, in order."""
        return tuple(attribute.name for attribute in self.attributes)

    @property
    def width(self) -> int:
        """Number of columns of `Scenes.matrix`: the sum of the attributes' dimensions."""
        return sum(attribute.dim for attribute in self.attributes)

    @property
    def n_parameters(self) -> int:
        """Number of action arguments."""
        return len(self.parameters)

    @property
    def in_words(self) -> str:
        """All names on one line, such as ``"attributes location (2); arguments holder"``."""
        attributes = ", ".join(
            f"{attribute.name} ({attribute.dim if attribute.kind == 'euclidean' else attribute.kind})"
            for attribute in self.attributes
        )
        arguments = f"; arguments {', '.join(self.parameters)}" if self.parameters else ""
        directed = (f"{each.name}{' (directed)' if each.directed else ''}" for each in self.relations)
        relations = f"; relations {', '.join(directed)}" if self.relations else ""
        return f"attributes {attributes}{arguments}{relations}"

    def index(self, name: str) -> int:
        """Return the position of attribute ``name``.

        Raises
        ------
        InputError
            If the attribute does not exist; the message lists the existing ones.
        """
        for position, attribute in enumerate(self.attributes):
            if attribute.name == name:
                return position
        raise InputError(f"no attribute {name!r}: the schema has {', '.join(map(repr, self.names))}")

    def offset(self, name: str) -> int:
        """Return the first column of attribute ``name`` in `Scenes.matrix`."""
        return sum(attribute.dim for attribute in self.attributes[: self.index(name)])

    def columns(self, name: str) -> slice:
        """Return the columns of attribute ``name`` in `Scenes.matrix`."""
        start = self.offset(name)
        return slice(start, start + self[name].dim)

    def attribute_of(self, column: int) -> Attribute:
        """Return the attribute that a column of `Scenes.matrix` belongs to."""
        return next(each for each in self.attributes if column < self.columns(each.name).stop)

    def resembles(self, other: Schema) -> bool:
        """Return whether the other schema is the same, but perhaps for the categories of its attributes."""
        mine, theirs = (
            [each.with_categories(()) if each.kind == "category" else each for each in attributes]
            for attributes in (self.attributes, other.attributes)
        )
        others = self.parameters == other.parameters and self.relations == other.relations
        return mine == theirs and others

    def __getitem__(self, name: str) -> Attribute:
        """Return attribute ``name``; `InputError` if it does not exist."""
        return self.attributes[self.index(name)]

    def __contains__(self, name: object) -> bool:
        """Return whether an attribute has this name."""
        return name in self.names

    def to_dict(self) -> dict[str, object]:
        """Return the schema as plain JSON values."""
        return {
            "attributes": [attribute.to_dict() for attribute in self.attributes],
            "parameters": list(self.parameters),
        } | ({"relations": [each.to_dict() for each in self.relations]} if self.relations else {})

    @classmethod
    def from_dict(cls, document: object) -> Schema:
        """Read what `to_dict` wrote.

        Raises
        ------
        ModelFormatError
            If the document does not describe a schema.
        """
        keys: tuple[str, ...] = ("attributes", "parameters")
        if isinstance(document, dict) and "relations" in document:
            keys += ("relations",)
        attributes, parameters, *given = _entries(document, keys, "schema").values()
        for key, entry in zip(("attributes", "relations"), (attributes, *given), strict=False):
            if not isinstance(entry, list):
                raise ModelFormatError(f"the {key} of a schema must be a list, got {entry!r:.200}")
        relations = map(Relation.from_dict, cast("list[object]", given[0]) if given else ())
        try:
            return cls(
                map(Attribute.from_dict, cast("list[object]", attributes)),
                _strings(parameters, "parameters of the schema"),
                relations,
            )
        except InputError as error:
            raise ModelFormatError(str(error)) from error


def misfit(wanted: Schema, given: Schema) -> str:
    """Say that scenes are not those that a model is for, in full where a few words do not tell why."""
    one, other = wanted.in_words, given.in_words
    if one == other:
        one, other = str(wanted), str(given)
    return f"the model is for scenes with {one}, and these have {other}"


def _check_name(what: str, name: object) -> None:
    if not isinstance(name, str) or not name.strip() or not name.isprintable():
        raise InputError(f"{what} names must be non-empty printable strings, got {name!r}")


def _check_unique(what: str, names: Iterable[str]) -> None:
    seen: set[str] = set()
    for name in names:
        if name in seen:
            raise InputError(f"two {what}s are named {name!r}: give each {what} its own name")
        seen.add(name)


def as_relation(given: object) -> Relation:
    """Return a relation, which may be given by its name."""
    return given if isinstance(given, Relation) else Relation(cast("str", given))


def _name_tuple(what: str, names: Iterable[_Name]) -> tuple[_Name, ...]:
    """Turn names into a tuple; a lone string would otherwise become its letters."""
    if isinstance(names, str):
        raise InputError(
            f"{what} names must be a sequence of strings, got the string {names!r}; write [{names!r}]"
        )
    return tuple(names)


def _resolve_kind(name: str, dim: int, kind: str | None) -> Kind:
    if kind is None:
        return "angle" if name == "orientation" and dim == 1 else "euclidean"
    checked = cast("Kind", one_of(f"kind of attribute {name!r}", kind, KINDS))
    if checked != "euclidean" and dim != 1:
        a = "an angle" if checked == "angle" else "a category"
        raise InputError(
            f"attribute {name!r} is {a} with dim {dim}: {a} has dim 1, name one column per {checked}"
        )
    return checked


def _resolve_role(name: str, kind: Kind, role: str | None) -> Role:
    if role is None:
        return _ROLES_BY_NAME.get(name, "property") if kind == "euclidean" else "property"
    checked = cast("Role", one_of(f"role of attribute {name!r}", role, ROLES))
    if checked != "property" and kind != "euclidean":
        raise InputError(f"attribute {name!r} is of kind {kind}, so it cannot be a {checked}: omit the role")
    return checked


def _default_operations(dim: int, kind: Kind, role: Role) -> tuple[str, ...]:
    if kind != "euclidean":
        return ("identity",) if kind == "angle" else OPERATIONS_BY_KIND[kind]
    if role in _OPERATIONS_BY_ROLE:
        return _OPERATIONS_BY_ROLE[role]
    return ("identity", "distance", "difference") + (PLANAR_OPERATIONS[:2] if dim == 2 else ())


def _check_operations(name: str, dim: int, kind: Kind, operations: Iterable[str]) -> tuple[str, ...]:
    if isinstance(operations, str):
        raise InputError(
            f"operations of attribute {name!r} must be a sequence, got a string; write [{operations!r}]"
        )
    chosen = tuple(
        one_of(f"operations of attribute {name!r}", operation, OPERATION_NAMES) for operation in operations
    )
    _check_unique(f"operation of attribute {name!r}", chosen)
    for operation in chosen:
        if operation not in OPERATIONS_BY_KIND[kind]:
            allowed = ", ".join(OPERATIONS_BY_KIND[kind])
            raise InputError(
                f"attribute {name!r} is of kind {kind} and cannot take part in {operation!r}: choose among "
                f"{allowed}"
            )
        if operation in PLANAR_OPERATIONS and dim != 2:
            raise InputError(f"{operation!r} needs dim 2, but attribute {name!r} has dim {dim}: leave it out")
    return chosen


def _check_categories(name: str, kind: Kind, categories: Iterable[str]) -> tuple[str, ...]:
    if isinstance(categories, str):
        raise InputError(
            f"categories of attribute {name!r} must be a sequence, got a string; write [{categories!r}]"
        )
    chosen = tuple(categories)
    if chosen and kind != "category":
        raise InputError(f"attribute {name!r} has categories, so its kind must be 'category', got {kind!r}")
    for category in chosen:
        if not isinstance(category, str) or not category.isprintable():
            raise InputError(f"categories of attribute {name!r} must be printable strings, got {category!r}")
    _check_unique(f"category of attribute {name!r}", chosen)
    return chosen


def _entries(document: object, keys: tuple[str, ...], what: str) -> dict[str, object]:
    if not isinstance(document, dict) or set(document) != set(keys):
        raise ModelFormatError(
            f"not a {what}: expected an object with the keys {', '.join(keys)}, got {document!r:.200}"
        )
    return {key: document[key] for key in keys}


def _strings(value: object, what: str) -> list[str]:
    if not isinstance(value, list) or not all(isinstance(entry, str) for entry in value):
        raise ModelFormatError(f"{what} must be a list of strings, got {value!r:.200}")
    return value
