"""The options of every command that reads tables: how a CSV file is written."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, final

from tyro.conf import arg

if TYPE_CHECKING:
    from relforest.scenes.dialect import Dialect


@final
@dataclass(frozen=True, slots=True)
class CsvOptions:
    """How a CSV file is written.

    Parameters
    ----------
    separator
        Field separator: one character or "tab". Detected by default.
    decimal
        Decimal mark: "." or ",". Detected by default where only one is possible.
    encoding
        Encoding, such as latin-1. The default is UTF-8, or UTF-16 where detected.
    """

    separator: Annotated[str | None, arg(metavar="CHARACTER", help_behavior_hint="")] = None
    decimal: Annotated[str | None, arg(metavar="CHARACTER", help_behavior_hint="")] = None
    encoding: Annotated[str | None, arg(metavar="NAME", help_behavior_hint="")] = None

    @property
    def dialect(self) -> Dialect:
        """The same as the readers of tables take it."""
        from relforest.scenes.dialect import Dialect  # noqa: PLC0415 - so that --help answers at once

        return Dialect(self.separator, self.decimal, self.encoding)
