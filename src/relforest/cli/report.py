"""``relforest report``: what studies and runs have found, as one page."""

# Heavy imports wait until the command runs, so that --help answers at once.
# ruff: noqa: PLC0415

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, final

from tyro.conf import Positional, arg

from relforest.cli.outputs import check_free
from relforest.cli.progress import note, working


@final
@dataclass(frozen=True, slots=True)
class ReportOptions:
    """Write one page about studies and runs, from what is in their folders.

    Of a study, for which a copy of its rows.csv is enough, the page has claims, figures and tables; of runs,
    their rewards, and what the first one has learned: in words, drawn over scenes, and as episodes to play,
    with the reasons for each decision. Nothing is computed again but these episodes. The page is a single
    HTML file that any browser opens offline.

    For example:
      relforest report runs/corridor --out corridor.html
      relforest report runs/keepaway-learning runs/keepaway --episodes 3 --out keepaway.html

    Parameters
    ----------
    folders
        Folders of relforest experiment and relforest learn, finished or not, or files rows.csv of studies.
    out
        Page to write.
    title
        Its title.
    episodes
        Episodes to play with each policy.
    seed
        Of these episodes.
    force
        Replace the page if it exists.
    """

    folders: Annotated[Positional[tuple[Path, ...]], arg(metavar="FOLDER")]
    out: Annotated[Path, arg(metavar="FILE.html")]
    title: str = "Report"
    episodes: int = 2
    seed: int = 0
    force: bool = False


def report(options: ReportOptions) -> int:
    """Write the page; the exit code is 0."""
    check_free(options.out, force=options.force)
    with working("reading"):
        from relforest.experiments.report.folders import section_of
        from relforest.experiments.report.page import report_page
        from relforest.support.files import write_text

        sections = [
            section_of(folder, episodes=options.episodes, seed=options.seed) for folder in options.folders
        ]
        write_text(options.out, report_page(sections, title=options.title))
    note(f"wrote {options.out}")
    return 0
