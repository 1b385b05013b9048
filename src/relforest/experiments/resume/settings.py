"""What is killed, how and how often, and with how many processes it goes on."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from operator import attrgetter
from types import MappingProxyType
from typing import Final, final

GROUP: Final = "group"
PARENT: Final = "parent"


@final
@dataclass(frozen=True, slots=True)
class ResumeSetting:
    """A run, or several at the same time, killed at a number of moments and started again each time.

    Parameters
    ----------
    name : str
        As the command line has it; settings of one name are parts of one variant.
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
    whom : {"group", "parent"}
        Whether all processes are killed with SIGKILL, or in turn only the first with SIGKILL and SIGTERM, and
        all with SIGINT and SIGHUP, as by Ctrl-C and a closed terminal: those that it started must end too.
    part : int
        Number of the part of its variant.
    """

    name: str
    title: str
    runs: int
    jobs: int
    resumed_jobs: int
    episodes: int = 200
    iterations: int = 4
    moments: int = 10
    kills: int = 1
    whom: str = GROUP
    part: int = 0

    def __str__(self) -> str:
        """Return the title."""
        return self.title


_ORPHANS: Final = "two small runs in two processes, the first process killed"
_N_PARTS: Final = 5

SETTINGS: Final = (
    ResumeSetting("threads", "one run, then two threads", 1, 1, 2),
    ResumeSetting("processes", "two runs in two processes", 2, 2, 2),
    ResumeSetting("thrice", "two runs in one process, then in two, killed three times", 2, 1, 2, kills=3),
    *(
        ResumeSetting(
            "orphans", _ORPHANS, 2, 2, 2, episodes=40, iterations=2, moments=20, whom=PARENT, part=part
        )
        for part in range(_N_PARTS)
    ),
)
SMOKE: Final = (
    ResumeSetting("threads", "one run", 1, 1, 1, episodes=5, iterations=1, moments=1),
    ResumeSetting("orphans", _ORPHANS, 2, 2, 2, episodes=5, iterations=1, moments=1, whom=PARENT),
)

CHOICES: Final[Mapping[str, Callable[[ResumeSetting], str]]] = MappingProxyType(
    {"methods": attrgetter("name")}
)
"""What settings may be chosen by on the command line."""
