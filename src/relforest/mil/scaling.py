"""Scaling the features of bags, by statistics over all instances of all bags."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final, Self, cast, final

import narwhals as nw
import numpy as np
from sklearn import get_config
from sklearn.base import BaseEstimator, OneToOneFeatureMixin, TransformerMixin

from relforest.mil.bag_classifier import bags_like_those_of_fit
from relforest.mil.feature_names import remember_columns
from relforest.scenes.bags import as_bags
from relforest.support.errors import InputError
from relforest.support.options import one_of

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

# Values divided by this can be squared without overflow.
_SMALLEST_WIDTH: Final = 1e-30
# Range that rounding alone gives to a constant feature, relative to its largest value.
_ROUNDING: Final = 16 * float(np.finfo(np.float64).eps)
_METHODS: Final = ("standard", "minmax", "deviation")
_CONTAINERS: Final = ("default", "pandas", "polars")


@final
@dataclass(frozen=True, slots=True, eq=False)
class FeatureUnits:
    """Location and width of each feature.

    Attributes
    ----------
    shift : (d,) float64
        Value to subtract; 0 for a constant feature.
    width : (d,) float64
        Value to divide by; 0 for a constant feature.
    """

    shift: NDArray[np.float64]
    width: NDArray[np.float64]

    @property
    def factors(self) -> NDArray[np.float64]:
        """1 / width, and 0 for constant features, which removes them from distances, (d,)."""
        return np.divide(1.0, self.width, out=np.zeros_like(self.width), where=self.width > 0.0)


def feature_units(points: NDArray[np.float64], method: str) -> FeatureUnits:
    """Measure the features of points.

    Parameters
    ----------
    points : (n, d) float64
    method : {"standard", "minmax", "deviation"}
        Mean and standard deviation; minimum and range; zero and standard deviation. The denominator of
        standard deviations is n.

    Raises
    ------
    InputError
        If the method is unknown.
    """
    one_of("method", method, _METHODS)
    low = points.min(axis=0)
    spread = points.max(axis=0) - low
    if method == "minmax":
        shift, width = low, spread
    else:
        shift = points.mean(axis=0) if method == "standard" else np.zeros_like(low)
        width = points.std(axis=0)
    # The range decides, since even equal values may have a tiny deviation.
    constant = (spread <= _ROUNDING * np.abs(points).max(axis=0)) | (spread < _SMALLEST_WIDTH)
    constant |= width < _SMALLEST_WIDTH
    return FeatureUnits(np.where(constant, 0.0, shift), np.where(constant, 0.0, width))


@final
class BagScaler(  # type: ignore[call-arg]  # scikit-learn is untyped
    OneToOneFeatureMixin,  # type: ignore[misc]
    TransformerMixin,  # type: ignore[misc]
    BaseEstimator,  # type: ignore[misc]
    auto_wrap_output_keys=None,
):
    """Scale every feature by its statistics over all instances of the training bags.

    Parameters
    ----------
    method : {"standard", "minmax", "deviation"}, default "standard"
        "standard" subtracts the mean and divides by the standard deviation, "minmax" maps the range to
        [0, 1], "deviation" only divides by the standard deviation. Constant features do not change.

    Attributes
    ----------
    shift_ : (d,) float64
        Values subtracted.
    width_ : (d,) float64
        Values divided by; 1 for constant features.
    n_features_in_ : int
        Dimension of the points.
    feature_names_in_ : (d,) str
        Names of the columns, if bags were data frames with such names in `fit`.

    Notes
    -----
    `transform` returns bags in the form it received: an array, a tuple ``(X, bag_ids)``, or a list of one
    array per bag. For data frames it returns arrays, with columns in the order of `fit`, or data frames after
    ``set_output(transform="pandas")``.

    References
    ----------
    Palmer (2015), section 3.3, scales the features for diverse density and EM-DD by "deviation".

    Examples
    --------
    >>> from relforest.mil.scaling import BagScaler
    >>> bags = [[[0.0, 10.0], [4.0, 30.0]], [[2.0, 20.0]]]
    >>> [bag.tolist() for bag in BagScaler(method="minmax").fit_transform(bags)]
    [[[0.0, 0.0], [1.0, 1.0]], [[0.5, 0.5]]]
    """

    shift_: NDArray[np.float64]
    width_: NDArray[np.float64]
    n_features_in_: int
    feature_names_in_: NDArray[np.object_]

    def __init__(self, *, method: str = "standard") -> None:
        self.method = method

    def fit(self, bags: object, y: ArrayLike | None = None) -> Self:
        """Compute the statistics of the features; labels are ignored.

        Raises
        ------
        InputError
            If bags are malformed or the method is unknown.
        """
        del y
        data = as_bags(bags)
        units = feature_units(data.points, self.method)
        self.shift_ = units.shift
        self.width_ = np.where(units.width > 0.0, units.width, 1.0)
        remember_columns(self, data)
        return self

    def transform(self, bags: object) -> Any:  # noqa: ANN401  # the form of what was given
        """Return scaled bags in the form of those passed.

        Raises
        ------
        InputError
            If bags are malformed, or their columns or number of features differ from those in `fit`.
        """
        data = bags_like_those_of_fit(self, bags)
        scaled = (data.points - self.shift_) / self.width_
        if data.form == "list":
            originals = bags if isinstance(bags, (list, tuple)) else [None] * len(data)
            parts = np.split(scaled, data.starts[1:-1])
            return [self._contained(part, frame) for part, frame in zip(parts, originals, strict=True)]
        if data.form == "cube":
            cube = scaled.reshape(len(data), -1, data.dim)
            return cube if self._container() == "default" else [self._contained(part) for part in cube]
        if data.rows is not None:
            points, ids = cast("tuple[object, object]", bags)
            restored = np.empty_like(scaled)
            restored[data.rows] = scaled
            return self._contained(restored, points), ids
        return self._contained(scaled, bags)

    def set_output(self, *, transform: str | None = None) -> Self:
        """Choose the container that `transform` returns, as in scikit-learn.

        Parameters
        ----------
        transform : {"default", "pandas", "polars"} or None
            "default" returns arrays, the others a data frame for every 2-D array; None changes nothing.

        Raises
        ------
        InputError
            If `transform` is something else.
        """
        if transform is not None:
            one_of("transform", transform, _CONTAINERS)
            # Scikit-learn copies this attribute to clones.
            self._sklearn_output_config = {"transform": transform}
        return self

    def _container(self) -> str:
        chosen = getattr(self, "_sklearn_output_config", {}).get("transform")
        return str(chosen or get_config()["transform_output"])

    def _contained(self, points: NDArray[np.float64], original: object = None) -> Any:  # noqa: ANN401  # array or frame
        """Return points (n, d) in the chosen container, with the index of the original if it is pandas."""
        container = self._container()
        if container == "default":
            return points
        try:
            names = list(self.get_feature_names_out())
            table: Any = nw.from_numpy(points, names, backend=cast("Any", container)).to_native()
        except ImportError as error:
            raise InputError(f"set_output(transform={container!r}) needs {container}: install it") from error
        if container == "pandas" and nw.dependencies.is_pandas_dataframe(original):
            table.index = original.index
        return table
