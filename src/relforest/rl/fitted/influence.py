"""What matters most to a policy of ``smrf-q``, measured on actions that were taken."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, final

import numpy as np

from relforest.forests.conditions import Condition
from relforest.rl.experience import Experience
from relforest.rl.fitted.questions import N_KNOTS, Question, measured, spokesmen
from relforest.rl.fitted.standing import margins_of_choices
from relforest.rl.fitted.sum import Sum
from relforest.rl.fitted.value import QValue
from relforest.scenes import Scenes
from relforest.scenes.arrays import FloatArray, IntArray

_MOST_SCENES: Final = 1000


@final
@dataclass(frozen=True, slots=True, eq=False)
class Influence:
    """What a condition adds to the values of the actions of one type.

    Parameters
    ----------
    number : int
        The action type.
    condition : Condition
    questions : tuple of Question
        Where the value is a sum, the questions that are about nearly this condition, itself the first. Their
        heights are as they count where there are trees too.
    scenes : Scenes
        Actions that were taken (n).
    margins : (n,) float64
        How far they are from satisfying the condition.
    adds : (n,) float64
        What that adds to their values, compared with what is usual.
    """

    number: int
    condition: Condition
    questions: tuple[Question, ...]
    scenes: Scenes
    margins: FloatArray
    adds: FloatArray

    @property
    def spread(self) -> float:
        """Standard deviation of what it adds."""
        return float(self.adds.std())

    def of_choices(
        self, scene: Scenes, matrix: FloatArray, choices: IntArray
    ) -> tuple[FloatArray, FloatArray]:
        """Return how far choices of objects are from satisfying the condition, and what that adds, both (n,).

        `choices` are rows of `matrix`, see `margins_of_choices`. Without curves, 0 is added.
        """
        margins = margins_of_choices(self.condition, scene.schema, matrix, choices)
        adds = np.zeros(len(choices))
        for question in self.questions:
            own = margins_of_choices(question.condition, scene.schema, matrix, choices)
            far = np.where(np.isnan(own), question.knots[N_KNOTS - 1], own)
            adds += np.interp(far, question.knots, question.heights) - question.usual
        return margins, adds


def influences(value: QValue, experience: Experience, most: int) -> list[Influence]:
    """Return the conditions that matter most to a policy, by what they add to actions that were taken.

    Conditions about the base action come last: they say how good a state is, but not what to do in it.
    """
    learned, found = value.learned, []
    seen = value.view.seen(experience.matrix)
    for number, schema in enumerate(learned.schemas):
        taken = np.flatnonzero(experience.types[experience.actions] == number)
        if not len(taken):
            continue
        taken = taken[np.unique(np.linspace(0, len(taken) - 1, _MOST_SCENES).astype(np.int64))]
        scenes = value.view.scenes(experience, experience.actions[taken], schema, seen)
        measures = measured(learned.packed[number], scenes)
        shares = value.shares(number, measures, experience.remaining[experience.states[taken]])
        for place in range(measures.margins.shape[1]):
            condition, _ = learned.told(number, place)
            if condition is not None and shares[:, 1 + place].any():
                questions = _questions(value, number, place)
                margins = measures.margins[:, place]
                found.append(Influence(number, condition, questions, scenes, margins, shares[:, 1 + place]))
    found.sort(key=lambda each: (each.number == learned.base, -each.spread))
    return found[:most]


def _questions(value: QValue, number: int, place: int) -> tuple[Question, ...]:
    if not isinstance(value.learned, Sum):
        return ()
    learned, own = value.learned, value.learned.questions[number]
    like = [other for other, stands in enumerate(spokesmen(own)) if stands == place and other != place]
    return tuple(learned.curve(number, own[other]) for other in (place, *like))
