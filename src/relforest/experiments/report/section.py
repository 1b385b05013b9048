"""A section of a report: what was found in one folder."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias, final

from matplotlib.figure import Figure

from relforest.experiments.claims import Claim
from relforest.experiments.sheets import Passage, Sheet


@final
@dataclass(frozen=True, slots=True)
class Picture:
    """A figure, and what it shows in words."""

    caption: str
    figure: Figure


@final
@dataclass(frozen=True, slots=True)
class Player:
    """A page that plays episodes, see `relforest.playing.page`, and what it shows."""

    caption: str
    page: str


Part: TypeAlias = Picture | Player | Sheet | Passage


@final
@dataclass(frozen=True, slots=True)
class Section:
    """What was found in one folder."""

    heading: str
    lead: tuple[str, ...]  # paragraphs at the beginning
    claims: tuple[Claim, ...] = ()  # numbers beside the bounds that they must keep
    parts: tuple[Part, ...] = ()
