"""The questions that may be asked at a leaf (Algorithm 4.1, sections 4.2 and 6.2)."""

from __future__ import annotations

from itertools import combinations
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Iterator

    from relforest.mappings import Mapping


class Expansion(NamedTuple):
    """Zero or more instantiations followed by one question."""

    n_new: int  # instantiation nodes
    mapping: Mapping
    variables: tuple[int, ...]  # that the mapping takes, in order

    def pattern(self, first_new: int) -> Expansion:
        """Return what it has in common with those that only exchange variables from `first_new` on.

        New variables go through the same objects, so to exchange them is to ask the same of every scene.
        """
        return self._replace(variables=tuple(min(variable, first_new) for variable in self.variables))


def expansions(mappings: tuple[Mapping, ...], n_bound: int, n_parameters: int) -> Iterator[Expansion]:
    """Yield all expansions of a leaf that can lead to different volumes, fewest new variables first.

    A question refers to every new variable that ranges over objects; variables that stand for action
    arguments are exempt, since their objects are already identified (section 6.2). No variable is
    bound beyond the last one asked about: that would only duplicate an expansion with fewer.

    At the leaf, `n_bound` variables are bound, of which the first `n_parameters` stand for action arguments.
    """
    largest_arity = max((mapping.arity for mapping in mappings), default=0)
    beyond_arguments = max(n_bound, n_parameters)
    most = beyond_arguments + largest_arity - n_bound
    for n_new in range(most + 1):
        n_variables = n_bound + n_new
        free = tuple(range(beyond_arguments, n_variables))
        required = free or ((n_variables - 1,) if n_new else ())
        others = tuple(variable for variable in range(n_variables) if variable not in required)
        for mapping in mappings:
            spare = mapping.arity - len(required)
            if spare < 0:
                continue
            for chosen in combinations(others, spare):
                for order in mapping.rule.argument_orders((*chosen, *required)):
                    yield Expansion(n_new, mapping, order)
