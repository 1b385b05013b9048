"""The pictures of a run folder, drawn again only when the runs have gone on."""

from __future__ import annotations

from pathlib import Path
from typing import Final

from relforest.experiments.run_config import RunConfig
from relforest.reports.figure_files import save_figure
from relforest.reports.learning_figure import reward_figure
from relforest.runs.store import CHECKPOINT, metrics_of
from relforest.support.parallel import one_blas_thread
from relforest.support.progress import report

REWARD: Final = "reward.png"


def draw_runs(config: RunConfig, out: Path) -> list[Path]:
    """Draw the rewards of all runs and, where the task has such a picture, what the first one learned.

    Every run in the folder `out` has been learned.

    Return the pictures, which stand in `out`; those newer than the runs are left as they are.

    References
    ----------
    Palmer (2015), Figures 7.1, 7.2 and 7.19.
    """
    folders, task = config.folders(out), config.definition
    reward = out / REWARD
    if _is_stale(reward, folders):
        report(f"drawing {REWARD}")
        runs = [metrics_of(folder) for folder in folders]
        title = f"{task.name}, {config.episodes} episodes per iteration"
        save_figure(reward_figure({task.name: runs}, title=title, optimum=task.optimum), reward)
    learned = task.pictures[config.method]
    if learned is not None and _is_stale(out / learned.name, folders[:1]):
        report(f"drawing {learned.name}")
        with one_blas_thread():
            figure = learned.draw(folders[0], config.make())
        save_figure(figure, out / learned.name)
    return pictures_of(config, out)


def pictures_of(config: RunConfig, out: Path) -> list[Path]:
    """Return the pictures of finished runs: what the first one learned, if there is one, and the rewards."""
    learned = config.definition.pictures[config.method]
    return [*([] if learned is None else [out / learned.name]), out / REWARD]


def _is_stale(picture: Path, folders: list[Path]) -> bool:
    newest = max((folder / CHECKPOINT).stat().st_mtime_ns for folder in folders)
    return not picture.exists() or picture.stat().st_mtime_ns < newest
