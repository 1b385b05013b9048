"""Training solvers that may end before they have converged, without a warning of scikit-learn."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from contextlib import contextmanager

from sklearn.exceptions import ConvergenceWarning

__all__ = ["convergence_unwarned"]


@contextmanager
def convergence_unwarned() -> Iterator[None]:
    """Hold back the warning that a solver did not converge, for callers that tell it by an attribute.

    Notes
    -----
    scikit-learn has no switch for it, and Python's filters of warnings belong to all threads: not for
    threads that train at the same time.
    """
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ConvergenceWarning)
        yield
