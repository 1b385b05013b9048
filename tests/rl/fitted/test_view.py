from __future__ import annotations

import numpy as np
import pytest

from relforest import Attribute, Schema
from relforest.rl.fitted.view import View
from relforest.scenes.color import srgb_to_lab
from relforest.support.errors import ModelFormatError

WORLD = Schema((Attribute("location", 2), Attribute("color", 3), Attribute("size")))


def objects() -> np.ndarray:
    rng = np.random.default_rng(0)
    matrix = np.column_stack([rng.random((20, 2)), np.zeros((20, 3)), rng.random(20)])
    matrix[::2, 2] = 1.0  # every other object is red
    matrix[5, 2:5] = np.nan
    return matrix


def test_attributes_of_few_values_are_categories() -> None:
    view = View.of(WORLD, objects(), 6)
    (location, color, size) = view.attributes
    assert [name for name, _ in view.values] == ["color"]
    assert (color.kind, color.categories) == ("category", ("(0, 0, 0)", "(1, 0, 0)"))
    assert set(location.operations) >= {"identity", "distance", "difference"}
    assert size.operations == ("identity", "distance", "difference")


def test_objects_belong_to_the_nearest_category() -> None:
    view = View.of(WORLD, objects(), 6)
    matrix = objects()
    matrix[0, 2:5] = 0.9, 0.2, 0.1
    seen = view.seen(matrix)
    assert seen.shape == (20, 4)
    np.testing.assert_array_equal(seen[:, [0, 1, 3]], matrix[:, [0, 1, 5]])
    assert seen[:4, 2].tolist() == [1.0, 0.0, 1.0, 0.0]
    assert np.isnan(seen[5, 2])


def test_an_attribute_of_one_value_or_many_stays_as_it_is() -> None:
    same = objects()
    same[:, 2:5] = 0.0
    assert View.of(WORLD, same, 6).values == ()
    assert View.of(WORLD, objects(), 1).values == ()


def test_other_colors_are_seen_as_they_look() -> None:
    matrix = objects()
    matrix[:, 2:5] = np.random.default_rng(1).random((20, 3))
    matrix[5, 2:5] = np.nan
    view = View.of(WORLD, matrix, 6)
    assert (view.values, view.colors) == ((), ("color",))
    seen = view.seen(matrix)
    np.testing.assert_array_equal(seen[:, 2:5], srgb_to_lab(matrix[:, 2:5]))
    np.testing.assert_array_equal(np.delete(seen, (2, 3, 4), axis=1), np.delete(matrix, (2, 3, 4), axis=1))
    # Numbers from 0 to 255 may be in any unit, so they stay.
    assert View.of(WORLD, matrix * 255.0, 6).colors == ()


@pytest.mark.parametrize("most", [1, 6])
def test_the_json_form_is_read_back(most: int) -> None:
    view = View.of(WORLD, objects(), most)
    again = View.from_dict(view.to_dict())
    assert again.attributes == view.attributes
    np.testing.assert_array_equal(again.seen(objects()), view.seen(objects()))


@pytest.mark.parametrize(
    "values", [{"color": [[0.0, 1.0]]}, {"color": []}, {"weight": [[1.0]]}, {"color": 3}, []]
)
def test_damaged_documents_are_named(values: object) -> None:
    document = View.of(WORLD, objects(), 6).to_dict() | {"values": values}
    with pytest.raises(ModelFormatError, match="view"):
        View.from_dict(document)


@pytest.mark.parametrize("colors", [["location"], ["weight"], 3])
def test_colors_that_are_none_are_refused(colors: object) -> None:
    document = View.of(WORLD, objects(), 6).to_dict() | {"colors": colors}
    with pytest.raises(ModelFormatError, match="view"):
        View.from_dict(document)
