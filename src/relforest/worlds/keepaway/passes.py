"""Passes of random keepers as scenes, labelled with whether the keepers still have the ball afterwards."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, Unpack

import numpy as np

from relforest.scenes import Scenes, Schema
from relforest.support.options import between
from relforest.support.progress import report
from relforest.support.rng import seed_sequence
from relforest.worlds.arguments import checked_generator
from relforest.worlds.keepaway.decisions.scene import ACTION_TYPES, PASS_TYPE, SCHEMA
from relforest.worlds.keepaway.play.batch import RESTART, Batch
from relforest.worlds.keepaway.server.layout import OUT, PLAYING, TAKEN
from relforest.worlds.keepaway.server.options import KeepawayOptions, Rules

if TYPE_CHECKING:
    from numpy.typing import NDArray

MOST_SCENES: Final = 100_000
"""Scenes in one call."""

# Games side by side, decisions before the first one that counts, and passes played for each that is kept.
# With the first decisions, too many passes would be early in an episode, where they succeed.
_GAMES: Final = 64
_SKIPPED: Final = 40
_PLAYED: Final = 3


def keepaway_pass_scenes(
    rng: np.random.Generator, n: int, **rules: Unpack[Rules]
) -> tuple[Scenes, NDArray[np.bool_]]:
    """Draw passes between keepers who act at random, labelled with whether the pass succeeds.

    Parameters
    ----------
    rng : numpy.random.Generator
    n : int
        Number of scenes, 1 to 100 000.
    **rules
        The rules of the game, see `KeepawayOptions`. The source has 3 keepers and 2 takers on 20 m by 20 m,
        and 4 and 3 on 25 m by 25 m in large scenes.

    Returns
    -------
    scenes : Scenes
        The players when the ball is passed; the arguments are its holder and the receiver.
    labels : (n,) bool
        Whether the keepers still have the ball at the next decision.

    Raises
    ------
    InputError
        If ``n`` or a rule is out of range, or ``rng`` is not a Generator.

    References
    ----------
    Palmer (2015), section 5.3.2.
    """
    setup = KeepawayOptions(**rules).setup()
    rng, n = checked_generator(rng), between("n", n, 1, MOST_SCENES)
    batch = Batch(setup, _GAMES)
    batch.begin([seed_sequence(rng) for _ in range(_GAMES)])
    objects, arguments, labels = [], [], []
    played = decided = 0
    while played < _PLAYED * n:
        again = batch.ends != PLAYING
        actions = np.where(again, RESTART, rng.integers(setup.keepers, size=_GAMES))
        decided += 1
        passing = np.flatnonzero((actions > 0) & (decided > _SKIPPED))
        objects.append(batch.seen.objects[passing])
        receivers = batch.seen.receivers[passing, actions[passing] - 1]
        arguments.append(np.column_stack([batch.seen.actors[passing], receivers]))
        batch.play(actions)
        labels.append(~np.isin(batch.ends[passing], (OUT, TAKEN)))
        played += len(passing)
        report("passes", min(played, _PLAYED * n), _PLAYED * n)
    kept = rng.choice(played, n, replace=False)
    players = np.concatenate(objects)[kept]
    n_players = players.shape[1]
    starts = np.arange(n) * n_players
    scenes = Scenes(
        Schema(SCHEMA.attributes, ACTION_TYPES[PASS_TYPE].parameters),
        players.reshape(-1, SCHEMA.width),
        np.arange(n * n_players),
        starts,
        np.full(n, n_players),
        starts[:, np.newaxis] + np.concatenate(arguments)[kept],
    )
    return scenes, np.concatenate(labels)[kept]
