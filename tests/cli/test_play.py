from __future__ import annotations

import re
from pathlib import Path

import gymnasium
import pytest

from cli.command_lines import CommandLine
from experiments.run_folders import write_run_of_questions, write_run_of_sarsa
from relforest.cli.play import WORLDS
from relforest.experiments.keepaway_team import benchmark_team
from relforest.experiments.learned_policies import learned_policy, trained_run
from relforest.playing import record_episodes
from relforest.rl.rollout import rollout
from relforest.support.rng import seed_sequence
from relforest.worlds import environment_id
from relforest.worlds.blocks.env import high_towers_env
from relforest.worlds.blocks.policies import make_policy
from relforest.worlds.environment import WorldEnv
from relforest.worlds.keepaway.env import KeepawayEnv
from relforest.worlds.keepaway.server.options import KeepawayOptions

TASKS = ("high-towers", "color-grouping", "arch")
SHORT = ("play", "keepaway", "--max-cycles", "40")


@pytest.mark.parametrize("name", list(WORLDS))
def test_the_policies_of_the_command_line_are_those_of_the_worlds(name: str) -> None:
    env = gymnasium.make(environment_id(name)).unwrapped
    assert isinstance(env, WorldEnv)
    assert WORLDS[name].policies.keys() == env.policies.keys()


@pytest.mark.parametrize("name", list(WORLDS))
def test_a_trained_policy_plays_every_world(name: str, run: CommandLine, tmp_path: Path) -> None:
    out = tmp_path / "episode.html"
    outcome = run("play", name, "--policy", "trained", "--explain", "--out", out)

    assert outcome.code == 0
    assert "episode 1: " in outcome.out
    assert "more than" in outcome.out  # what spoke for an action
    assert "trained policy" in out.read_text("utf-8")


def test_the_trained_keepers_hold_the_ball_longer_than_the_hand_coded_ones() -> None:
    env = KeepawayEnv()
    trained = rollout(env, learned_policy(trained_run("keepaway"), env), 60, seed_sequence(1))
    hand = rollout(env, env.policies["hand"], 60, seed_sequence(1))
    assert trained.episode_rewards.mean() > hand.episode_rewards.mean()


def test_an_episode_is_described(run: CommandLine) -> None:
    outcome = run(*SHORT, "--policy", "hold", "--seed", "3")
    env = KeepawayEnv(max_cycles=40)
    (episode,) = record_episodes(env, env.policies["hold"], seed=3)

    assert (outcome.code, outcome.err) == (0, "")
    assert outcome.out == (
        f"episode 1: {episode.duration:.1f} s, {len(episode.choices)} decisions, "
        f"reward {episode.reward:.2f}, {episode.end}\n"
    )


def test_several_episodes_are_described_and_summarised(run: CommandLine) -> None:
    outcome = run(*SHORT, "--policy", "hold", "--episodes", "22")
    lines = outcome.out.splitlines()

    assert len(lines) == 22
    assert lines[19].startswith("episode 20: ")
    assert lines[20] == "... and 2 more"
    spread = r"\(standard deviation \d+\.\d\d, from \d+\.\d\d to \d+\.\d\d\)"
    assert re.fullmatch(
        rf"mean of 22: \d\.\d\d s {spread}, reward \d+\.\d\d {spread}(, \d+% (out|taken|capped))+", lines[21]
    )


def test_episodes_that_take_too_long_are_cut_off(run: CommandLine) -> None:
    outcome = run("play", "keepaway", "--max-cycles", "20", "--policy", "hand")
    assert re.fullmatch(r"episode 1: 2\.0 s, \d+ decisions, reward \d+\.00, capped\n", outcome.out)


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
        (("--out", "game.png"), "--out game.png must end in .html: the page is one HTML file"),
        (("--keepers", "1"), "--keepers must be an integer from 2 to 32, got 1"),
        (("--takers", "0"), "--takers must be an integer from 1 to 32, got 0"),
        (("--size", "2"), "--size must be"),
        (("--size", "20", "20", "20"), "--size must be one number, or a length and a width, got 3 numbers"),
        (("--episodes", "0"), "--episodes must be an integer of at least 1, got 0"),
        (("--max-cycles", "-1"), "--max-cycles must be an integer from 0 to 1000000, got -1"),
        (("--seed", "-1"), "--seed must be an integer of at least 0, got -1"),
        (
            ("--policy", "careful"),
            "--policy must be one of 'hand', 'hold', 'random', 'trained', or a run folder, got 'careful'",
        ),
        (("--blocks", "4"), "--blocks belongs to high-towers, color-grouping, arch, not to keepaway"),
        (("--distance", "rgb"), "--distance belongs to color-grouping, not to keepaway: omit it"),
        (("--max-actions", "4"), "--max-actions belongs to high-towers, color-grouping, arch, not to"),
    ],
)
def test_bad_options_are_one_clear_line(run: CommandLine, arguments: tuple[str, ...], complaint: str) -> None:
    outcome = run("play", "keepaway", *arguments)

    assert (outcome.code, outcome.out) == (2, "")
    assert complaint in outcome.err
    assert len(outcome.err.splitlines()) == 1


def test_a_learned_policy_plays(run: CommandLine, tmp_path: Path) -> None:
    folder, out = tmp_path / "run", tmp_path / "page.html"
    write_run_of_sarsa(folder, benchmark_team(KeepawayOptions()), KeepawayOptions())

    assert run("play", "keepaway", "--policy", folder, "--max-cycles", "9", "--out", out).code == 0
    assert f'"subtitle":"learned in {folder}, ' in out.read_text("utf-8")
    assert "is not a run" in run("play", "keepaway", "--policy", tmp_path).err


def test_each_decision_is_explained_on_demand(run: CommandLine, tmp_path: Path) -> None:
    write_run_of_questions(tmp_path / "run")
    command = ("play", "corridor", "--policy", tmp_path / "run", "--seed", "1")
    outcome = run(*command, "--explain", "--out", tmp_path / "page.html")
    lines = outcome.out.splitlines()

    assert (outcome.code, len(lines)) == (0, 11)
    assert re.fullmatch(
        r"   0\.0 s  (left|right): worth \d\.\d\d more than (left|right); for it: some object has "
        r"location at least 0\.5 \((if (left|right); )?(true|off by 0\.\d+); it is the agent\) \+\d\.\d\d.*",
        lines[0],
    )
    assert '"marks":[1]' in (tmp_path / "page.html").read_text("utf-8")
    # Without questions, right is worth more everywhere.
    few = run(*command, "--explain", "--questions", "0").out
    assert few.count("  right: worth 0.50 more than left; for it: right as such") == 10


def test_what_cannot_be_explained_is_named(run: CommandLine, tmp_path: Path) -> None:
    write_run_of_sarsa(tmp_path / "sarsa", benchmark_team(KeepawayOptions()), KeepawayOptions())
    write_run_of_questions(tmp_path / "q")
    write_run_of_questions(tmp_path / "new", iterations=0)
    for arguments, complaint in (
        (("keepaway", "--explain"), "--explain is for what was learned: --policy must be 'trained', or"),
        (("keepaway", "--questions", "3"), "--questions is for what was learned"),
        (
            ("keepaway", "--explain", "--policy", tmp_path / "sarsa"),
            "learned has no parts that could be told",
        ),
        (
            ("corridor", "--questions", "-1", "--policy", tmp_path / "q"),
            "--questions must be an integer of at",
        ),
        (("keepaway", "--explain", "--policy", tmp_path / "q"), "was trained on objects with ('location',)"),
        (("corridor", "--explain", "--policy", tmp_path / "new"), "has not learned anything yet"),
    ):
        outcome = run("play", *arguments)
        assert outcome.code != 0
        assert complaint in outcome.err


def test_unknown_worlds_are_refused(run: CommandLine) -> None:
    outcome = run("play", "maze")

    assert outcome.code == 2
    assert "keepaway" in outcome.err


def test_the_corridor_is_played(run: CommandLine, tmp_path: Path) -> None:
    outcome = run("play", "corridor", "--out", tmp_path / "page.html")

    assert (outcome.code, outcome.out) == (0, "episode 1: 10.0 s, 10 decisions, reward 6.00\n")
    assert '"subtitle":"optimal policy, reward at both ends, seed 0"' in (tmp_path / "page.html").read_text()


def test_an_episode_of_blocks_is_described(run: CommandLine) -> None:
    outcome = run("play", "high-towers", "--policy", "small-first", "--seed", "3")
    env = high_towers_env()
    (episode,) = record_episodes(env, make_policy("small-first", env), seed=3)

    assert (outcome.code, outcome.err) == (0, "")
    assert outcome.out == (
        f"episode 1: {episode.duration:.1f} s, {len(episode.choices)} decisions, "
        f"mean height from {episode.scores[0]:.2f} to {episode.scores[-1]:.2f}, "
        f"reward {episode.reward:.2f}\n"
    )


def test_several_episodes_of_blocks_are_described_and_summarised(run: CommandLine) -> None:
    outcome = run("play", "arch", "--policy", "random", "--max-actions", "1", "--episodes", "22")
    lines = outcome.out.splitlines()

    assert len(lines) == 22
    assert re.fullmatch(
        r"episode 1: \d+\.\d s, 1 decision, area of the arch from \d+\.\d\d to \d+\.\d\d, reward \d+\.\d\d",
        lines[0],
    )
    assert lines[20] == "... and 2 more"
    assert re.fullmatch(
        r"mean of 22: \d+\.\d\d s \(standard .*\), "
        r"reward \d+\.\d\d \(standard deviation \d+\.\d\d, from 0\.00 to \d+\.\d\d\), "
        r"final area of the arch \d+\.\d\d",
        lines[21],
    )


@pytest.mark.parametrize(
    ("task", "title", "subtitle"),
    [
        ("high-towers", "High towers", "large-first policy, 5 blocks, seed 4"),
        ("color-grouping", "Color grouping", "manual policy, 5 blocks, ciede2000, seed 4"),
        ("arch", "Arch", "careful policy, 3 blocks, seed 4"),
    ],
)
def test_a_page_of_each_task_is_written(
    run: CommandLine, tmp_path: Path, task: str, title: str, subtitle: str
) -> None:
    pages = [tmp_path / f"{number}.html" for number in range(3)]
    for page, seed in zip(pages, (4, 4, 5), strict=True):
        outcome = run("play", task, "--max-actions", "2", "--seed", seed, "--out", page)
        assert (outcome.code, outcome.err) == (0, f"wrote {page}\n")
    first, second, other = (page.read_text("utf-8") for page in pages)

    assert first == second != other
    assert f"<title>{title}</title>" in first
    assert f'"subtitle":"{subtitle}"' in first


def test_blocks_and_color_distances_can_be_chosen(run: CommandLine, tmp_path: Path) -> None:
    out = tmp_path / "page.html"
    options = ("--policy", "random", "--blocks", "3", "--max-actions", "1", "--distance", "rgb")

    assert run("play", "color-grouping", *options, "--out", out).code == 0
    assert '"subtitle":"random policy, 3 blocks, rgb, seed 0"' in out.read_text("utf-8")
    assert '"words":"2"' in out.read_text("utf-8")
    assert '"words":"3"' not in out.read_text("utf-8")


@pytest.mark.parametrize("task", TASKS)
@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        (("--keepers", "3"), "--keepers belongs to keepaway, not to"),
        (("--takers", "2"), "--takers belongs to keepaway, not to"),
        (("--size", "20"), "--size belongs to keepaway, not to"),
        (("--perception", "exact"), "--perception belongs to keepaway, not to"),
        (("--max-cycles", "9"), "--max-cycles belongs to keepaway, not to"),
        (("--policy", "hand"), "--policy must be one of '"),
        (("--blocks", "0"), "--blocks must be an integer from 1 to "),
        (("--max-actions", "0"), "--max-actions must be an integer from 1 to 1000, got 0"),
        (("--episodes", "0"), "--episodes must be an integer of at least 1, got 0"),
        (("--out", "page.txt"), "page.txt must end in .html"),
    ],
)
def test_bad_options_of_blocks_are_one_clear_line(
    run: CommandLine, task: str, arguments: tuple[str, ...], complaint: str
) -> None:
    outcome = run("play", task, *arguments)

    assert (outcome.code, outcome.out) == (2, "")
    assert complaint in outcome.err
    assert len(outcome.err.splitlines()) == 1
