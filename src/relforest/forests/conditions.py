"""Conditions on a scene: that some objects exist of which several statements are true."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final, final

from relforest.forests.statements import Statement, statement_from_dict, statement_to_dict
from relforest.support.documents import well_formed
from relforest.support.errors import ModelFormatError
from relforest.support.options import between

if TYPE_CHECKING:
    from relforest.scenes import Schema

MOST_FREE: Final = 2
"""Most free variables of a condition."""
MOST_STATEMENTS: Final = 8
_MOST_COUNTED: Final = 1000


@final
@dataclass(frozen=True, slots=True)
class Condition:
    """There are at least `at_least` choices of objects for which all statements are true.

    Parameters
    ----------
    n_free : int
        Number of free variables, 0 to 2. They range over all objects of the scene other than the arguments
        of the action; two of them are never the same object.
    statements : tuple of Statement
        About the arguments and the free variables.
    at_least : int
        The number of choices that is required; 1 means "there is". Without free variables it is 1.
    every : bool
        With two free variables: whether there is a choice for every first object instead. Its negation is
        that there is a first object without a second one. It does not hold where there is no first object.
    """

    n_free: int
    statements: tuple[Statement, ...]
    at_least: int = 1
    every: bool = False

    @property
    def n_parameters(self) -> int:
        """How many numbers it was fitted with."""
        return sum(statement.n_parameters for statement in self.statements)

    def to_dict(self) -> dict[str, Any]:
        """Return the JSON form."""
        return {
            "free": self.n_free,
            "at_least": self.at_least,
            "statements": [statement_to_dict(statement) for statement in self.statements],
        } | ({"every": True} if self.every else {})

    @classmethod
    def from_dict(cls, document: Any, schema: Schema) -> Condition:  # noqa: ANN401 - not checked yet
        """Read what `to_dict` returned.

        Raises
        ------
        ModelFormatError
            If it is not such a document.
        """
        with well_formed("malformed condition"):
            n_free = between("free", document["free"], 0, MOST_FREE)
            at_least = between("at_least", document["at_least"], 1, _MOST_COUNTED if n_free else 1)
            given = document["statements"]
            if not isinstance(given, list) or not 1 <= len(given) <= MOST_STATEMENTS:
                raise ModelFormatError(f"a condition has 1 to {MOST_STATEMENTS} statements")
            n_bound = schema.n_parameters + n_free
            statements = tuple(statement_from_dict(each, schema, n_bound) for each in given)
            every = document.get("every", False)
            if every is not False and (every is not True or (n_free, at_least) != (2, 1)):
                raise ModelFormatError("every is for conditions on two free variables that are not counted")
        return cls(n_free, statements, at_least, every)
