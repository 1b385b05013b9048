"""What is killed, how often, and with how many processes it goes on."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, final


@final
@dataclass(frozen=True, slots=True)
class ResumeSetting:
    """A run, or several at the same time, killed at a number of moments and started again each time.

    Parameters
    ----------
    title : str
        A few words.
    runs, jobs : int
        Options of ``relforest learn``.
    resumed_jobs : int
        The same, when it is started again.
    episodes, iterations : int
        Options of ``relforest learn``.
    moments : int
        Moments, spread over the duration of the uninterrupted run.
    kills : int
        How often the run of each moment is killed: at that moment, and after starting it again at others.
    """

    title: str
    runs: int
    jobs: int
    resumed_jobs: int
    episodes: int = 200
    iterations: int = 4
    moments: int = 10
    kills: int = 1

    def __str__(self) -> str:
        """Return the title."""
        return self.title


SETTINGS: Final = (
    ResumeSetting("one run, then two threads", 1, 1, 2),
    ResumeSetting("two runs in two processes", 2, 2, 2),
    ResumeSetting("two runs in one process, then in two, killed three times", 2, 1, 2, kills=3),
)
SMOKE: Final = (ResumeSetting("one run", 1, 1, 1, episodes=5, iterations=1, moments=1),)
