"""What is killed, how and how often, and with how many processes it is resumed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, final

from relforest.experiments.tasks import MethodName

GROUP: Final = "group"
PARENT: Final = "parent"


@final
@dataclass(frozen=True, slots=True)
class ResumeSetting:
    """One or several runs, killed at a number of moments and restarted each time."""

    name: str  # as on the command line; settings with the same name are parts of one variant
    title: str  # a few words
    runs: int
    jobs: int
    """Both are options of ``relforest learn``."""
    resumed_jobs: int  # the same for the restarts
    episodes: int = 200
    iterations: int = 4
    """Both are options of ``relforest learn``."""
    moments: int = 10  # number of moments, spread over the duration of an uninterrupted run
    kills: int = 1  # how often each run is killed: at its moment, and at further moments after each restart
    whom: str = GROUP
    """{"group", "parent"}: ``"group"`` sends SIGKILL to all processes. ``"parent"`` sends, in turn, SIGKILL
    and SIGTERM to the first process, and SIGINT and SIGHUP to all, like Ctrl-C and a closed terminal."""
    part: int = 0  # number of the part of its variant
    task: str = "corridor"
    method: MethodName = "smrf-rpi"
    """What is learned, and how."""

    def __str__(self) -> str:
        """Return the title and, if there are several parts, which kills these are."""
        first = self.part * self.moments
        return f"{self.title}, {first + 1} to {first + self.moments}" if self.whom == PARENT else self.title


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
    *(
        ResumeSetting(
            f"smrf-q-{task}", f"smrf-q on {task}", 1, 1, 2, episodes, iterations, task=task, method="smrf-q"
        )
        for task, episodes, iterations in (("keepaway", 30, 3), ("high-towers", 10, 3))
    ),
)
SMOKE: Final = (
    ResumeSetting("orphans", "one run", 1, 1, 1, episodes=5, iterations=1, moments=1, whom=PARENT),
)
