"""Why a model predicts what it predicts for one scene, and what would turn it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final, final

import numpy as np

from relforest.explaining.decision_map import DecisionMap, decision_map, value_of
from relforest.explaining.moves import Move, region_of, single, smallest_move
from relforest.forests import Ensemble
from relforest.forests.explanations import Reason, explain_scores
from relforest.models import Model
from relforest.scenes import Scenes
from relforest.scenes.arrays import FloatArray
from relforest.scenes.ids import plain
from relforest.scenes.mean_object import MEAN
from relforest.support.numerals import probability
from relforest.trees import Tree

MOST_REASONS: Final = 8


@final
@dataclass(frozen=True, slots=True, eq=False)
class PredictionExplanation:
    """A prediction for one scene, its reasons, and the smallest change that would turn it.

    Parameters
    ----------
    scene : Scenes
        A single scene.
    region : (2, d) float64 or None
        The least and the largest coordinates to which objects were moved; None if they have no location.
    outcome : str
        What the numbers are of, such as ``completed = True``.
    predicted : label or float
    value : float
        The predicted number, or the probability of the predicted class; of two classes, of the second one.
    threshold : float or None
        Of two classes, the probability from which on the second one is predicted.
    reasons : tuple of Reason
        The strongest first.
    unit : str
        What the contributions of reasons add up to.
    move : Move or None
        The smallest move of one object that turns the class; None if there is none, or the model predicts
        numbers.
    map : DecisionMap or None
        What is predicted while one object is elsewhere.
    """

    scene: Scenes
    region: FloatArray | None
    outcome: str
    predicted: Any
    value: float
    threshold: float | None
    reasons: tuple[Reason, ...]
    unit: str
    move: Move | None
    map: DecisionMap | None

    @property
    def headline(self) -> str:
        """What is predicted, in a few words."""
        if isinstance(self.predicted, float):
            return f"{self.outcome}: {self.predicted:.4g}"
        return f"{_label(self.outcome)}{self.predicted}"

    @property
    def grounds(self) -> str:
        """The numbers behind the headline, as a sentence; empty for a number."""
        if isinstance(self.predicted, float):
            return ""
        if self.threshold is None:
            return f"Its probability is {probability(self.value)}."
        return (
            f"The probability of {self.outcome} is {probability(self.value)}, and it is predicted from "
            f"{probability(self.threshold)} on."
        )

    @property
    def turning(self) -> str:
        """What would turn the prediction, as a sentence; empty where nothing was looked for."""
        if isinstance(self.predicted, float) or self.region is None:
            return ""
        if self.move is None:
            return "No move of a single object within the region turns this."
        start, end = (_place(each) for each in (self.move.start, self.move.end))
        return (
            f"If {self.name_of(self.move.row)} were {self.move.distance:.3g} away, at {end} instead of "
            f"{start}, {_label(self.outcome)}{self.move.predicted} would be predicted."
        )

    def name_of(self, row: int) -> str:
        """Return the id of an object, and which argument it is."""
        name = str(plain(self.scene.object_ids[row]))
        bound = dict(zip(self.scene.arguments[0].tolist(), self.scene.schema.parameters, strict=True))
        return f"{bound[row]} ({name})" if row in bound else name

    def rows_of(self, reason: Reason) -> list[int]:
        """Return the rows of the objects that a reason is about."""
        rows = {plain(self.scene.object_ids[row]): row for row in self.scene.objects(0).tolist()}
        return [rows[name] for key, name in reason.witnesses.items() if key != MEAN and name in rows]

    def __str__(self) -> str:
        """Return everything in words."""
        lines = [f"scene {plain(self.scene.scene_ids[0])}: {self.headline}", self.grounds]
        if self.reasons:
            lines += [f"What decided, by {self.unit}:", *(f"    {reason}" for reason in self.reasons)]
        return "\n".join(filter(None, [*lines, self.turning]))


def explain_prediction(
    model: Model,
    scene: Scenes,
    *,
    row: int | None = None,
    within: Sequence[Sequence[float]] | FloatArray | None = None,
    most: int = MOST_REASONS,
    n_jobs: int = 1,
) -> PredictionExplanation:
    """Explain what a model predicts for a scene.

    Parameters
    ----------
    model : Model
    scene : Scenes
        A single scene.
    row : int, optional
        Row of the object for which a map is made, as by `row_named`. Default: the one whose move turns the
        prediction, otherwise the last argument, or the first object.
    within : (2, d), optional
        The least and the largest coordinates to which objects may be moved; see `region_of`.
    most : int
        Number of reasons.
    n_jobs : int
        Threads; they do not affect the result.

    Raises
    ------
    InputError
        If there is not a single scene, or the region does not fit.

    Notes
    -----
    Where objects have no location, there is no move; there is no map either if it is not two-dimensional, or
    there are more than two classes.
    """
    scene = single(scene)
    n_classes = len(model.classes or ())
    attribute = next((each for each in scene.schema.attributes if each.role == "location"), None)
    region = None if attribute is None and within is None else region_of(scene, within)
    said = model.predictions(scene)
    predicted, move, drawn = said.predicted[0], None, None
    if said.probability is not None and model.classes is not None and n_classes > 2:
        output = model.classes.index(predicted)
        value = float(said.probability[0, output])
    else:
        output, value = 0, float(value_of(model, scene)[0])
    if n_classes and region is not None:
        move = smallest_move(model, scene, within=region, n_jobs=n_jobs)
    if n_classes <= 2 and region is not None and region.shape[1] == 2:
        chosen = _to_be_moved(scene, move) if row is None else row
        drawn = decision_map(model, scene, chosen, within=region, n_jobs=n_jobs)
    unit = "log-odds" if model.family in {"boosting", "rules", "outcome"} else "probability"
    return PredictionExplanation(
        scene,
        region,
        model.outcome,
        predicted if n_classes else value,
        value,
        model.threshold if n_classes == 2 else None,
        _reasons(model, scene, output, most),
        f"what its answer adds{f' to the {unit} of {model.outcome}' if n_classes else ''}",
        move,
        drawn,
    )


def _reasons(model: Model, scene: Scenes, output: int, most: int) -> tuple[Reason, ...]:
    """Return the strongest reasons for one output, told together where there are many questions."""
    learned = model.learned
    if isinstance(learned, Tree):
        learned = Ensemble(learned.schema, np.zeros(learned.values.shape[1]), (learned,), np.ones(1))
    is_large = model.family in {"forest", "boosting", "outcome"}
    (explained,) = explain_scores(learned, scene, np.array([output]), most, together=is_large)
    return explained.reasons


def _to_be_moved(scene: Scenes, move: Move | None) -> int:
    """Return the row of the object that a map is about: the one that moves, the last argument, or any."""
    if move is not None:
        return move.row
    bound = scene.arguments[0][scene.arguments[0] >= 0]
    return int(bound[-1] if len(bound) else scene.objects(0)[0])


def _label(outcome: str) -> str:
    """Return ``"completed = "`` for ``"completed = True"``; empty where the label has no name."""
    name, sign, _ = outcome.partition(" = ")
    return f"{name} = " if sign else ""


def _place(place: FloatArray) -> str:
    return f"({', '.join(f'{part:.4g}' for part in place.tolist())})"
