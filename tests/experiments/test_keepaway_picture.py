from __future__ import annotations

from pathlib import Path

import gymnasium
import numpy as np
import pytest

from experiments.run_folders import write_run_of_sarsa
from relforest.experiments.keepaway_picture import agent_policy_map, formations, team_policy_map
from relforest.experiments.keepaway_team import benchmark_team
from relforest.experiments.tasks import task_named
from relforest.rl.baselines.tile_coding import TileKind
from relforest.rl.rpi import SMRFRPI
from relforest.support.errors import InputError
from relforest.worlds.keepaway.server.options import KeepawayOptions


@pytest.mark.parametrize(("keepers", "takers"), [(2, 1), (3, 2), (4, 3), (6, 5)])
def test_formations_keep_players_apart_and_inside(keepers: int, takers: int) -> None:
    setup = KeepawayOptions(keepers, takers, (20.0, 30.0)).setup()
    for formation in formations(setup):
        places = formation.players[:, :2]

        assert places.shape == (keepers + takers, 2)
        assert (np.abs(places) < (10.0, 15.0)).all()
        # The holder stands alone, or no policy could be told from another.
        others = np.delete(places[:keepers], formation.actor, axis=0)
        assert np.hypot(*(others - places[formation.actor]).T).min() > 5.0


@pytest.mark.parametrize("kind", ["tiles", "bells"])
def test_a_team_has_its_map(tmp_path: Path, kind: TileKind) -> None:
    rules = KeepawayOptions(size=8.0)
    write_run_of_sarsa(tmp_path, benchmark_team(rules, kind=kind), rules)
    figure = team_policy_map(tmp_path, gymnasium.make("relforest/Keepaway-v0", size=8.0))

    assert [axes.get_title(loc="left") for axes in figure.axes] == ["ball in a corner", "ball in the centre"]


def test_an_agent_has_its_map(tmp_path: Path) -> None:
    env = gymnasium.make("relforest/Keepaway-v0", size=8.0, max_cycles=20)
    SMRFRPI(env, random_state=0, checkpoint=tmp_path).learn(1, 2, test_episodes=1)

    assert len(agent_policy_map(tmp_path, env).axes) == 2


def test_a_map_of_another_world_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="needs a KeepawayEnv, got CorridorEnv"):
        team_policy_map(tmp_path, task_named("corridor").make())
