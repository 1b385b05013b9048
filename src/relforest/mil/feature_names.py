"""Matching the columns of bags by name with those seen in `fit`."""

from __future__ import annotations

import warnings
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from relforest.support.errors import InputError

if TYPE_CHECKING:
    from sklearn.base import BaseEstimator

    from relforest.scenes.bags import Bags


_MOST_LISTED = 5


def remember_columns(estimator: BaseEstimator, bags: Bags) -> None:
    """Set ``n_features_in_`` and, if the columns have names, ``feature_names_in_``."""
    estimator.n_features_in_ = bags.dim
    estimator._columns_in = bags.columns  # noqa: SLF001  # kept by the estimator on behalf of this module
    if bags.has_names:
        estimator.feature_names_in_ = np.array(bags.columns, dtype=object)
    elif hasattr(estimator, "feature_names_in_"):
        del estimator.feature_names_in_


def columns_as_in_fit(estimator: BaseEstimator, bags: Bags) -> Bags:
    """Return bags with their columns in the order seen in `fit`.

    Columns are matched by name. Labels that are not strings, such as pandas' default numbers, are matched
    only if the same labels were seen in `fit`; otherwise columns are matched by position.

    Raises
    ------
    InputError
        If a column is missing or unknown, or the number of features differs.

    Warns
    -----
    UserWarning
        If columns have names here but had none in `fit`, or the other way round.
    """
    name = type(estimator).__name__
    fitted: tuple[Any, ...] | None = estimator._columns_in  # noqa: SLF001  # set by `remember_columns`
    had_names = hasattr(estimator, "feature_names_in_")
    if bags.has_names and not had_names:
        warnings.warn(f"X has feature names, but {name} was fitted without feature names", stacklevel=2)
    elif had_names and not bags.has_names:
        warnings.warn(
            f"X does not have valid feature names, but {name} was fitted with feature names", stacklevel=2
        )
    elif fitted is not None and bags.columns is not None and fitted != bags.columns:
        if set(fitted) == set(bags.columns):
            places = [bags.columns.index(label) for label in fitted]
            return replace(bags, points=np.ascontiguousarray(bags.points[:, places]), columns=fitted)
        if had_names:
            raise InputError(_mismatch(fitted, bags.columns))
    if bags.dim != estimator.n_features_in_:
        raise InputError(
            f"X has {bags.dim} features, but {name} is expecting {estimator.n_features_in_} features as input"
        )
    return bags


def _mismatch(fitted: tuple[str, ...], found: tuple[str, ...]) -> str:
    unseen, missing = set(found) - set(fitted), set(fitted) - set(found)
    lines = ["The feature names should match those that were passed during fit."]
    lines += ["Feature names unseen at fit time:", *_listed(unseen)] if unseen else []
    lines += ["Feature names seen at fit time, yet now missing:", *_listed(missing)] if missing else []
    return "\n".join(lines)


def _listed(names: set[str]) -> list[str]:
    listed = [f"- {name}" for name in sorted(names)]
    return listed if len(listed) <= _MOST_LISTED else [*listed[:_MOST_LISTED], "- ..."]
