from __future__ import annotations

import numpy as np

from relforest.experiments.keepaway.analysis import curves, figures, summarize
from relforest.experiments.keepaway.settings import SERVER_EVENTS
from relforest.experiments.samples import Samples
from relforest.experiments.table import Row, Table


def row(part: str, condition: str, name: str, value: float | None, *, run: int = 0, game: str = "3v2") -> Row:
    return {"part": part, "game": game, "condition": condition, "run": run, "measure": name, "value": value}


def durations(policy: str, mean: float) -> list[Row]:
    numbers = {"episodes": 100, "mean": mean, "sd": 10, "q5": 20, "q25": 25, "q50": 30, "q75": 40, "q95": 60}
    shares = {"taken": 0.5, **dict.fromkeys(SERVER_EVENTS, 0.25)}
    return [row("durations", policy, name, value) for name, value in {**numbers, **shares}.items()]


def learning(method: str, run: int, values: list[float]) -> list[Row]:
    return [
        row("learning", method, str(end), value, run=run)
        for end, value in zip((1000, 2000, 5000, 6000), values, strict=True)
    ]


ROWS = [
    *durations("random", 55.0),
    *durations("hold", 40.0),
    *durations("hand", 150.0),
    *learning("cmac-sarsa", 0, [70.0, 95.0, 120.0, 130.0]),
    *learning("cmac-sarsa", 1, [74.0, 99.0, 140.0, 150.0]),
    *learning("cmac-sarsa-shared", 0, [100.0, 120.0, 150.0, 150.0]),
    *learning("cmac-sarsa-shared", 1, [110.0, 120.0, 150.0, 150.0]),
    row("speed", "random", "cycles_per_second", 90_000.0),
    row("speed", "random", "cycles_per_second", 14_000.0, game="4v3"),
]
RECORDED = [row("physics", "", "kick: steps", 620.0), row("physics", "", "kick: violations", 1.0)]
TABLE = Table.of([row("physics", "", "", None), *ROWS])


def test_curves_have_a_row_per_run() -> None:
    samples = Samples.of(TABLE, "part", "game", "condition", "measure")
    ends, values = curves(samples, "cmac-sarsa")

    assert ends.tolist() == [1000, 2000, 5000, 6000]
    np.testing.assert_array_equal(values, [[70, 95, 120, 130], [74, 99, 140, 150]])


def test_what_must_be_reached_is_compared() -> None:
    verdicts = {claim.name: (claim.measured, not claim.is_missed) for claim in summarize(TABLE).claims}

    assert verdicts["3v2, random: mean duration"] == (55.0, True)
    assert verdicts["3v2, hold: mean duration"] == (40.0, False)
    # (70 + 74) / 2, and the mean of both runs over the blocks that end at 5000 and 6000.
    assert verdicts["CMAC Sarsa, mean duration around episode 1000"] == (72.0, True)
    assert verdicts["CMAC Sarsa, mean duration around episode 6000"] == (135.0, True)
    # 105 - 72.
    assert verdicts["gain in mean duration by sharing experience, first 1000 episodes"] == (33.0, True)
    assert verdicts["3v2, random: game cycles per CPU second"] == (90_000.0, True)
    assert verdicts["4v3, random: game cycles per CPU second"] == (14_000.0, False)


def test_the_physics_are_reported_only_where_they_were_compared() -> None:
    assert "not compared with recorded games (set RELFOREST_DATA" in summarize(TABLE).text
    found = summarize(Table.of([*RECORDED, *ROWS]))

    assert "not compared" not in str(found)
    assert ["kick", "620", "1"] in [line.split() for line in str(found).splitlines()]
    assert [claim.verdict for claim in found.claims if "kick" in claim.name] == ["MISSED"]


def test_the_mean_has_its_interval() -> None:
    # 1.96 * 10 / sqrt(100) = 1.96.
    assert "55.0 +- 2.0" in str(summarize(TABLE))


def test_there_is_a_picture_of_each_part() -> None:
    found = figures(TABLE)

    assert set(found) == {"durations.png", "learning.png", "speed.png"}
    # Three policies, each beside the real server.
    assert len(found["durations.png"].axes[0].get_yticklabels()) == 6
