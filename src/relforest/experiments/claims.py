"""What a study concludes: numbers next to the bounds that they must keep."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import final


@final
@dataclass(frozen=True, slots=True)
class Claim:
    """A measured number and the range it must lie in.

    Parameters
    ----------
    name : str
        What was measured, in words.
    measured : float
    low, high : float
        The bounds, both included.
    """

    name: str
    measured: float
    low: float = -math.inf
    high: float = math.inf

    @property
    def is_met(self) -> bool:
        """Whether the number lies in its range; NaN does not."""
        return self.low <= self.measured <= self.high

    def __str__(self) -> str:
        """Return the verdict, the name, the number and its bounds."""
        bounds = []
        if not math.isinf(self.low):
            bounds.append(f"at least {self.low:.4g}")
        if not math.isinf(self.high):
            bounds.append(f"at most {self.high:.4g}")
        verdict = "met   " if self.is_met else "MISSED"
        return f"{verdict} {self.name}: {self.measured:.4g} ({' and '.join(bounds)})"


@final
@dataclass(frozen=True, slots=True)
class Unclaimed:
    """A claim that is not made, because not all that it is about was computed.

    Parameters
    ----------
    name : str
        What would be claimed, in words.
    missing : tuple of str
        What was left out, in words.
    """

    name: str
    missing: tuple[str, ...]


@final
@dataclass(frozen=True, slots=True)
class Findings:
    """The result of a study in words.

    Parameters
    ----------
    text : str
        Tables and remarks.
    claims : tuple of Claim
    documents : mapping of str to str
        Further text files by name, such as tables in Markdown.
    unclaimed : tuple of Unclaimed
        Claims of the whole study that cannot be made.
    """

    text: str
    claims: tuple[Claim, ...] = ()
    documents: Mapping[str, str] = field(default_factory=dict)
    unclaimed: tuple[Unclaimed, ...] = ()

    @classmethod
    def of(
        cls,
        text: str,
        verdicts: Iterable[Claim | Unclaimed],
        documents: Mapping[str, str] = MappingProxyType({}),
    ) -> Findings:
        """Sort verdicts into claims that are made and claims that cannot be made."""
        verdicts = tuple(verdicts)
        return cls(
            text,
            tuple(verdict for verdict in verdicts if isinstance(verdict, Claim)),
            documents,
            tuple(verdict for verdict in verdicts if isinstance(verdict, Unclaimed)),
        )

    @property
    def are_met(self) -> bool:
        """Whether every claim is met."""
        return all(claim.is_met for claim in self.claims)

    def __str__(self) -> str:
        """Return the text, a line per claim, and a line per reason for which others are not made."""
        lines = [*map(str, self.claims), *_reasons(self.unclaimed)]
        return "\n".join([self.text, "", "Claims", *lines]) if lines else self.text


def _reasons(unclaimed: Iterable[Unclaimed]) -> Iterator[str]:
    names: dict[tuple[str, ...], list[str]] = {}
    for claim in unclaimed:
        names.setdefault(claim.missing, []).append(claim.name)
    for missing, concerned in names.items():
        verb = "was" if len(missing) == 1 else "were"
        yield f"not claimed, because {', '.join(missing)} {verb} left out: {'; '.join(concerned)}"
