"""Points of many dimensions along the principal axes of the positive bags' points."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray


class PrincipalAxes(NamedTuple):
    """Points in coordinates in which ``ncov(P)`` is diagonal, as far from any volume as before.

    Parameters
    ----------
    origin : (d,) float64
        Mean of the positive bags' points.
    axes : (d, r) float64
        Orthonormal directions in which those points spread.
    coordinates : (n_points, r) or (n_points, r + 1) float64
        Along the axes; where r < d, a last coordinate holds the distance from the space that they
        span. No key point has a part in those directions, so every V is a multiple of the identity
        there, and only the length of a point's part in them counts.
    variances : (r,) or (r + 1,) float64
        Diagonal of ``ncov(P) / p``.
    """

    origin: NDArray[np.float64]
    axes: NDArray[np.float64]
    coordinates: NDArray[np.float64]
    variances: NDArray[np.float64]

    def back(
        self, mean: NDArray[np.float64], covariance: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Mean (d,) and covariance (d, d) of given ones, V of eq. 3.6, in these coordinates."""
        rank = self.axes.shape[1]
        # In all directions beside the axes V is what it is along the last coordinate.
        beside = covariance[rank, rank] if rank < len(covariance) else 0.0
        strengths, directions = np.linalg.eigh(covariance[:rank, :rank] - beside * np.eye(rank))
        root = self.axes @ (directions * np.sqrt(np.maximum(strengths, 0.0)))
        # A product with its own transpose is symmetric to the last digit.
        turned = root @ root.T
        turned[np.diag_indices_from(turned)] += beside
        return self.origin + self.axes @ mean[:rank], turned


def principal_axes(points: NDArray[np.float64], positive: NDArray[np.float64]) -> PrincipalAxes:
    """Turn points (n_points, d), of which those in `positive` (n, d) belong to positive bags."""
    origin = positive.mean(axis=0)
    # From the points, since their covariance holds only half of the digits of small variances.
    _, lengths, directions = np.linalg.svd(np.linalg.qr(positive - origin, mode="r"), full_matrices=False)
    rank = int(np.count_nonzero(lengths > lengths[0] * max(positive.shape) * np.finfo(np.float64).eps))
    axes = directions[:rank].T
    variances = lengths[:rank] ** 2 / len(positive)
    distinct, places = _distinct(points)
    offsets = distinct - origin
    coordinates = offsets @ axes
    if rank < points.shape[1]:
        beside = np.linalg.norm(offsets - coordinates @ axes.T, axis=1)
        coordinates = np.column_stack([coordinates, beside])
        variances = np.append(variances, 0.0)
    return PrincipalAxes(origin, axes, coordinates[places], variances)


def _distinct(points: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Distinct rows and the place of every row among them.

    Equal points must have equal coordinates, which a product of matrices does not promise.
    """
    # The sum turns -0.0 into 0.0, so that equal rows consist of equal bytes.
    rows = np.ascontiguousarray(points) + 0.0
    as_bytes = rows.view(np.dtype((np.void, rows.itemsize * rows.shape[1]))).reshape(-1)
    _, first, places = np.unique(as_bytes, return_index=True, return_inverse=True)
    return rows[first], places.reshape(-1)
