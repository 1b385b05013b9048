"""The clauses of worlds that propose more actions; `worlds` explains what each means."""

from __future__ import annotations

from typing import Any, Final

import gymnasium
import numpy as np

from relforest.smdp import Decision, check_decision, check_refined
from relforest.support.errors import InputError
from relforest.testing.moments import check_moment, first_moment, next_moment, same_decision, violation

_WIDTH: Final = 5
MOST_QUESTIONS: Final = 1000
"""A world that adds actions after so many questions is taken to add them forever."""


def ask(env: gymnasium.Env[Any, Any], seed: int) -> list[Decision]:
    """Ask for more actions until there are none, take the last one, and return all answers.

    Raises
    ------
    AssertionError
        If a clause is violated.
    """
    world: Any = env.unwrapped
    moment = first_moment(env, seed)
    answers = [moment.decision]
    if not same_decision(world.refine(np.empty(0, dtype=np.int64)), moment.decision):
        raise violation("refine", "asked about no action, it must change nothing")
    for _ in range(MOST_QUESTIONS):
        before = answers[-1]
        aims = np.flatnonzero((before.arguments >= before.n_shared).any(axis=1))
        answers.append(world.refine(aims[-_WIDTH:]))
        _check_answer(before, answers[-1], env)
        if len(answers[-1]) == len(before):
            break
    else:
        raise violation("refine", f"after {MOST_QUESTIONS} questions, it still adds actions: limit them")
    forgets = next_moment(env, answers[-1].indices[-1])
    check_moment(forgets, env, world.schema, world.action_types)
    env.close()
    return [*answers, forgets.decision]


def _check_answer(before: Decision, after: Decision, env: gymnasium.Env[Any, Any]) -> None:
    world: Any = env.unwrapped
    try:
        check_refined(before, after)
        check_decision(after, world.schema, world.action_types)
    except InputError as error:
        raise violation("refine", str(error)) from error
    if not same_decision(after, world.decision()):
        raise violation("refine", "decision() must return what refine() returned")
    if not all(map(env.action_space.contains, after.indices)):
        raise violation("refine", f"indices must be in {env.action_space}, got {after.indices.tolist()}")
    seen: set[bytes] = set()
    for position in range(len(after)):
        bound = after.arguments[position]
        is_private = bound >= after.n_shared
        places = np.where(is_private[:, None], after.objects[bound], np.nan)
        key = np.append(np.where(is_private, -2, bound), after.types[position]).tobytes() + places.tobytes()
        if key in seen and position >= len(before):
            raise violation("refine", f"action {position} aims at a place that is offered already")
        seen.add(key)
