from __future__ import annotations

from typing import Any, final

import gymnasium
import numpy as np
import pytest
from numpy.typing import NDArray

from playing.toy_world import STAGE, ToyWorld
from relforest.playing.frames import Frame
from relforest.playing.reasons import Explanation, Reason
from relforest.playing.recorder import Recording, record_episodes
from relforest.playing.shapes import plain
from relforest.smdp import Decision
from relforest.support.errors import InputError
from relforest.support.progress import Stage as Part
from relforest.support.progress import listening


@final
class Right:
    """Knows what right is worth, and stops after some time."""

    def __init__(self, stop: float = np.inf) -> None:
        self.stop = stop

    def choose(self, decision: Decision, rng: np.random.Generator) -> int:  # noqa: ARG002
        return 1

    def values(self, decision: Decision) -> NDArray[np.float64]:  # noqa: ARG002
        return np.array([np.nan, 3.0])

    def is_finished(self, decision: Decision) -> bool:
        return bool(decision.objects[0, 0] >= self.stop)


@final
class Random:
    def choose(self, decision: Decision, rng: np.random.Generator) -> int:
        return int(rng.integers(len(decision)))


def test_everything_that_can_be_seen_is_recorded() -> None:
    (episode,) = record_episodes(ToyWorld(), Right())

    assert episode.stage is STAGE
    assert [frame.time for frame in episode.frames] == [0.0, 0.5, 1.0, 1.5, 2.0, 2.5, 3.0]
    assert [frame.things[0].x for frame in episode.frames] == [0.0, 0.5, 1.0, 1.5, 2.0, 2.5, 3.0]
    assert [(choice.begin, choice.end) for choice in episode.choices] == [(0.0, 1.0), (1.0, 2.0), (2.0, 3.0)]
    assert (episode.duration, episode.reward, episode.end) == (3.0, 3.0, "over")
    assert (episode.scores[0], episode.scores[-1]) == (0.0, 3.0)


def test_choices_tell_the_options_and_what_they_are_worth() -> None:
    (episode,) = record_episodes(ToyWorld(1), Right())
    (choice,) = episode.choices

    assert plain(choice.words) == "roll right"
    assert ([plain(words) for words in choice.options], choice.chosen) == (["roll left", "roll right"], 1)
    assert choice.values is not None
    np.testing.assert_array_equal(choice.values, [np.nan, 3.0])
    assert record_episodes(ToyWorld(1), Random())[0].choices[0].values is None


def test_of_many_actions_the_most_valuable_and_the_chosen_one_are_told() -> None:
    class Wide:
        schema, action_types, discount, stage = (
            ToyWorld.schema,
            ToyWorld.action_types,
            1.0,
            STAGE,
        )

        def __init__(self) -> None:
            self.toy = ToyWorld(1)
            self.unwrapped, self.watch, self.reset = self, self.toy.watch, self.toy.reset

        def say(self, position: int) -> tuple[str, ...]:
            return (str(position),)

        def decision(self) -> Decision:
            n = 60 if self.toy.time < 1 else 0
            return Decision(np.zeros((1, 1)), np.zeros(n, int), np.empty((n, 0), int), np.arange(n))

        def step(self, action: int, /) -> Any:  # noqa: ARG002
            return self.toy.step(0)

    class Low:
        def choose(self, decision: Decision, rng: np.random.Generator) -> int:  # noqa: ARG002
            return 2

        def values(self, decision: Decision) -> NDArray[np.float64]:
            return np.arange(len(decision), dtype=np.float64)

    (episode,) = record_episodes(Wide(), Low())
    (choice,) = episode.choices
    assert choice.options == tuple((str(n),) for n in (2, *range(11, 60)))
    assert (choice.chosen, choice.words) == (0, ("2",))
    # Without values, too many actions are not told.
    assert len(record_episodes(Wide(), Random())[0].choices[0].options) == 1


@pytest.mark.parametrize("stop", [0, 2])
def test_an_episode_is_over_when_the_policy_has_nothing_left_to_do(stop: int) -> None:
    (episode,) = record_episodes(ToyWorld(), Right(stop))

    assert (len(episode.choices), episode.duration, episode.end) == (stop, float(stop), "")


@final
class Convinced:
    """Goes right, and knows why."""

    def choose(self, decision: Decision, rng: np.random.Generator) -> int:  # noqa: ARG002
        return 1

    def explain(self, decision: Decision, position: int) -> Explanation:  # noqa: ARG002
        reasons = (
            Reason(2.0, "C is right", "true", "false", witnesses=(("C", 0), ("D", 5))),
            Reason(-0.5, "some object is left", "", of_rival=True, witnesses=(("", 0),)),
        )
        return Explanation(0, 1.75, reasons, 3, 0.25)


def test_a_policy_is_asked_why_on_demand() -> None:
    (silent,), (told,) = (record_episodes(ToyWorld(1), Convinced(), explain=asked) for asked in (False, True))
    assert silent.choices[0].why is None
    why = told.choices[0].why
    assert why is not None
    assert plain(why.rival) == "roll left"
    # What is not drawn has no name.
    assert [[(variable, key) for variable, key, _ in each] for each in why.witnesses] == [
        [("C", "disc")],
        [("", "disc")],
    ]
    assert tuple(map(plain, why.words(0))) == ("C is right", "true; C is d; if roll left: false")
    assert tuple(map(plain, why.words(1))) == ("some object is left", "if roll left; it is d")
    # Nobody explains where the policy cannot.
    assert record_episodes(ToyWorld(1), Random(), explain=True)[0].choices[0].why is None


def test_what_was_earned_before_the_first_decision_counts() -> None:
    @final
    class Early:
        def __init__(self) -> None:
            self.unwrapped, self.step = toy, toy.step

        def reset(self, *, seed: int | None = None) -> tuple[None, dict[str, Any]]:
            return toy.reset(seed=seed)[0], {"reward_before": 5.0}

    toy = ToyWorld(2)
    (episode,) = record_episodes(Early(), Right())
    assert (episode.before, episode.reward) == (5.0, 7.0)


def test_episodes_depend_on_the_seed_and_their_number_only() -> None:
    world = ToyWorld(8)
    two, again = record_episodes(world, Random(), 2, seed=5), record_episodes(world, Random(), 1, seed=5)
    (other,) = record_episodes(world, Random(), 1, seed=6)

    assert two[0].frames == again[0].frames
    assert two[0].frames != two[1].frames
    assert again[0].frames != other.frames
    assert world.see is None


def test_what_was_begun_anew_is_forgotten() -> None:
    @final
    class Restarting:
        """Shows an episode that comes to nothing before each episode."""

        def __init__(self) -> None:
            self.unwrapped = toy
            self.step = toy.step

        def reset(self, *, seed: int | None = None) -> tuple[None, dict[str, Any]]:
            toy.show(0.0, 9.0)
            toy.show(3.0, 9.0)
            return toy.reset(seed=seed)

    toy = ToyWorld(1)
    (episode,) = record_episodes(Restarting(), Right())
    assert [frame.score for frame in episode.frames] == [0.0, 0.5, 1.0]


def test_what_does_not_fit_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    env: Any = gymnasium.make("CartPole-v1")
    with pytest.raises(InputError, match=r"CartPoleEnv cannot be shown: a world needs stage, watch\(\)"):
        record_episodes(env, Random())
    for episodes in (0, 1001, True, 2.0):
        with pytest.raises(InputError, match=f"episodes must be an integer from 1 to 1000, got {episodes}"):
            record_episodes(ToyWorld(), Random(), episodes)  # type: ignore[arg-type]
    monkeypatch.setattr(Right, "values", lambda *_: [1.0])
    with pytest.raises(InputError, match=r"one number for each of 2 actions, got \(1,\)"):
        record_episodes(ToyWorld(), Right())
    monkeypatch.setattr("relforest.playing.recorder.MOST_THINGS", 8)
    with pytest.raises(InputError, match="more than 8 things, the limit for recordings: choose fewer"):
        record_episodes(ToyWorld(), Random(), 2)


def test_progress_is_reported() -> None:
    parts: list[Part] = []
    with listening(parts.append):
        record_episodes(ToyWorld(), Random(), 2)
    assert parts == [Part("playing episodes", 0, 2), Part("playing episodes", 1, 2)]


@pytest.mark.parametrize("times", [(), (1.0, 1.0), (2.0, 1.0), (0.0, np.nan)])
def test_times_must_increase(times: tuple[float, ...]) -> None:
    with pytest.raises(InputError, match="finite, increasing times"):
        Recording(STAGE, tuple(Frame(time, ()) for time in times), ())
