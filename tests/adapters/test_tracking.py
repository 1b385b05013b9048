from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from relforest.adapters import scenes_from_tracking
from relforest.support.errors import InputError


class Player:
    """As kloppy's: players are keys."""

    def __init__(self, name: str, ground: str) -> None:
        self.player_id, self.team = name, SimpleNamespace(ground=SimpleNamespace(value=ground))


KIM, LEE = Player("kim", "home"), Player("lee", "away")


def point(x: float, y: float) -> Any:
    return SimpleNamespace(x=x, y=y)


def frame(number: int, ball: Any = None, **places: Any) -> Any:
    data = {
        player: SimpleNamespace(coordinates=places[player.player_id])
        for player in (KIM, LEE)
        if player.player_id in places
    }
    return SimpleNamespace(frame_id=number, players_data=data, ball_coordinates=ball)


def test_players_and_ball_have_places_and_teams_as_far_as_they_are_seen() -> None:
    scenes = scenes_from_tracking(
        [
            frame(7, point(0.5, 0.5), kim=point(0.1, 0.2), lee=point(0.9, 0.8)),
            frame(9, kim=None, lee=point(1, 1)),
        ]
    )
    assert scenes.to_dicts() == [
        {
            "id": 7,
            "objects": [
                {"id": "kim", "location": [0.1, 0.2], "team": "home"},
                {"id": "lee", "location": [0.9, 0.8], "team": "away"},
                {"id": "ball", "location": [0.5, 0.5], "team": "ball"},
            ],
        },
        {"id": 9, "objects": [{"id": "lee", "location": [1.0, 1.0], "team": "away"}]},
    ]


@pytest.mark.parametrize(
    ("frames", "complaint"),
    [
        ([], "at least one frame"),
        ([{"x": 1}], "pass frames of kloppy"),
        ([frame(1, point(0, 0)), frame(1, point(0, 0))], "two frames have the id 1"),
        ([frame(1, kim=None)], "nobody is seen in frame 1"),
    ],
)
def test_what_is_no_frame_or_empty_is_refused(frames: list[Any], complaint: str) -> None:
    with pytest.raises(InputError, match=complaint):
        scenes_from_tracking(frames)


def test_frames_of_kloppy_itself() -> None:
    domain = pytest.importorskip("kloppy.domain")
    team = domain.Team(team_id="h", name="H", ground=domain.Ground.HOME)
    player = domain.Player(player_id="p1", team=team, jersey_no=1)
    period = domain.Period(id=1, start_timestamp=0.0, end_timestamp=1.0)
    seen = domain.Frame(
        frame_id=3,
        timestamp=0.0,
        period=period,
        ball_owning_team=None,
        ball_state=None,
        players_data={player: domain.PlayerData(coordinates=domain.Point(x=1.0, y=2.0))},
        other_data={},
        ball_coordinates=domain.Point3D(x=3.0, y=4.0, z=0.0),
        statistics=[],
    )
    assert scenes_from_tracking([seen]).to_dicts()[0]["objects"][0] == {
        "id": "p1", "location": [1.0, 2.0], "team": "home",
    }  # fmt: skip
