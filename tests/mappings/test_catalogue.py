from __future__ import annotations

import pytest

from relforest.mappings import catalogue
from relforest.scenes import Attribute, Schema


def names(*attributes: Attribute) -> list[str]:
    return [mapping.name for mapping in catalogue(Schema(attributes))]


def test_the_ten_functions_of_section_4_3() -> None:
    found = names(
        Attribute("location", 2),
        Attribute("color", 3),
        Attribute("extent", 2),
        Attribute("extent_ratio"),
        Attribute("orientation"),
    )

    assert found == [
        "identity(location)",
        "distance(location)",
        "difference(location)",
        "reframe(location)",
        "scaled_reframe(location)",
        "identity(color)",
        "difference(color)",
        "identity(extent)",
        "identity(extent_ratio)",
        "identity(orientation)",
    ]


@pytest.mark.parametrize("dim", [1, 3])
def test_frames_need_the_plane(dim: int) -> None:
    assert names(Attribute("location", dim)) == [
        "identity(location)",
        "distance(location)",
        "difference(location)",
    ]


def test_operations_follow_the_attribute_and_its_order() -> None:
    chosen = Attribute("color", 3, operations=("distance", "identity"))

    assert names(chosen) == ["distance(color)", "identity(color)"]


def test_an_attribute_may_take_part_in_nothing() -> None:
    assert names(Attribute("weight", operations=())) == []


def test_dimension_and_space_of_each_codomain() -> None:
    schema = Schema((Attribute("location", 2), Attribute("color", 3), Attribute("orientation")))
    found = {mapping.name: (mapping.arity, mapping.dim, mapping.space) for mapping in catalogue(schema)}

    assert found == {
        "identity(location)": (1, 2, "euclidean"),
        "distance(location)": (2, 1, "euclidean"),
        "difference(location)": (2, 2, "euclidean"),
        "reframe(location)": (3, 2, "euclidean"),
        "scaled_reframe(location)": (3, 2, "euclidean"),
        "identity(color)": (1, 3, "euclidean"),
        "difference(color)": (2, 3, "euclidean"),
        "identity(orientation)": (1, 1, "circle"),
    }
