"""Whether a model predicts what situations expect."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from math import inf
from typing import Any, Final

from relforest.checking.situations import Situation, Verdict
from relforest.explaining import explain_prediction
from relforest.models import Model, prediction_table
from relforest.scenes import Scenes
from relforest.scenes.ids import plain
from relforest.support.errors import InputError

_BOUNDS: Final = ("at_least", "at_most")


def check_model(model: Model, situations: Iterable[Situation]) -> tuple[Verdict, ...]:
    """Find out whether a model predicts what situations expect.

    Parameters
    ----------
    model : Model
    situations : iterable of Situation
        Beside objects, with ``arguments`` and ``relations`` as in `relforest.Scenes.from_dicts`. What they
        expect are columns of `relforest.models.prediction_table`: bounds of a number, such as
        ``{"probability": {"at_least": 0.9}}``, or a value, such as ``{"predicted": True}``.

    Returns
    -------
    tuple of Verdict
        In the order of the situations.

    Raises
    ------
    InputError
        If a situation does not fit the model, or expects what the model could never say.
    """
    return tuple(_verdict(model, each) for each in situations)


def _verdict(model: Model, situation: Situation) -> Verdict:
    with situation.checked("arguments", "relations"):
        record = {"id": situation.name, "objects": situation.objects, **situation.fields}
        scene = Scenes.from_dicts([record], model.schema)
        (said,) = prediction_table(model, scene).drop_columns(["scene"]).to_pylist()
        faults = [
            f"{column} is {_shown(said[column])}, expected {_in_words(wanted)}"
            for column, wanted in situation.expect.items()
            if not _holds(column, wanted, said, _possible(model, scene, said))
        ]
        if faults:
            explained = str(explain_prediction(model, scene))
            faults.append(explained.removeprefix(f"scene {situation.name}: "))
        return Verdict(situation.name, tuple(faults))


def _possible(model: Model, scene: Scenes, said: dict[str, Any]) -> dict[str, Sequence[Any]]:
    """Return the values that columns may have, other than numbers with bounds."""
    ids = [plain(each) for each in scene.object_ids]
    possible: dict[str, Sequence[Any]] = {name: ids for name in said if name.startswith("witness_")}
    if "leaf" in said:
        possible["leaf"] = range(model.tree.n_leaves)
    if model.classes is not None:
        # Classes without a common type are written as text.
        is_one_type = len(set(map(type, model.classes))) == 1
        possible["predicted"] = model.classes if is_one_type else tuple(map(str, model.classes))
    return possible


def _holds(column: str, wanted: Any, said: dict[str, Any], possible: dict[str, Sequence[Any]]) -> bool:  # noqa: ANN401 - not checked yet
    if column not in said:
        raise InputError(f"it expects {column!r}, but the model says {', '.join(said)}")
    if column in possible:
        if not any(type(wanted) is type(each) and wanted == each for each in possible[column]):
            listed = ", ".join(map(str, possible[column]))
            raise InputError(f"{column} must be one of {listed}, got {wanted!r:.100}")
        return bool(said[column] == wanted)
    bounds = [wanted.get(name) for name in _BOUNDS] if isinstance(wanted, dict) else []
    is_clear = bounds and wanted.keys() <= set(_BOUNDS) and any(each is not None for each in bounds)
    if not is_clear or not all(each is None or type(each) in {int, float} for each in bounds):
        raise InputError(
            f"{column} needs bounds, such as {{at_least = 0.5, at_most = 1.0}}, got {wanted!r:.100}"
        )
    low, high = (bound if each is None else each for each, bound in zip(bounds, (-inf, inf), strict=True))
    return bool(low <= said[column] <= high)


def _shown(value: object) -> str:
    return "undefined" if value is None else f"{value:.4g}" if isinstance(value, float) else str(value)


def _in_words(wanted: object) -> str:
    if isinstance(wanted, dict):
        return " and ".join(f"{name.replace('_', ' ')} {bound}" for name, bound in wanted.items())
    return str(wanted)
