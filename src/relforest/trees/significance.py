"""Testing whether an expansion improves a tree by more than chance (section 4.2)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from scipy.special import gammaincc

if TYPE_CHECKING:
    from relforest.mappings import Mapping
    from relforest.volumes.settings import Shape


def added_parameters(mapping: Mapping, *, has_errors: bool, n_values: int = 1, shape: Shape = "full") -> int:
    """Degrees of freedom that a question adds to a tree.

    The volume's centre, its shape and size (on the circle just its width; of a category, just which one it
    is; of a diagonal shape, a width for each dimension; of one dimension of several, which one it is, centre
    and width), and the probabilities of one or two more leaves (`n_values` each, which is one, or for several
    classes one less than there are). The source gives no count; this is the natural one for a codomain of
    dimension d, with instantiation nodes free.

    Examples
    --------
    >>> from relforest import Attribute
    >>> from relforest.mappings import Mapping
    >>> added_parameters(Mapping("difference", Attribute("location", 2)), has_errors=False)
    6
    """
    dim = mapping.dim
    if mapping.space == "category":
        of_volume = 1
    elif dim == 1:
        of_volume = 2
    elif shape == "axis":
        of_volume = 3
    else:
        of_volume = dim + (dim if shape == "diagonal" else dim * (dim + 1) // 2)
    return of_volume + (2 if has_errors else 1) * n_values


def likelihood_ratio_p(gain: float, n_parameters: int) -> float:
    """P-value of a gain in log likelihood under the chi-square law of the likelihood ratio test."""
    return float(gammaincc(n_parameters / 2.0, max(gain, 0.0)))


def sidak(alpha: float, n_tests: int) -> float:
    """Level of each of `n_tests` tests for a family-wise level `alpha`.

    References
    ----------
    Palmer (2015), section 3.3.3.
    """
    return float(1.0 - (1.0 - alpha) ** (1.0 / n_tests))
