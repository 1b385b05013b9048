"""What a study concludes: tables, and numbers next to the bounds that they must keep."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Literal, TypeAlias, final

from relforest.experiments.sheets import Passage, Sheet

Verdict: TypeAlias = Literal["met", "MISSED", "not claimed"]


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
    missing : tuple of str
        What was left out, in words, so that nothing is claimed.
    """

    name: str
    measured: float = math.nan
    low: float = -math.inf
    high: float = math.inf
    missing: tuple[str, ...] = ()

    @property
    def verdict(self) -> Verdict:
        """Whether the number lies in its range; NaN does not."""
        if self.missing:
            return "not claimed"
        return "met" if self.low <= self.measured <= self.high else "MISSED"

    @property
    def is_missed(self) -> bool:
        """Whether the number does not lie in its range."""
        return self.verdict == "MISSED"

    @property
    def bounds(self) -> str:
        """What the number must keep, in words."""
        bounds = []
        if not math.isinf(self.low):
            bounds.append(f"at least {self.low:.4g}")
        if not math.isinf(self.high):
            bounds.append(f"at most {self.high:.4g}")
        return " and ".join(bounds)

    def __str__(self) -> str:
        """Return the verdict, the name, the number and its bounds."""
        return f"{self.verdict:<6} {self.name}: {self.measured:.4g} ({self.bounds})"


@final
@dataclass(frozen=True, slots=True)
class Findings:
    """The result of a study.

    Parameters
    ----------
    text : str
        Remarks at the beginning.
    claims : tuple of Claim
        Also those that cannot be made.
    parts : tuple of Sheet and Passage
    """

    text: str
    claims: tuple[Claim, ...] = ()
    parts: tuple[Sheet | Passage, ...] = ()

    @property
    def are_met(self) -> bool:
        """Whether no claim is missed."""
        return not any(claim.is_missed for claim in self.claims)

    @property
    def documents(self) -> Mapping[str, str]:
        """Further files by name: the tables in Markdown."""
        return (
            {"tables.md": "\n\n".join(part.to_markdown() for part in self.parts) + "\n"} if self.parts else {}
        )

    def __str__(self) -> str:
        """Return remarks, tables, a line per claim, and one per reason for which others are not made."""
        blocks = [self.text, *(part.to_text() for part in self.parts)]
        if self.claims:
            made = [str(claim) for claim in self.claims if not claim.missing]
            blocks.append("\n".join(["Claims", *made, *_reasons(self.claims)]))
        return "\n\n".join(block for block in blocks if block)


def _reasons(claims: Iterable[Claim]) -> Iterator[str]:
    names: dict[tuple[str, ...], list[str]] = {}
    for claim in claims:
        if claim.missing:
            names.setdefault(claim.missing, []).append(claim.name)
    for missing, concerned in names.items():
        verb = "was" if len(missing) == 1 else "were"
        yield f"not claimed, because {', '.join(missing)} {verb} left out: {'; '.join(concerned)}"
