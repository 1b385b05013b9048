"""The mapping functions that a schema allows."""

from __future__ import annotations

from typing import TYPE_CHECKING

from relforest.mappings.mapping import Mapping

if TYPE_CHECKING:
    from relforest.scenes import Schema


def catalogue(schema: Schema) -> tuple[Mapping, ...]:
    """Return every mapping function of a schema, attribute by attribute.

    Each attribute lists the operations it takes part in (`Attribute.operations`), because every
    additional function costs significance through the correction for multiple comparisons. A schema
    of location (2-D), color, extent, extent ratio and orientation yields exactly the ten functions
    of section 4.3.

    Examples
    --------
    >>> from relforest import Attribute, Schema
    >>> [mapping.name for mapping in catalogue(Schema((Attribute("color", 3),)))]
    ['identity(color)', 'difference(color)']
    """
    return tuple(
        Mapping(operation, attribute) for attribute in schema.attributes for operation in attribute.operations
    )
