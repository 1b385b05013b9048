from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from relforest.rl.baselines import (
    DenseFeatures,
    SarsaLambda,
    SarsaSettings,
    TileCoding,
    make_team,
    read_team,
    write_team,
)
from relforest.rl.baselines.sarsa_file import MODEL
from relforest.support.errors import InputError, ModelFormatError
from relforest.support.files import write_npz

TILES = TileCoding([1.0, 2.0], 3, tilings=4, upper=5.0)
SETTINGS = SarsaSettings(alpha=0.5, epsilon=0.2, trace_decay=0.5)

Team = tuple[SarsaLambda[Any], ...]


def play(team: Team, seed: int) -> list[int]:
    rng = np.random.default_rng(seed)
    actions = []
    for agent in team:
        actions.append(agent.start(rng.uniform(0, 5, 2)))
        actions += [agent.step(rng.normal(), 1.0, rng.uniform(0, 5, 2)) for _ in range(10)]
        agent.end(1.0)
    return actions


def a_team(*, shared: bool = False) -> Team:
    team = make_team(TILES, 3, SETTINGS, shared=shared, random_state=0)
    play(team, 1)
    return team


def weights_file(folder: Path) -> Path:
    (path,) = folder.glob("*.npz")
    return path


def edit(folder: Path, **changes: Any) -> None:
    document = json.loads((folder / MODEL).read_text("utf-8"))
    (folder / MODEL).write_text(json.dumps(document | changes), "utf-8")


@pytest.mark.parametrize("shared", [False, True])
def test_a_team_survives_its_files(tmp_path: Path, *, shared: bool) -> None:
    team = a_team(shared=shared)
    write_team(tmp_path, team)
    again = read_team(tmp_path, random_state=4)
    assert [agent.weights.tobytes() for agent in again] == [agent.weights.tobytes() for agent in team]
    assert {agent.settings for agent in again} == {SETTINGS}
    assert len({id(agent.weights) for agent in again}) == (1 if shared else 3)


def test_a_team_that_was_read_goes_on_learning(tmp_path: Path) -> None:
    write_team(tmp_path, a_team(shared=True))
    first, second = read_team(tmp_path, random_state=4), read_team(tmp_path, TILES, random_state=4)
    assert play(first, 2) == play(second, 2)
    assert (
        first[0].weights.tobytes() == second[2].weights.tobytes() != a_team(shared=True)[0].weights.tobytes()
    )


def test_a_team_can_be_read_frozen(tmp_path: Path) -> None:
    team = a_team()
    write_team(tmp_path, team)
    again = read_team(tmp_path, learn=False, random_state=4)
    play(again, 2)
    assert [agent.weights.tobytes() for agent in again] == [agent.weights.tobytes() for agent in team]


def test_a_model_replaces_the_one_before(tmp_path: Path) -> None:
    (tmp_path / "run.json").write_text("{}", "utf-8")
    write_team(tmp_path, a_team())
    team = a_team()
    play(team, 3)
    write_team(tmp_path, team)
    write_team(tmp_path, team)
    assert read_team(tmp_path)[1].weights.tobytes() == team[1].weights.tobytes()
    assert {path.name for path in tmp_path.iterdir()} == {MODEL, "run.json", weights_file(tmp_path).name}


def test_an_interruption_keeps_the_model_before(tmp_path: Path) -> None:
    team = a_team()
    write_team(tmp_path, team)
    before = (tmp_path / MODEL).read_bytes()
    old = weights_file(tmp_path)
    kept = old.read_bytes()
    expected = team[0].weights.tobytes()
    play(team, 3)
    write_team(tmp_path, team)
    # As if it had stopped after the new weights: the old description and both files of weights are there.
    (tmp_path / MODEL).write_bytes(before)
    old.write_bytes(kept)
    assert read_team(tmp_path)[0].weights.tobytes() == expected


def dense(name: str = "ours", n_features: int = 2) -> DenseFeatures[Any]:
    return DenseFeatures(lambda _: np.ones((2, n_features)), n_features, name=name)


def test_a_function_must_be_given_again(tmp_path: Path) -> None:
    write_team(tmp_path, make_team(dense(), 1))
    assert len(read_team(tmp_path, dense())) == 1
    with pytest.raises(ModelFormatError, match=r"'name': 'ours'.*pass the feature map"):
        read_team(tmp_path)
    for other in (dense("theirs"), dense(n_features=3), TILES):
        with pytest.raises(ModelFormatError, match="learned with other features"):
            read_team(tmp_path, other)


def test_only_agents_of_one_kind_are_a_team(tmp_path: Path) -> None:
    one = make_team(TILES, 1, SETTINGS)
    for other in (make_team(TILES, 1), make_team(dense(), 1, SETTINGS)):
        with pytest.raises(InputError, match="the options or features of agent 1 differ"):
            write_team(tmp_path, (*one, *other))
    with pytest.raises(InputError, match="1 to 1000 agents, got 0"):
        write_team(tmp_path, ())
    one[0].weights[0] = np.nan
    with pytest.raises(InputError, match="learning diverged"):
        write_team(tmp_path, one)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("content", [None, b"", b"\xff\xfe{}", b'{"format": "x"}', b"[[[["])
@pytest.mark.parametrize("part", ["model", "weights"])
def test_missing_and_damaged_files_are_named(tmp_path: Path, part: str, content: bytes | None) -> None:
    write_team(tmp_path, a_team())
    path = tmp_path / MODEL if part == "model" else weights_file(tmp_path)
    path.unlink()
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(ModelFormatError, match=path.name):
        read_team(tmp_path)


@pytest.mark.parametrize(
    "changes",
    [
        {"version": 2},
        {"weights": None},
        {"weights": "../sarsa-0123456789abcdef.npz"},
        {"weights": "/etc/passwd"},
        {"weights": "sarsa-0123456789abcdef.npz"},
        {"agents": None},
        {"agents": []},
        {"agents": [0, 1]},
        {"agents": [0, 1, 3]},
        {"agents": [0, -1, 2]},
        {"agents": [0, 1, True]},
        {"agents": [0, 1, 2.0]},
        {"agents": [0, 1, [2]]},
        {"agents": [0, 1, 2] * 400},
        {"settings": None},
        {"settings": SETTINGS.to_dict() | {"alpha": -1}},
        {"features": None},
        {"features": {"kind": "tiles"}},
        {"features": {"kind": ["tiles"]}},
        {"features": TILES.to_dict() | {"n_actions": 4}},
        {"features": TILES.to_dict() | {"n_actions": 10**12}},
    ],
)
def test_hostile_descriptions_are_refused(tmp_path: Path, changes: dict[str, Any]) -> None:
    write_team(tmp_path, a_team())
    edit(tmp_path, **changes)
    with pytest.raises(ModelFormatError):
        read_team(tmp_path)


@pytest.mark.parametrize(
    "table",
    [
        np.zeros((3, 1)),
        np.zeros(TILES.n_features),
        np.zeros((3, TILES.n_features), np.float32),
        np.zeros((3, TILES.n_features), ">f8"),
        np.zeros((0, TILES.n_features)),
        np.full((3, TILES.n_features), np.nan),
        np.full((3, TILES.n_features), 1e200),
        np.zeros((4, TILES.n_features)),
    ],
)
def test_hostile_weights_are_refused(tmp_path: Path, table: Any) -> None:
    write_team(tmp_path, a_team())
    write_npz(weights_file(tmp_path), {"weights": table})
    with pytest.raises(ModelFormatError, match="weights"):
        read_team(tmp_path)
