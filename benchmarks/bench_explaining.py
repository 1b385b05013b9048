"""Smallest moves that turn a prediction: whether they do, whether shorter ones do not, and their time."""

from __future__ import annotations

from time import process_time

import numpy as np
from table import Cell, Table

from relforest.explaining import smallest_move
from relforest.explaining.moves import moved
from relforest.forests import OutcomeForestClassifier, SMRFForestClassifier
from relforest.models import as_model
from relforest.worlds.keepaway import keepaway_pass_scenes

TRAINING = 500
EXPLAINED = 200


def run() -> Table:
    """Look for the smallest move in scenes that the models have not seen."""
    rng = np.random.default_rng(0)
    known, labels = keepaway_pass_scenes(rng, TRAINING)
    scenes, _ = keepaway_pass_scenes(rng, EXPLAINED)
    rows: list[tuple[Cell, ...]] = []
    for name, estimator in (
        ("outcome forest", OutcomeForestClassifier(random_state=0)),
        ("forest of 100 trees", SMRFForestClassifier(n_trees=100, random_state=0)),
    ):
        model = as_model(estimator.fit(known, labels))
        before = model.predictions(scenes).predicted
        smallest_move(model, scenes.take([0]))
        begin = process_time()
        moves = [smallest_move(model, scenes.take([number])) for number in range(EXPLAINED)]
        seconds = process_time() - begin
        turned = kept = 0
        for number, move in enumerate(moves):
            if move is not None:
                single = scenes.take([number]).compact()
                less = moved(single, np.array([move.row]), move.shorter[None])
                turned += int(model.predictions(move.scene).predicted[0] != before[number])
                kept += int(model.predictions(less).predicted[0] == before[number])
        found = [move.distance for move in moves if move is not None]
        rows.append((name, EXPLAINED, len(found), turned, kept, float(np.median(found)), seconds / EXPLAINED))
    return Table(
        "explaining",
        f"Smallest moves of one player that turn whether a pass succeeds (3 against 2, {TRAINING} scenes to "
        "learn from). All must turn it, and none may do so if it is a twentieth shorter.",
        ("model", "scenes", "moves", "turn", "shorter: keep", "median m", "CPU s a scene"),
        tuple(rows),
    )


if __name__ == "__main__":
    run().report()
