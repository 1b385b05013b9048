"""What a policy of smrf-q asks, in words."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

from relforest.forests.words import sentence
from relforest.rl.fitted.horizon import Horizon
from relforest.rl.fitted.standing import in_words, is_number, unit_of
from relforest.rl.fitted.sum import Sum
from relforest.rl.fitted.value import QValue
from relforest.support.numerals import number

MOST_QUESTIONS: Final = 10


def questions_in_words(value: QValue, most: int = MOST_QUESTIONS) -> str:
    """Return the questions of each action type that matter most, at most so many."""
    names = [
        action_type.name + (f"({', '.join(action_type.parameters)})" if action_type.parameters else "")
        for action_type in value.action_types
    ]
    learned = value.learned
    own = (
        _of_sum(learned, place, names, most)
        if isinstance(learned, Sum)
        else _of_horizon(learned, place, names, most)
        # What is asked about the base action decides nothing.
        for place in sorted(range(len(names)), key=lambda place: place == learned.base)
    )
    return "\n\n".join("\n".join(lines) for lines in own)


def _of_sum(learned: Sum, place: int, names: list[str], most: int) -> Iterator[str]:
    own = sorted(learned.questions[place], key=lambda question: -question.spread)
    what = "Q" if learned.base in (None, place) else f"Q less that of {names[learned.base]}"
    added = f"{number(learned.constants[place])} and what {len(own)} questions add"
    if n_trees := len(learned.roots(place)):
        added = (
            f"the mean of {n_trees} trees and a sum. The sum is {added}, the trees compare the same distances"
        )
    yield f"{names[place]}: {what} is {added}{_first(len(own), most)}"
    for rank, question in enumerate(own[:most], start=1):
        points, (scale, unit) = (
            zip(question.heights, question.knots, strict=True),
            unit_of(question.condition),
        )
        curve = ", ".join(f"{_signed(height)} at {number(scale * knot)}" for height, knot in points)
        curve += f" {unit}" if unit else ""
        yield f"  {rank}. how far it is from true that {sentence(question.condition, learned.schemas[place])}"
        varies = "with the trees, it varies" if n_trees else "varies"
        yield f"     adds {curve}; {varies} by {number(question.spread)}"


def _of_horizon(learned: Horizon, place: int, names: list[str], most: int) -> Iterator[str]:
    own = sorted(learned.measured[place], key=lambda each: -each.importance)
    forests = f"{len(learned.trees.roots)} forests, one for each number of remaining actions"
    yield f"{names[place]}: {forests}, on {len(own)} measures{_first(len(own), most)}"
    for rank, each in enumerate(own[:most], start=1):
        words, _ = in_words(each.condition, learned.schemas[place], 0.0, 0.0)
        what = (
            "how often and how nearly it is true that"
            if each.condition.n_free
            else "how far it is from true that"
        )
        yield f"  {rank}. {each.importance:.1%}: {'how much' if is_number(each.condition) else what} {words}"


def _first(n: int, most: int) -> str:
    return f"; the first {most}:" if n > most else ":" if n else ""


def _signed(height: float) -> str:
    return number(height) if height < 0.0 else f"+{number(height)}"
