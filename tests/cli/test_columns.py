from __future__ import annotations

import pytest

from relforest.cli.columns import parse_attributes, parse_names, parse_relations
from relforest.scenes import Attribute, Relation
from relforest.support.errors import InputError


def test_attributes_are_read_from_their_short_form() -> None:
    assert parse_attributes(
        ["location=x, y", "heading=theta:angle", "orientation=o", "h=h:euclidean", "at=u,v:location"]
    ) == {
        Attribute("location", 2): ("x", "y"),
        Attribute("heading", 1, "angle"): ("theta",),
        Attribute("orientation", 1, "angle"): ("o",),
        Attribute("at", 2, role="location"): ("u", "v"),
        Attribute("h", 1, "euclidean"): ("h",),
    }


@pytest.mark.parametrize("text", ["location", "=x", "location=", "location=x,,y", "location=:angle", ""])
def test_other_forms_are_refused(text: str) -> None:
    with pytest.raises(InputError, match="is not understood: write NAME=COLUMN"):
        parse_attributes([text])


def test_impossible_kinds_are_refused() -> None:
    with pytest.raises(InputError, match="unknown kind or role 'degrees': write one of euclidean, angle"):
        parse_attributes(["theta=t:degrees"])
    with pytest.raises(InputError, match="angle with dim 2"):
        parse_attributes(["theta=s,c:angle"])


def test_an_attribute_is_given_once() -> None:
    with pytest.raises(InputError, match="attribute 'extent' is given twice: give each attribute once"):
        parse_attributes(["extent=x", "extent=x"])


def test_relations_are_read_from_their_short_form() -> None:
    assert parse_relations(["touches=contacts", "passes to = to :directed"]) == {
        Relation("touches"): "contacts",
        Relation("passes to", directed=True): "to",
    }
    for text in ("touches", "=x", "touches=", "touches=:directed", ""):
        with pytest.raises(
            InputError, match="is not understood: write NAME=COLUMN, such as touches=contacts"
        ):
            parse_relations([text])
    with pytest.raises(InputError, match="relation 'touches' is given twice"):
        parse_relations(["touches=x", "touches=y:directed"])


def test_names_are_separated_by_commas() -> None:
    assert parse_names("passer, receiver") == ("passer", "receiver")
    assert parse_names(" ") == ()
