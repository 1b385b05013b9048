from __future__ import annotations

import re
from pathlib import Path

import pytest

from cli.command_lines import CommandLine
from relforest.worlds.keepaway.durations import episode_durations

SHORT = ("play", "keepaway", "--max-cycles", "40")


def test_an_episode_is_told(run: CommandLine) -> None:
    outcome = run(*SHORT, "--policy", "hold", "--seed", "3")
    (duration,) = episode_durations("hold", episodes=1, seed=3)

    assert (outcome.code, outcome.err) == (0, "")
    assert re.fullmatch(
        rf"episode 1: {duration / 10:.1f} s, (the ball went out|a taker took the ball)\n", outcome.out
    )


def test_several_episodes_are_told_and_summarised(run: CommandLine) -> None:
    outcome = run(*SHORT, "--policy", "hold", "--episodes", "22")
    lines = outcome.out.splitlines()

    assert len(lines) == 22
    assert lines[19].startswith("episode 20: ")
    assert lines[20] == "... and 2 more"
    assert re.fullmatch(
        r"mean of 22: \d\.\d s \(standard deviation \d\.\d s, from \d\.\d to \d\.\d s\), \d+% taken",
        lines[21],
    )


def test_episodes_that_take_too_long_are_cut_off(run: CommandLine) -> None:
    assert run("play", "keepaway", "--max-cycles", "3").out == "episode 1: 0.3 s, cut off\n"


def test_a_page_is_written(run: CommandLine, tmp_path: Path) -> None:
    out = tmp_path / "pages" / "game.html"
    command = (*SHORT, "--keepers", "4", "--takers", "3", "--size", "25", "20", "--out", out)
    outcome = run(*command, "--policy", "random", "--perception", "exact")
    text = out.read_text("utf-8")

    assert (outcome.code, outcome.err) == (0, f"wrote {out}\n")
    assert text.startswith("<!DOCTYPE html>")
    assert "<title>Keepaway: 4 keepers, 3 takers</title>" in text
    assert "random policy, 25 m by 20 m, exact perception, seed 0" in text
    assert list(out.parent.iterdir()) == [out]


def test_the_same_seed_gives_the_same_page(run: CommandLine, tmp_path: Path) -> None:
    pages = [tmp_path / f"{number}.html" for number in range(3)]
    for page, seed in zip(pages, (4, 4, 5), strict=True):
        assert run(*SHORT, "--seed", seed, "--out", page).code == 0
    first, second, other = (page.read_bytes() for page in pages)

    assert first == second != other


def test_pages_are_replaced_only_on_demand(run: CommandLine, tmp_path: Path) -> None:
    out = tmp_path / "game.html"
    out.write_text("precious")

    assert "exists already" in run(*SHORT, "--out", out).err
    assert out.read_text() == "precious"
    assert run(*SHORT, "--out", out, "--force").code == 0
    assert out.read_text() != "precious"


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        (("--out", "game.png"), "game.png must end in .html: --out writes a page"),
        (("--keepers", "1"), "keepers must be an integer of at least 2, got 1"),
        (("--takers", "0"), "takers must be an integer of at least 1, got 0"),
        (("--size", "2"), "size must be"),
        (("--size", "20", "20", "20"), "--size takes one number, or a length and a width, got 3 numbers"),
        (("--episodes", "0"), "episodes must be an integer of at least 1, got 0"),
        (("--max-cycles", "-1"), "max_cycles must be an integer of at least 0, got -1"),
        (("--seed", "-1"), "-1"),
    ],
)
def test_bad_options_are_one_clear_line(run: CommandLine, arguments: tuple[str, ...], complaint: str) -> None:
    outcome = run("play", "keepaway", *arguments)

    assert (outcome.code, outcome.out) == (1, "")
    assert complaint in outcome.err
    assert len(outcome.err.splitlines()) == 1


def test_unknown_worlds_are_refused(run: CommandLine) -> None:
    outcome = run("play", "corridor")

    assert outcome.code == 2
    assert "keepaway" in outcome.err
