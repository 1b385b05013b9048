"""What conditions may be made of: the numbers and categories that a choice of objects has."""

from __future__ import annotations

from itertools import combinations, permutations
from typing import TYPE_CHECKING, Final, NamedTuple

from relforest.mappings import Mapping, Related
from relforest.scenes.schema import PLANAR_OPERATIONS

if TYPE_CHECKING:
    from collections.abc import Iterator

    from relforest.scenes import Attribute, Schema

# How an object lies relative to two others also takes the angle and the ratio of distances (appendix A.3).
_MORE_OPERATIONS: Final = ("scaled_distance", "bearing")


class Column(NamedTuple):
    """One component of a mapping of some of the variables, or a relation of two of them."""

    mapping: Mapping | Related
    variables: tuple[int, ...]
    component: int


def columns(schema: Schema, n_free: int) -> tuple[Column, ...]:
    """Return all columns of the arguments and `n_free` free variables.

    Mappings are those of the attributes' operations; where these include a reframe, also the scaled
    distance and the bearing. Of three objects, the last one is seen from the frame of the two others, and is
    free if any is. With two free variables, only what holds for both together counts more than once: an
    order of the two that gives the same points up to an isometry is left out. Relations come last.
    """
    n_bound = schema.n_parameters + n_free
    related = tuple(
        Column(Related(relation, arity), variables, 0)
        for relation in schema.relations
        for arity in (1, 2)
        for variables in (permutations if relation.directed else combinations)(range(n_bound), arity)
    )
    of_attributes = tuple(
        Column(mapping, variables, component)
        for attribute in schema.attributes
        for mapping in _mappings(attribute)
        for variables in _choices(mapping, schema.n_parameters, n_bound)
        for component in range(mapping.dim)
    )
    return of_attributes + related


def _mappings(attribute: Attribute) -> Iterator[Mapping]:
    operations = list(attribute.operations)
    if any(operation in operations for operation in PLANAR_OPERATIONS):
        operations += [each for each in _MORE_OPERATIONS if each not in operations]
    return (Mapping(operation, attribute) for operation in operations)


def _choices(mapping: Mapping, n_arguments: int, n_bound: int) -> Iterator[tuple[int, ...]]:
    for chosen in combinations(range(n_bound), mapping.arity):
        if mapping.arity < 3:
            yield chosen
            continue
        free = [variable for variable in chosen if variable >= n_arguments]
        for order in mapping.rule.argument_orders(chosen):
            if not free or order[-1] in free:
                yield order
