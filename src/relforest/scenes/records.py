"""Scenes from and to plain dictionaries, as read from JSON."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from decimal import Decimal
from numbers import Real
from typing import Any, NamedTuple, cast

import numpy as np

from relforest.scenes.arrays import FloatArray, SceneArrays, compact, occurrences
from relforest.scenes.attribute_columns import category_text, closed, place_of
from relforest.scenes.ids import as_ids, plain
from relforest.scenes.relations import with_pairs
from relforest.scenes.schema import Attribute, Schema
from relforest.support.errors import InputError

_RECORD_KEYS = ("id", "objects", "arguments", "relations")
CATEGORY_HINT = " (for names, declare the attribute with kind='category')"


class _Record(NamedTuple):
    """One scene as given."""

    scene_id: object
    objects: tuple[Mapping[str, object], ...]
    object_ids: tuple[object, ...]
    arguments: Mapping[str, object]
    relations: Mapping[str, object]

    @property
    def name(self) -> str:
        return f"scene {plain(self.scene_id)!r}"


def arrays_from_dicts(records: Iterable[Mapping[str, Any]], schema: Schema | None) -> SceneArrays:
    """Read scenes from dictionaries; see `Scenes.from_dicts`."""
    scenes = _read_records(records)
    scene_ids = as_ids("scene ids", [scene.scene_id for scene in scenes])
    object_ids = as_ids("object ids", [each for scene in scenes for each in scene.object_ids])
    if schema is None:
        schema = _infer_schema(scenes)
    closed = [_closed(attribute, scenes) for attribute in schema.attributes]
    schema = Schema(closed, schema.parameters, schema.relations)
    known = {attribute.name: (attribute, schema.columns(attribute.name)) for attribute in schema.attributes}
    counts = np.array([len(scene.objects) for scene in scenes], dtype=np.int64)
    starts = np.cumsum(counts) - counts
    matrix = np.full((int(counts.sum()), schema.width), np.nan)
    arguments = np.full((len(scenes), schema.n_parameters), -1, dtype=np.int64)
    pairs: list[list[list[int]]] = [[] for _ in schema.relations]
    for position, (scene, start) in enumerate(zip(scenes, starts.tolist(), strict=True)):
        for offset, entry in enumerate(scene.objects):
            _fill_row(
                matrix[start + offset], entry, known, f"{scene.name}, object {scene.object_ids[offset]!r}"
            )
        rows = _rows(scene, start)
        arguments[position] = _bind(scene, rows, schema.parameters)
        for own, found in zip(pairs, _related(scene, rows, schema), strict=True):
            own += [[position, *pair] for pair in found]
    parts = SceneArrays(
        schema, matrix, np.arange(len(matrix)), starts, counts, arguments, scene_ids, object_ids
    )
    return with_pairs(parts, [np.array(own, dtype=np.int64).reshape(-1, 3) for own in pairs])


def arrays_to_dicts(parts: SceneArrays) -> list[dict[str, Any]]:
    """Write scenes as dictionaries; see `Scenes.to_dicts`."""
    parts = compact(parts)
    related: list[dict[str, list[list[object]]]] = [
        {relation.name: [] for relation in parts.schema.relations} for _ in parts.starts
    ]
    places, _, numbers = occurrences(parts)
    scenes = np.repeat(np.arange(len(parts.starts)), parts.counts)[places]
    for scene, (number, *pair) in zip(scenes.tolist(), parts.pairs[numbers].tolist(), strict=True):
        relation = parts.schema.relations[number]
        if relation.directed or pair[0] < pair[1]:
            related[scene][relation.name].append([plain(parts.object_ids[row]) for row in pair])
    objects = [
        {"id": plain(each)} | _defined_values(parts.schema, row)
        for each, row in zip(parts.object_ids, parts.matrix, strict=True)
    ]
    documents = []
    for position, start in enumerate(parts.starts.tolist()):
        rows = parts.rows[start : start + parts.counts[position]].tolist()
        document: dict[str, Any] = {
            "id": plain(parts.scene_ids[position]),
            "objects": [dict(objects[row]) for row in rows],
        }
        if parts.schema.parameters:
            bound = zip(parts.schema.parameters, parts.arguments[position].tolist(), strict=True)
            document["arguments"] = {
                name: None if row < 0 else plain(parts.object_ids[row]) for name, row in bound
            }
        if parts.schema.relations:
            document["relations"] = related[position]
        documents.append(document)
    return documents


def _defined_values(schema: Schema, row: FloatArray) -> dict[str, Any]:
    """Return the attributes of one object with a defined component; undefined components are None."""
    values: dict[str, Any] = {}
    for attribute in schema.attributes:
        components = row[schema.columns(attribute.name)].tolist()
        numbers = [None if math.isnan(component) else component for component in components]
        if attribute.kind == "category" and numbers[0] is not None:
            values[attribute.name] = attribute.categories[int(numbers[0])]
        elif any(number is not None for number in numbers):
            values[attribute.name] = numbers[0] if attribute.dim == 1 else numbers
    return values


def _read_records(records: Iterable[Mapping[str, Any]]) -> list[_Record]:
    if isinstance(records, (str, bytes, Mapping)) or not isinstance(records, Iterable):
        raise InputError(f"expected a list with one dictionary per scene, got {type(records).__name__}")
    given = list(records)
    if not given:
        raise InputError("the list of scenes is empty: at least one is needed")
    for position, record in enumerate(given):
        if not isinstance(record, Mapping) or not isinstance(record.get("objects"), Sequence):
            raise InputError(
                f"scene number {position} must be a dictionary with a list of 'objects', got {record!r:.100}"
            )
        unknown = [key for key in record if key not in _RECORD_KEYS]
        if unknown:
            raise InputError(
                f"scene number {position} has the key {unknown[0]!r}: known are {', '.join(_RECORD_KEYS)}"
            )
    _all_or_none("scenes", [record.get("id") is not None for record in given])
    scenes = [_read_record(position, record) for position, record in enumerate(given)]
    _all_or_none("objects", [entry.get("id") is not None for scene in scenes for entry in scene.objects])
    return scenes


def _read_record(position: int, record: Mapping[str, Any]) -> _Record:
    scene_id = position if record.get("id") is None else record["id"]
    objects, arguments = tuple(record["objects"]), record.get("arguments")
    for entry in objects:
        if not isinstance(entry, Mapping):
            raise InputError(
                f"scene {scene_id!r} has the object {entry!r:.100}: an object is a dictionary of attributes"
            )
    arguments = {} if arguments is None else arguments
    if not isinstance(arguments, Mapping):
        raise InputError(
            f"the arguments of scene {scene_id!r} must map names to object ids, got {arguments!r:.100}"
        )
    relations = {} if record.get("relations") is None else record["relations"]
    if not isinstance(relations, Mapping):
        raise InputError(
            f"the relations of scene {scene_id!r} must map names to pairs of object ids, got "
            f"{relations!r:.100}"
        )
    ids = tuple(offset if entry.get("id") is None else entry["id"] for offset, entry in enumerate(objects))
    return _Record(scene_id, objects, ids, arguments, relations)


def _all_or_none(what: str, have_id: list[bool]) -> None:
    if any(have_id) and not all(have_id):
        raise InputError(f"some {what} have an 'id' and some do not: give all of them one, or none")


def _infer_schema(scenes: list[_Record]) -> Schema:
    """Take all names in order of first appearance, dimensions from the first value."""
    found: dict[str, Attribute | None] = {}
    parameters: dict[str, None] = {}
    relations: dict[str, None] = {}
    for scene in scenes:
        parameters.update(dict.fromkeys(scene.arguments))
        relations.update(dict.fromkeys(scene.relations))
        for entry in scene.objects:
            for name, value in entry.items():
                if name != "id" and found.get(name) is None:
                    found[name] = None if value is None else Attribute(name, max(len(_components(value)), 1))
    for name, attribute in found.items():
        if attribute is None:
            raise InputError(
                f"attribute {name!r} is undefined in all scenes, so its dim is unknown: pass schema="
            )
    if not found:
        raise InputError("the objects lack attributes, so the schema is unknown: pass schema=")
    return Schema([each for each in found.values() if each is not None], parameters, relations)


def _components(value: object) -> list[object]:
    if isinstance(value, np.ndarray):
        return list(np.atleast_1d(value))
    return list(value) if isinstance(value, Sequence) and not isinstance(value, str) else [value]


def _fill_row(
    row: FloatArray, entry: Mapping[str, object], known: Mapping[str, tuple[Attribute, slice]], where: str
) -> None:
    for name, value in entry.items():
        if name == "id" or value is None:
            continue
        if name not in known:
            raise InputError(
                f"{where} has the unknown attribute {name!r}: the schema has {', '.join(map(repr, known))}"
            )
        attribute, columns = known[name]
        numbers = _components(value)
        if len(numbers) != attribute.dim:
            raise InputError(
                f"{where}: {name!r} has {len(numbers)} components, but its dim is {attribute.dim}"
            )
        if attribute.kind == "category":
            row[columns] = place_of(_category(value, name, where), attribute, where)
        else:
            row[columns] = [_number(number, name, where) for number in numbers]


def _closed(attribute: Attribute, scenes: list[_Record]) -> Attribute:
    """Return an attribute with the categories of the data, if it is a category without a list."""
    if attribute.kind != "category" or attribute.categories:
        return attribute
    values = (entry.get(attribute.name) for scene in scenes for entry in scene.objects)
    texts = {_category(value, attribute.name, "a scene") for value in values if value is not None}
    return closed(attribute, texts)


def _category(value: object, name: str, where: str) -> str:
    text = category_text(value)
    if text is None:
        raise InputError(
            f"{where}: {name!r} is {value!r:.100}, which is not a category: use text, None if undefined"
        )
    return text


def _number(value: object, name: str, where: str) -> float:
    if value is None:
        return np.nan
    if not isinstance(value, (Real, Decimal, np.bool_)):
        raise InputError(
            f"{where}: {name!r} is {value!r:.100}, which is not a number: use numbers, None if undefined"
            f"{CATEGORY_HINT if isinstance(value, str) else ''}"
        )
    try:
        number = float(value)
    except OverflowError:  # an integer of more than 300 digits
        number = np.inf
    if np.isinf(number):
        raise InputError(f"{where}: {name!r} is infinite: use None where a value is undefined")
    return number


def _rows(scene: _Record, start: int) -> dict[object, int]:
    """Return the object rows of one scene by identifier."""
    rows: dict[object, int] = {}
    for offset, each in enumerate(scene.object_ids):
        if rows.setdefault(each, start + offset) != start + offset:
            raise InputError(
                f"object {each!r} occurs twice in {scene.name}: the ids of a scene's objects must differ"
            )
    return rows


def _bind(scene: _Record, rows: dict[object, int], parameters: tuple[str, ...]) -> list[int]:
    """Return the object rows bound to the parameters in one scene."""
    unknown = [name for name in scene.arguments if name not in parameters]
    if unknown:
        raise InputError(
            f"{scene.name} has the unknown argument {unknown[0]!r}: the schema has "
            f"{', '.join(map(repr, parameters)) or 'none'}"
        )
    for name, value in scene.arguments.items():
        if value is not None and not _is_one_of(value, rows):
            raise InputError(
                f"argument {name!r} of {scene.name} is {value!r}, which is not an object of that scene (it "
                f"has {', '.join(repr(each) for each in rows) or 'none'}): use the id of one of them, or None"
            )
    bound = (scene.arguments.get(name) for name in parameters)
    return [-1 if value is None else rows[value] for value in bound]


def _related(scene: _Record, rows: dict[object, int], schema: Schema) -> Iterator[list[list[int]]]:
    """Yield the pairs of object rows of each relation in one scene."""
    known = [relation.name for relation in schema.relations]
    for name, pairs in scene.relations.items():
        if name not in known:
            raise InputError(
                f"{scene.name} has the unknown relation {name!r}: the schema has "
                f"{', '.join(map(repr, known)) or 'none'}"
            )
        if not isinstance(pairs, Sequence):
            raise InputError(f"{scene.name}: {name!r} must be a list of pairs of ids, got {pairs!r:.100}")
        for pair in pairs:
            is_pair = isinstance(pair, Sequence) and not isinstance(pair, str) and len(pair) == 2
            if not is_pair or not all(_is_one_of(each, rows) for each in pair):
                raise InputError(
                    f"{scene.name}: {name!r} has {pair!r:.100}, which is not two objects of that scene (it "
                    f"has {', '.join(repr(each) for each in rows) or 'none'}): use their ids"
                )
    for name in known:
        found = cast("Sequence[Sequence[object]]", scene.relations.get(name, ()))
        yield [[rows[each] for each in pair] for pair in found]


def _is_one_of(value: object, rows: dict[object, int]) -> bool:
    is_id = isinstance(value, (int, np.integer, str)) and not isinstance(value, bool)
    return is_id and value in rows
