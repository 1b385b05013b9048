"""Whether a policy acts as situations expect."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any, Final

import numpy as np

from relforest.checking.situations import Situation, Verdict
from relforest.playing.recorder import Why
from relforest.rl.explaining import comparison
from relforest.rl.saved_policy import AnyValue
from relforest.scenes import Scenes
from relforest.scenes.ids import plain
from relforest.smdp import UNBOUND, Decision
from relforest.support.errors import InputError

_EXPECTED: Final = ("chosen", "avoided", "better", "than")


def check_policy(value: AnyValue, situations: Iterable[Situation]) -> tuple[Verdict, ...]:
    """Find out whether a policy acts as situations expect.

    Parameters
    ----------
    value : ValueFunction or QValue
        What its actions are worth.
    situations : iterable of Situation
        Beside objects, with ``actions``, each a list of an action type and the ids of its arguments;
        ``places``, objects that only the actions see which they are arguments of; and ``remaining``, the
        number of actions that an episode can still take, where the task limits it. They expect an action to
        be ``chosen``, to be ``avoided``, or to be ``better`` ``than`` another one. Of an action, some of the
        arguments may be left out: the best one that begins so is meant.

    Returns
    -------
    tuple of Verdict
        In the order of the situations. Actions that are worth the same are chosen at random, so neither of
        them is better.

    Raises
    ------
    InputError
        If a situation does not fit the policy, or what it expects is unclear.
    """
    return tuple(_verdict(value, each) for each in situations)


def _verdict(value: AnyValue, situation: Situation) -> Verdict:
    with situation.checked("places", "actions", "remaining"):
        decision, ids = _decision(value, situation)
        actions = [_in_words(action) for action in situation.fields["actions"]]
        worth, faults = value.values(decision), []
        for claim, good, bad in _claims(situation):
            better, worse = (max(each, key=worth.__getitem__) for each in (good, bad))
            if worth[better] <= worth[worse]:
                compared = comparison(value, decision, worse, better)
                found = (
                    tuple((name, "", (str(ids[row]),)) for name, row in reason.witnesses)
                    for reason in compared.reasons
                )
                why = Why((actions[better],), compared, tuple(found))
                faults.append(f"expected: {claim}; but {actions[worse]} is {why}")
        return Verdict(situation.name, tuple(faults))


def _decision(value: AnyValue, situation: Situation) -> tuple[Decision, list[object]]:
    """Return the decision of a situation, and the ids of its objects."""
    places, actions = (situation.fields.get(name, []) for name in ("places", "actions"))
    if not isinstance(places, list):
        raise InputError(f"places must be a list of objects, got {places!r:.100}")
    if not isinstance(actions, list) or len(actions) < 2:
        raise InputError(f"actions must be a list of at least two, got {actions!r:.100}")
    record = {"id": situation.name, "objects": [*situation.objects, *places]}
    scene = Scenes.from_dicts([record], value.schema)
    ids = [plain(each) for each in scene.object_ids]
    types = {each.name: number for number, each in enumerate(value.action_types)}
    numbers, rows = [], np.full((len(actions), max(each.arity for each in value.action_types)), UNBOUND)
    for own, action in zip(rows, actions, strict=True):
        name, *bound = action if isinstance(action, list) and action else [None]
        if not isinstance(name, str) or name not in types:
            raise InputError(
                f"an action must be a list that begins with {', '.join(types)}, got {action!r:.100}"
            )
        parameters = value.action_types[types[name]].parameters
        if len(bound) != len(parameters) or not all(
            each in ids and not isinstance(each, bool) for each in bound
        ):
            wanted = " and ".join(parameters) or "nothing else"
            raise InputError(
                f"action {_in_words(action)} must name {wanted}, by ids of {', '.join(map(str, ids))}"
            )
        numbers.append(types[name])
        own[: len(bound)] = [ids.index(each) for each in bound]
        if actions.count(action) > 1:
            raise InputError(f"action {_in_words(action)} is listed twice")
    remaining = situation.fields.get("remaining")
    indices = np.arange(len(actions))
    return Decision(scene.matrix, np.array(numbers), rows, indices, len(places), remaining), ids


def _claims(situation: Situation) -> list[tuple[str, list[int], list[int]]]:
    """Return what is expected in words, the positions of actions, and of those that must be worth less."""
    expect, actions, claims = situation.expect, situation.fields["actions"], []
    meant = {name: _meant(name, wanted, actions) for name, wanted in expect.items()}
    everything = range(len(actions))
    for names in (("chosen",), ("avoided",), ("better", "than")):
        if meant.keys().isdisjoint(names):
            continue
        if not meant.keys() >= set(names):
            raise InputError("it expects 'better' or 'than' alone: write both")
        first = meant[names[0]]
        rest = meant["than"] if names[1:] else [each for each in everything if each not in first]
        good, bad = (rest, first) if names == ("avoided",) else (first, rest)
        claim = " ".join(f"{name} {_in_words(expect[name])}" for name in names)
        if not rest or not set(good).isdisjoint(bad):
            raise InputError(f"{claim} leaves no other action to compare with")
        claims.append((claim, good, bad))
    return claims


def _meant(name: str, wanted: Any, actions: Sequence[Any]) -> list[int]:  # noqa: ANN401 - not checked yet
    """Return the positions of the actions that begin as is wanted."""
    if name not in _EXPECTED:
        raise InputError(f"it expects {name!r}, which is not understood: write {', '.join(_EXPECTED)}")
    is_list = isinstance(wanted, list) and wanted
    found = [i for i, action in enumerate(actions) if is_list and action[: len(wanted)] == wanted]
    if not found:
        known = ", ".join(map(_in_words, actions))
        raise InputError(f"{name} must be a list that names one of the actions {known}, got {wanted!r:.100}")
    return found


def _in_words(action: Sequence[Any]) -> str:
    name, *bound = action
    return f"{name}({', '.join(map(str, bound))})" if bound else str(name)
