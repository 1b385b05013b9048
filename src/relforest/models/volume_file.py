"""The decision volume of a classifier of bags as a file."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any, Final

import numpy as np
from sklearn.utils.validation import check_is_fitted

from relforest.mil import CovAggClassifier
from relforest.mil.feature_names import remember_columns
from relforest.scenes import Bags
from relforest.support.documents import well_formed
from relforest.support.errors import ModelFormatError
from relforest.support.files import write_json
from relforest.volumes import Arc, volume_from_dict

FORMAT: Final = "relforest-volume"
VERSION: Final = 1


def write_volume(path: Path, classifier: CovAggClassifier) -> None:
    """Write the volume of a fitted classifier with its labels, and its features if they have names."""
    check_is_fitted(classifier)
    names = getattr(classifier, "feature_names_in_", None)
    document = {
        "format": FORMAT,
        "version": VERSION,
        "classes": classifier.classes_.tolist(),
        "features": None if names is None else names.tolist(),
        "volume": classifier.volume_.to_dict(),
    }
    write_json(path, document)


def classifier_of(document: dict[str, Any], path: Path) -> CovAggClassifier:
    """Return the classifier of a document that was read from a file.

    Raises
    ------
    ModelFormatError
        If the document is damaged.
    """
    with well_formed(f"{path} is damaged", "restore it, or learn the volume again"):
        classifier = CovAggClassifier()
        volume, names, classes = (
            volume_from_dict(document["volume"]),
            document["features"],
            document["classes"],
        )
        if isinstance(volume, Arc):
            raise ModelFormatError("bags need an ellipsoid or a slab")
        if names is not None and (
            len(names) != volume.dim or not all(isinstance(each, str) for each in names)
        ):
            raise ModelFormatError(f"expected the names of {volume.dim} features, got {names!r:.50}")
        types = (
            {str} if isinstance(classes[0], str) else {bool} if isinstance(classes[0], bool) else {int, float}
        )
        if len(classes) != 2 or not {type(each) for each in classes} <= types or classes[0] == classes[1]:
            raise ModelFormatError(f"expected two labels of a type, got {classes!r:.50}")
        classifier.volume_, classifier.classes_ = volume, np.array(classes)
        no_points = Bags(np.empty((0, volume.dim)), np.zeros(1, dtype=np.int64), np.empty(0, dtype=np.int64))
        remember_columns(classifier, no_points if names is None else replace(no_points, columns=tuple(names)))
    return classifier
