"""The pictures of a run folder, drawn again only when the runs have gone on."""

from __future__ import annotations

from pathlib import Path
from typing import Final

from relforest.experiments.run_config import RunConfig
from relforest.experiments.run_metrics import metrics_of
from relforest.reports.figure_files import save_figure
from relforest.reports.learning_figure import reward_figure
from relforest.rl.checkpoint import CHECKPOINT
from relforest.rl.rpi import SMRFRPI
from relforest.support.parallel import one_blas_thread

Q_FUNCTION: Final = "q-function.png"
REWARD: Final = "reward.png"


def draw_runs(config: RunConfig, out: Path) -> list[Path]:
    """Draw the rewards of all runs and, where the task has such a picture, the values of the first one.

    Parameters
    ----------
    config : RunConfig
    out : path
        The folder of the runs; every run has been learned.

    Returns
    -------
    list of path
        The pictures, which stand in `out`; those newer than the runs are left as they are.

    References
    ----------
    Palmer (2015), Figures 7.1 and 7.2.
    """
    folders, task = config.folders(out), config.definition
    reward, pictures = out / REWARD, [out / REWARD]
    if _is_stale(reward, folders):
        runs = [metrics_of(folder) for folder in folders]
        title = f"{task.name}, {config.episodes} episodes per iteration"
        save_figure(reward_figure({task.name: runs}, title=title, optimum=task.optimum), reward)
    if task.draw_values is not None:
        pictures.append(out / Q_FUNCTION)
        if _is_stale(out / Q_FUNCTION, folders[:1]):
            agent = SMRFRPI.load(folders[0], task.make())
            with one_blas_thread():
                figure = task.draw_values(agent)
            save_figure(figure, out / Q_FUNCTION)
    return pictures


def _is_stale(picture: Path, folders: list[Path]) -> bool:
    newest = max((folder / CHECKPOINT).stat().st_mtime_ns for folder in folders)
    return not picture.exists() or picture.stat().st_mtime_ns < newest
