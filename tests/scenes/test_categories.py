"""Categories: from tables, dictionaries and Parquet, and matched by name with those of a model."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

from relforest.scenes import Attribute, Scenes, Schema, read_table
from relforest.support.errors import InputError

TEAM = Attribute("team", kind="category")


def frame(teams: list[Any]) -> pd.DataFrame:
    return pd.DataFrame({"scene": [1] * len(teams), "player": range(len(teams)), "team": teams})


def read(teams: list[Any], attribute: Attribute = TEAM) -> Scenes:
    return Scenes.from_frame(frame(teams), scene="scene", object="player", attributes={attribute: "team"})


@pytest.mark.parametrize(
    ("teams", "categories", "places"),
    [
        (["home", "guest", None, "home"], ("guest", "home"), [1, 0, np.nan, 1]),
        # A null turns whole numbers into floats; whole numbers are sorted by value.
        ([10.0, 9.0, np.nan, 10.0], ("9", "10"), [1, 0, np.nan, 1]),
        ([True, False, True, True], ("False", "True"), [1, 0, 1, 1]),
        (["07", "7", "a", "7"], ("07", "7", "a"), [0, 1, 2, 1]),
    ],
)
def test_categories_of_a_column(teams: list[Any], categories: tuple[str, ...], places: list[float]) -> None:
    scenes = read(teams)

    assert scenes.schema["team"].categories == categories
    assert np.array_equal(scenes.matrix[:, 0], places, equal_nan=True)
    names = [None if np.isnan(place) else categories[int(place)] for place in places]
    assert [entry.get("team") for entry in scenes.to_dicts()[0]["objects"]] == names


def test_given_categories_keep_their_order_and_refuse_others() -> None:
    known = Attribute("team", kind="category", categories=["home", "guest"])

    assert read(["guest", "home"], known).matrix[:, 0].tolist() == [1, 0]
    with pytest.raises(InputError, match="'team' is 'away' in column 'team', scene 1, object 1, which is"):
        read(["guest", "away"], known)


def test_dictionaries_round_trip() -> None:
    schema = Schema([TEAM, Attribute("place", 2)])
    records: list[dict[str, Any]] = [
        {"objects": [{"team": "b", "place": [0.0, 1.0]}, {"team": "a"}]},
        {"objects": [{"team": 3}]},
    ]
    scenes = Scenes.from_dicts(records, schema)

    assert scenes.schema["team"].categories == ("3", "a", "b")
    assert Scenes.from_dicts(scenes.to_dicts(), scenes.schema) == scenes
    with pytest.raises(InputError, match="'team' is \\[1\\], which is not a category"):
        Scenes.from_dicts([{"objects": [{"team": [1]}]}], schema)
    with pytest.raises(InputError, match="declare the attribute with kind='category'"):
        Scenes.from_dicts([{"objects": [{"team": "a"}]}])


def test_files_round_trip(tmp_path: Path) -> None:
    scenes = read(["home", None, "guest", "home"])
    scenes.to_parquet(tmp_path / "scenes.parquet")
    table = read_table(tmp_path / "scenes.parquet")

    assert Scenes.from_parquet(tmp_path / "scenes.parquet") == scenes
    assert table["team"].to_pylist() == ["home", None, "guest", "home"]
    text = read_table(io.BytesIO(b"scene,player,team\n1,a,home\n1,b,\n1,c,guest\n"))
    from_text = Scenes.from_frame(text, scene="scene", object="player", attributes={TEAM: "team"})
    assert from_text.matrix[:, 0].tolist()[::2] == [1, 0]


def test_a_schema_with_categories_is_read_back() -> None:
    schema = Schema([Attribute("team", kind="category", categories=["home", "guest"])])

    assert Schema.from_dict(schema.to_dict()) == schema


def test_scenes_take_the_categories_of_a_model_by_name() -> None:
    learned = read(["home", "guest", "referee"]).schema
    scenes = read(["home", None, "referee"])

    recoded = scenes.recoded(learned)

    assert recoded.schema == learned
    assert recoded.to_dicts() == scenes.to_dicts()
    with pytest.raises(InputError, match="object 0 has the team 'away', which the model has never seen"):
        read(["away"]).recoded(learned)
    with pytest.raises(InputError, match="the model is for scenes with"):
        scenes.recoded(Schema([Attribute("weight")]))


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"categories": "ab"}, "must be a sequence, got a string"),
        ({"categories": ["a", "a"]}, "two category"),
        ({"categories": ["a", 1]}, "must be printable strings"),
        ({"dim": 2}, "a category has dim 1"),
        ({"operations": ["distance"]}, "of kind category and cannot take part in 'distance'"),
    ],
)
def test_impossible_categories_are_refused(arguments: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        Attribute("team", kind="category", **arguments)


def test_numbers_that_are_no_categories_are_refused() -> None:
    schema = Schema([Attribute("team", kind="category", categories=["home", "guest"])])

    with pytest.raises(InputError, match="has the category 2 of 'team'"):
        Scenes(schema, np.array([[0.0], [2.0]]), np.arange(2), np.array([0]), np.array([2]))
    with pytest.raises(InputError, match="has categories, so its kind must be 'category'"):
        Attribute("team", categories=["home"])
