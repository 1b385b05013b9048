from __future__ import annotations

from pathlib import Path

import pytest
from matplotlib.figure import Figure

from relforest.reports.figure_files import save_figure
from relforest.support.errors import InputError


def line_figure() -> Figure:
    figure = Figure(figsize=(2, 1))
    axes = figure.add_subplot()
    axes.plot([0, 1], [1, 0], marker="o")
    axes.set_clip_path(axes.patch)
    axes.text(0.5, 0.5, "middle")
    return figure


@pytest.mark.parametrize("suffix", [".png", ".svg", ".PNG"])
def test_equal_figures_give_equal_bytes(tmp_path: Path, suffix: str) -> None:
    first, second = tmp_path / f"first{suffix}", tmp_path / f"second{suffix}"
    save_figure(line_figure(), first)
    save_figure(line_figure(), second)

    assert first.read_bytes() == second.read_bytes()


@pytest.mark.parametrize(
    ("suffix", "start"), [(".png", b"\x89PNG\r\n\x1a\n"), (".svg", b'<?xml version="1.0"')]
)
def test_the_suffix_decides_the_format(tmp_path: Path, suffix: str, start: bytes) -> None:
    save_figure(line_figure(), tmp_path / "new" / f"figure{suffix}")

    assert (tmp_path / "new" / f"figure{suffix}").read_bytes().startswith(start)


def test_no_date_and_no_program_is_written(tmp_path: Path) -> None:
    save_figure(line_figure(), tmp_path / "figure.svg")
    save_figure(line_figure(), tmp_path / "figure.png")

    assert "<dc:date>" not in (tmp_path / "figure.svg").read_text("utf-8")
    assert b"Software" not in (tmp_path / "figure.png").read_bytes()


@pytest.mark.parametrize(("name", "found"), [("figure.pdf", "the suffix '.pdf'"), ("figure", "no suffix")])
def test_other_suffixes_are_refused(tmp_path: Path, name: str, found: str) -> None:
    with pytest.raises(InputError, match=rf"{name} has {found}: pictures are written as .png or .svg"):
        save_figure(line_figure(), tmp_path / name)

    assert list(tmp_path.iterdir()) == []


def test_a_huge_figure_gets_fewer_pixels(tmp_path: Path) -> None:
    for size, most in (((2, 600), 2**16 - 1), ((60, 60), 6000)):
        figure = Figure(figsize=size)
        save_figure(figure, tmp_path / "figure.png")
        # The width and the height stand behind the signature and the head of the first chunk.
        header = (tmp_path / "figure.png").read_bytes()[16:24]
        pixels = [int.from_bytes(header[:4], "big"), int.from_bytes(header[4:], "big")]

        assert max(pixels) <= most
        assert pixels[0] * pixels[1] <= 31e6
