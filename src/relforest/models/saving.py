"""Everything that was learned, to files and back."""

from __future__ import annotations

import os
from pathlib import Path

from relforest.mil import CovAggClassifier
from relforest.models.conversion import SceneLearner, as_model
from relforest.models.model import Model
from relforest.models.model_file import FORMAT, VERSION, model_of, write_model
from relforest.models.training_data import TrainingData
from relforest.models.volume_file import FORMAT as VOLUME_FORMAT
from relforest.models.volume_file import VERSION as VOLUME_VERSION
from relforest.models.volume_file import classifier_of, write_volume
from relforest.rl import SMRFRPI
from relforest.rl.saved_policy import AnyValue, read_policy
from relforest.support.errors import InputError
from relforest.support.files import read_json
from relforest.trees.tree import FORMAT as TREE_FORMAT
from relforest.trees.tree import VERSION as TREE_VERSION


def save(
    learned: Model | SceneLearner | CovAggClassifier | SMRFRPI,
    path: str | os.PathLike[str],
    data: TrainingData | None = None,
) -> None:
    """Write what was learned to a file, for `load` and the command line; an existing file is replaced.

    Parameters
    ----------
    learned : Model, fitted estimator or SMRFRPI
        A tree, forest, boosted model or rule set; a classifier of bags with one volume; or an agent, whose
        run folder is written as by `SMRFRPI.save`. Options of estimators and what they say about their
        training, such as ``oob_score_``, are not written.
    path : path
    data : TrainingData, optional
        What an estimator of scenes was fitted to; see `relforest.models.as_model`.

    Raises
    ------
    NotFittedError
        If nothing was learned.
    InputError
        If it is of another class, or `data` are not those of the fit.
    OSError
        If the file cannot be written.
    """
    if data is not None and isinstance(learned, (Model, CovAggClassifier, SMRFRPI)):
        raise InputError(f"data belong to estimators of scenes, not to a {type(learned).__name__}: omit them")
    if isinstance(learned, SMRFRPI):
        learned.save(path)
    elif isinstance(learned, CovAggClassifier):
        write_volume(Path(path), learned)
    else:
        write_model(Path(path), learned if isinstance(learned, Model) else as_model(learned, data))


def load(path: str | os.PathLike[str]) -> Model | CovAggClassifier | AnyValue:
    """Read what `save`, ``relforest fit`` or ``relforest learn`` has written.

    Parameters
    ----------
    path : path
        A model file, the file of a tree in a run folder, the file of a volume, or a run folder.

    Returns
    -------
    Model, CovAggClassifier, ValueFunction or QValue
        How to predict from scenes; a fitted classifier of bags; or the values of actions that the policy of a
        run folder rests on (`SMRFRPI.load` reads an agent that can go on learning).
        `relforest.models.read_model` is for callers that expect a `Model`.

    Raises
    ------
    ModelFormatError
        If it is none of these, or damaged. Nothing in it is executed.
    """
    path = Path(path)
    if path.is_dir():
        return read_policy(path)
    others = {TREE_FORMAT: TREE_VERSION, VOLUME_FORMAT: VOLUME_VERSION}
    document = read_json(path, format=FORMAT, version=VERSION, others=others)
    is_volume = document["format"] == VOLUME_FORMAT
    return classifier_of(document, path) if is_volume else model_of(document, path)
