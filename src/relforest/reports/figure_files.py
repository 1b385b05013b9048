"""Writing figures to files, atomically and with the same bytes every time."""

from __future__ import annotations

import io
import math
from os import PathLike
from pathlib import Path
from typing import Final

import matplotlib as mpl
from matplotlib.figure import Figure

from relforest.reports.style import styled
from relforest.support.errors import InputError
from relforest.support.files import write_bytes

SUFFIXES: Final = (".png", ".svg")

_MOST_PIXELS: Final = 3e7
# The limit of Matplotlib's renderer.
_MOST_ALONG: Final = 2**16 - 1

# Metadata that Matplotlib writes by default; None omits it.
_METADATA: Final[dict[str, dict[str, None]]] = {
    ".png": {"Software": None},
    ".svg": {"Creator": None, "Date": None},
}


def check_suffix(path: str | PathLike[str], *, others: tuple[str, ...] = ()) -> None:
    """Check that a path has the suffix of a picture; the message also names `others` that would do.

    Raises
    ------
    InputError
        If the suffix is not in `SUFFIXES`.
    """
    suffix = Path(path).suffix
    if suffix.lower() not in SUFFIXES:
        found = f"the suffix {suffix!r}" if suffix else "no suffix"
        also = f", pages and code as {', '.join(others)}" if others else ""
        raise InputError(f"{path} has {found}: pictures are written as {' or '.join(SUFFIXES)}{also}")


def save_figure(figure: Figure, path: str | PathLike[str]) -> None:
    """Write a figure as PNG or SVG, depending on the suffix.

    Equal figures give equal bytes: no date or program version is written.

    Parameters
    ----------
    figure : matplotlib.figure.Figure
    path : path
        Missing parent folders are created, an existing file is replaced.

    Raises
    ------
    InputError
        If the suffix is neither ``.png`` nor ``.svg``.
    OSError
        If the file cannot be written.
    """
    check_suffix(path)
    write_bytes(path, _rendered(figure, Path(path).suffix.lower()))


def svg_text(figure: Figure) -> str:
    """Return a figure as an SVG element to be put into HTML, no wider than there is room."""
    text = _rendered(figure, ".svg").decode("utf-8")
    return text[text.index("<svg") :].replace("<svg ", '<svg style="max-width: 100%; height: auto" ', 1)


def _rendered(figure: Figure, suffix: str) -> bytes:
    stream = io.BytesIO()
    with styled():
        figure.savefig(
            stream, format=suffix.removeprefix("."), dpi=_resolution(figure), metadata=_METADATA[suffix]
        )
    return stream.getvalue()


def _resolution(figure: Figure) -> float:
    """Return the resolution in pixels per inch, reduced for figures too large for memory."""
    width, height = map(float, figure.get_size_inches())
    usual = float(mpl.rcParams["savefig.dpi"])
    return min(usual, math.sqrt(_MOST_PIXELS / (width * height)), _MOST_ALONG / max(width, height))
