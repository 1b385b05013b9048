"""Quality of binary predictions, and confidence in means of repeated measurements."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final, final

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import stdtr, stdtrit

from relforest.support.errors import InputError
from relforest.support.masks import refuse_masked
from relforest.support.options import at_least, in_range

NORMAL_95: Final = 1.96
"""Half the width of a 95 % interval of a normal distribution, in standard deviations."""


def peirce_skill_score(y_true: ArrayLike, y_pred: ArrayLike, *, pos_label: object = None) -> float:
    """Return the Peirce skill score: hit rate minus false alarm rate.

    Parameters
    ----------
    y_true, y_pred : (n,) array-likes
        Labels of two classes: 0 and 1, -1 and +1, booleans, or two strings.
    pos_label : label, optional
        The positive class. Default: the larger label of ``y_true`` (of strings, the one sorted last).

    Returns
    -------
    float
        In [-1, 1]: 1 for perfect predictions, 0 for predictions that do not depend on the truth, whatever the
        class frequencies.

    Raises
    ------
    InputError
        If the lengths differ, the truth has not exactly two classes, or a label is unknown.

    Examples
    --------
    >>> peirce_skill_score([1, 1, 0, 0], [1, 0, 0, 0])
    0.5
    """
    truth, prediction = _labels("y_true", y_true), _labels("y_pred", y_pred)
    if len(truth) != len(prediction):
        raise InputError(
            f"y_true has {len(truth)} labels, but y_pred has {len(prediction)}: give one prediction per label"
        )
    classes = _sorted_labels("y_true", truth)
    if len(classes) != 2:
        raise InputError(
            f"y_true must contain labels of two classes, got {len(classes)} ({_listed(classes)}): otherwise "
            "hit rate and false alarm rate are undefined"
        )
    positive = classes[1] if pos_label is None else pos_label
    if positive not in classes:
        raise InputError(f"pos_label {pos_label!r} is not one of the labels in y_true, {_listed(classes)}")
    unknown = [label for label in _sorted_labels("y_pred", prediction) if label not in classes]
    if unknown:
        raise InputError(
            f"y_pred contains {unknown[0]!r}, but y_true only {_listed(classes)}: use the same labels"
        )
    is_positive, hit = truth == positive, prediction == positive
    return float(hit[is_positive].mean() - hit[~is_positive].mean())


@final
@dataclass(frozen=True, slots=True)
class MeanInterval:
    """A mean and its confidence interval."""

    mean: float
    low: float
    high: float
    level: float
    count: int

    @property
    def half_width(self) -> float:
        """Half the width of the interval."""
        return (self.high - self.low) / 2


def mean_interval(values: ArrayLike, level: float = 0.95) -> MeanInterval:
    """Return the mean of independent values and its confidence interval by Student's t distribution.

    Parameters
    ----------
    values : (n,) array-like
        At least two finite numbers.
    level : float
        Coverage probability of the interval, inside (0, 1); exact for normally distributed values.

    Raises
    ------
    InputError
        If there are fewer than two values, a value is not finite, or the level is out of range.
    """
    return SampleMoments.of(values).interval(level)


@final
@dataclass(frozen=True, slots=True)
class SampleMoments:
    """The statistics of independent values that a t-test needs.

    Parameters
    ----------
    mean : float
    std : float
        Standard deviation, with ``count - 1`` in the denominator.
    count : int
        Number of values, at least 2.
    """

    mean: float
    std: float
    count: int

    @classmethod
    def of(cls, values: ArrayLike) -> SampleMoments:
        """Return the moments of (n,) finite numbers.

        Raises
        ------
        InputError
            If there are fewer than two values, or a value is not finite.
        """
        refuse_masked(values, "the sample")
        try:
            sample = np.asarray(values, dtype=np.float64)
        except (TypeError, ValueError) as error:
            raise InputError(f"values must be numbers: {error}") from error
        if sample.ndim != 1 or len(sample) < 2:
            raise InputError(
                f"values must be one-dimensional with at least 2 entries, got the shape {sample.shape}"
            )
        if not np.isfinite(sample).all():
            raise InputError("values must be finite: drop or repeat the runs that gave NaN or infinity")
        # Rounding may give equal values a tiny standard deviation.
        std = 0.0 if (sample == sample[0]).all() else float(sample.std(ddof=1))
        return cls(float(sample.mean()), std, len(sample))

    @classmethod
    def from_interval(cls, mean: float, half_width: float, count: int, level: float = 0.95) -> SampleMoments:
        """Return the moments of a published mean and the half-width of its t interval.

        Examples
        --------
        >>> round(SampleMoments.from_interval(0.76, 0.02, 100).std, 3)
        0.101
        """
        return cls(mean, half_width / _half_width_in_stds(count, level), count)

    def interval(self, level: float = 0.95) -> MeanInterval:
        """Return Student's t interval around the mean; see `mean_interval`."""
        half = self.std * _half_width_in_stds(self.count, level)
        return MeanInterval(self.mean, self.mean - half, self.mean + half, level, self.count)


def two_sample_p_value(one: SampleMoments, other: SampleMoments) -> float:
    """Return the two-tailed p-value of Student's two-sample t-test, which assumes equal variances.

    Parameters
    ----------
    one, other : SampleMoments

    Returns
    -------
    float
        For two samples without variance, 1 if their means are equal, otherwise 0.

    Examples
    --------
    >>> one, other = SampleMoments.of([1.0, 2.0, 3.0]), SampleMoments.of([3.0, 4.0, 5.0])
    >>> round(two_sample_p_value(one, other), 4)
    0.0705
    """
    freedom = one.count + other.count - 2
    pooled = ((one.count - 1) * one.std**2 + (other.count - 1) * other.std**2) / freedom
    error = float(np.sqrt(pooled * (1 / one.count + 1 / other.count)))
    difference = abs(one.mean - other.mean)
    if error == 0.0:
        return float(difference == 0.0)
    return 2 * float(stdtr(freedom, -difference / error))


def sidak_level(level: float, count: int) -> float:
    """Return the level of each of ``count`` independent tests that gives all of them together ``level``.

    Raises
    ------
    InputError
        If the level is not inside (0, 1), or the count is less than 1.

    References
    ----------
    Palmer (2015), section 3.3.3.

    Examples
    --------
    >>> round(sidak_level(0.05, 9), 5)
    0.00568
    """
    level = in_range("level", level, 0.0, 1.0, open_low=True, open_high=True)
    return float(1 - (1 - level) ** (1 / at_least("count", count, 1)))


def _half_width_in_stds(count: int, level: float) -> float:
    """Return half the width of a t interval of ``count`` values, in units of their standard deviation."""
    level = in_range("level", level, 0.0, 1.0, open_low=True, open_high=True)
    return float(stdtrit(count - 1, (1 + level) / 2) / np.sqrt(count))


def _labels(name: str, values: ArrayLike) -> NDArray[Any]:
    """Return labels as a 1-D array of integers, floats or strings."""
    refuse_masked(values, name)
    array: NDArray[Any] = np.asarray(values)
    if array.ndim != 1:
        raise InputError(f"{name} must be one-dimensional, got the shape {array.shape}")
    if array.dtype.kind == "f" and np.isnan(array).any():
        raise InputError(f"{name} contains NaN: give every example a label")
    if array.dtype.kind == "b":
        return array.astype(np.int64)
    if array.dtype.kind not in "iufUO":
        raise InputError(f"{name} contains {array.dtype}: labels must be numbers, booleans or strings")
    return array


def _sorted_labels(name: str, labels: NDArray[Any]) -> list[Any]:
    try:
        found: list[Any] = np.unique(labels).tolist()
    except TypeError as error:
        raise InputError(
            f"{name} mixes types of labels: use only numbers, only booleans, or only strings"
        ) from error
    return found


def _listed(labels: list[Any]) -> str:
    return ", ".join(map(repr, labels)) or "no labels"
