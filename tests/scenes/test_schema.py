from __future__ import annotations

import json
from typing import Any

import pytest
from hypothesis import given

from relforest.scenes import OPERATION_NAMES, Attribute, Schema
from relforest.scenes.schema import misfit
from relforest.support.errors import InputError, ModelFormatError
from strategies import schemas


@pytest.mark.parametrize(
    ("name", "dim", "operations"),
    [
        ("location", 1, ("identity", "distance", "difference")),
        ("location", 2, OPERATION_NAMES[:5]),
        ("location", 3, ("identity", "distance", "difference")),
        ("color", 3, ("identity", "difference")),
        ("colour", 3, ("identity", "difference")),
        ("extent", 2, ("identity",)),
        ("extent_ratio", 1, ("identity",)),
        ("orientation", 1, ("identity",)),
    ],
)
def test_default_operations_are_the_functions_of_section_4_3(
    name: str, dim: int, operations: tuple[str, ...]
) -> None:
    assert Attribute(name, dim).operations == operations


def test_only_a_single_number_named_orientation_is_an_angle_by_default() -> None:
    assert Attribute("orientation").kind == "angle"
    assert Attribute("orientation", 2).kind == "euclidean"
    assert Attribute("orientation", kind="euclidean").kind == "euclidean"
    assert Attribute("heading", kind="angle").operations == ("identity",)


def test_operations_may_be_chosen() -> None:
    assert Attribute("location", 2, operations=["reframe"]).operations == ("reframe",)
    assert Attribute("heading", kind="angle", operations=["difference"]).operations == ("difference",)
    assert Attribute("weight", operations=[]).operations == ()


def test_attributes_are_values() -> None:
    assert Attribute("location", 2) == Attribute("location", 2, "euclidean", OPERATION_NAMES[:5])
    assert len({Attribute("location", 2), Attribute("location", 2), Attribute("location", 3)}) == 2


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"name": ""}, "names must be non-empty printable strings, got ''"),
        ({"name": "a\nb"}, "names must be non-empty printable"),
        ({"name": 3}, "names must be non-empty printable strings, got 3"),
        ({"name": "id"}, "cannot be named 'id'"),
        ({"name": "x", "dim": 0}, "dim of attribute 'x' must be an integer of at least 1, got 0"),
        ({"name": "x", "dim": True}, "dim of attribute 'x'"),
        ({"name": "x", "kind": "circle"}, "kind of attribute 'x' must be one of 'euclidean', 'angle'"),
        ({"name": "x", "dim": 2, "kind": "angle"}, "'x' is an angle with dim 2: an angle has dim 1"),
        ({"name": "x", "operations": "identity"}, r"must be a sequence, got a string; write \['identity'\]"),
        ({"name": "x", "operations": ["rotate"]}, "operations of attribute 'x' must be one of 'identity'"),
        ({"name": "x", "operations": ["identity", "identity"]}, "are named 'identity'"),
        ({"name": "x", "dim": 3, "operations": ["reframe"]}, "'reframe' needs dim 2, but .* has dim 3"),
        (
            {"name": "x", "kind": "angle", "operations": ["distance"]},
            "of kind angle and cannot take part in 'distance'",
        ),
    ],
)
def test_impossible_attributes_are_refused(arguments: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        Attribute(**arguments)


def test_a_schema_lays_attributes_side_by_side() -> None:
    schema = Schema([Attribute("location", 2), Attribute("orientation"), Attribute("color", 3)], ["passer"])

    assert schema.width == 6
    assert [schema.offset(name) for name in schema.names] == [0, 2, 3]
    assert [schema.index(name) for name in schema.names] == [0, 1, 2]
    assert schema.columns("color") == slice(3, 6)
    assert schema["orientation"].kind == "angle"
    assert "color" in schema
    assert "weight" not in schema
    assert schema.n_parameters == 1


def test_an_unknown_name_lists_those_that_exist() -> None:
    with pytest.raises(InputError, match="no attribute 'colour': the schema has 'location', 'color'"):
        Schema([Attribute("location", 2), Attribute("color", 3)]).index("colour")


@pytest.mark.parametrize(
    ("attributes", "parameters", "message"),
    [
        ([], [], "needs at least one attribute"),
        (["location"], [], "made of Attribute values, got 'location'"),
        ([Attribute("x"), Attribute("x", 2)], [], "two attributes are named 'x'"),
        ([Attribute("x")], ["a", "a"], "two arguments are named 'a'"),
        ([Attribute("x")], [""], "argument names must be non-empty"),
        ([Attribute("x")], "passer", r"got the string 'passer'; write \['passer'\]"),
    ],
)
def test_impossible_schemas_are_refused(attributes: Any, parameters: Any, message: str) -> None:
    with pytest.raises(InputError, match=message):
        Schema(attributes, parameters)


@given(schema=schemas())
def test_a_schema_survives_json(schema: Schema) -> None:
    assert Schema.from_dict(json.loads(json.dumps(schema.to_dict()))) == schema


GOOD = Schema([Attribute("location", 2)], ["passer"]).to_dict()
ATTRIBUTE = Attribute("location", 2).to_dict()


@pytest.mark.parametrize(
    ("document", "message"),
    [
        (None, "not a schema"),
        ([], "not a schema"),
        ({"attributes": []}, "expected an object with the keys attributes, parameters"),
        (GOOD | {"more": 1}, "not a schema"),
        (GOOD | {"attributes": {}}, "attributes of a schema must be a list"),
        (GOOD | {"attributes": []}, "at least one attribute"),
        (GOOD | {"attributes": [3]}, "not a attribute|not an attribute"),
        (GOOD | {"parameters": "ab"}, "parameters of the schema must be a list of strings"),
        (GOOD | {"parameters": [1]}, "must be a list of strings"),
        (GOOD | {"parameters": ["a", "a"]}, "two arguments are named"),
        (GOOD | {"attributes": [ATTRIBUTE | {"dim": 1.5}]}, "not an attribute"),
        (GOOD | {"attributes": [ATTRIBUTE | {"dim": -1}]}, "at least 1, got -1"),
        (GOOD | {"attributes": [ATTRIBUTE | {"operations": [["x"]]}]}, "must be a list of strings"),
        (GOOD | {"attributes": [ATTRIBUTE | {"operations": ["x"]}]}, "must be one of"),
    ],
)
def test_documents_that_are_no_schema_are_refused(document: object, message: str) -> None:
    with pytest.raises(ModelFormatError, match=message):
        Schema.from_dict(document)


def test_what_an_attribute_means_is_its_role() -> None:
    place = Attribute("place", 2, role="location")
    paint = Attribute("paint", 3, role="color")

    assert (Attribute("location", 2).role, Attribute("colour", 3).role) == ("location", "color")
    assert (Attribute("speed").role, Attribute("orientation").role) == ("property", "property")
    assert Attribute("location", 2, role="property").operations == place.operations
    assert paint.operations == ("identity", "difference")
    for attribute in (place, paint, Attribute("location", 2), Attribute("location", 2, role="property")):
        assert Attribute.from_dict(attribute.to_dict()) == attribute
    assert "role" not in Attribute("location", 2).to_dict()
    with pytest.raises(InputError, match="role of attribute 'a' must be one of"):
        Attribute("a", role="place")
    with pytest.raises(InputError, match="attribute 'team' is of kind category, so it cannot be a color"):
        Attribute("team", kind="category", role="color")


def test_schemas_are_told_apart_in_few_words() -> None:
    one = Schema([Attribute("location", 2), Attribute("team", kind="category")], ["holder"])

    assert one.in_words == "attributes location (2), team (category); arguments holder"
    assert misfit(one, Schema([Attribute("x")])) == (
        f"the model is for scenes with {one.in_words}, and these have attributes x (1)"
    )


def test_schemas_that_differ_in_details_are_told_in_full() -> None:
    one, other = (Schema([Attribute("x", operations=[name])]) for name in ("identity", "distance"))

    assert misfit(one, other) == f"the model is for scenes with {one}, and these have {other}"
