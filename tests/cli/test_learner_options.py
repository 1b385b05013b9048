from __future__ import annotations

from dataclasses import fields

import pytest

from relforest.cli.early_checks import UsageError
from relforest.cli.learner_options import RPIOptions, SarsaOptions, given
from relforest.rl.baselines.settings import SarsaSettings
from relforest.rl.settings import LSPISettings, RPISettings
from relforest.support.errors import RelforestError
from relforest.trees.settings import TreeSettings


def test_without_options_the_settings_are_those_of_the_task() -> None:
    base = RPISettings(epsilon=0.3, tree=TreeSettings(attempts=7))

    assert RPIOptions().settings(base) == base
    assert SarsaOptions().settings() == SarsaSettings()
    assert given(RPIOptions()) == given(SarsaOptions()) == {}


def test_every_option_of_smrf_rpi_changes_its_setting() -> None:
    options = RPIOptions(
        features="bits",
        epsilon=0.0,
        discount=0.5,
        no_bootstrapping=True,
        rounds=3,
        trees_per_label=4,
        alpha=0.01,
        max_scenes=50,
        max_samples=60,
        lspi_iterations=9,
        question_test="permutation",
        question_alpha=0.001,
        search="screened",
        permutations=999,
        attempts=2,
        max_points=70,
    )

    assert set(given(options)) == {entry.name for entry in fields(RPIOptions)}
    assert options.settings(RPISettings()) == RPISettings(
        features="bits",
        epsilon=0.0,
        bootstrap_on_truncation=False,
        max_rounds=3,
        trees_per_label=4,
        alpha=0.01,
        max_scenes=50,
        max_samples=60,
        lspi=LSPISettings(max_iterations=9),
        tree=TreeSettings(
            test="permutation", search="screened", alpha=0.001, permutations=999, attempts=2, max_points=70
        ),
    )


def test_every_option_of_sarsa_changes_its_setting() -> None:
    options = SarsaOptions(sarsa_alpha=0.5, sarsa_gamma=0.9, sarsa_epsilon=0.2, sarsa_lambda=0.7)

    assert options.settings() == SarsaSettings(alpha=0.5, gamma=0.9, epsilon=0.2, trace_decay=0.7)


@pytest.mark.parametrize(
    ("options", "complaint"),
    [
        (RPIOptions(rounds=0), "^--rounds must be an integer of at least 1, got 0"),
        (RPIOptions(lspi_iterations=0), "^--lspi-iterations must be an integer"),
        (RPIOptions(question_alpha=1.0), "^--question-alpha must be a number above 0 and below 1"),
        (RPIOptions(discount=-0.1), "^--discount must be a number of at least 0"),
        (RPIOptions(question_test="permutation", question_alpha=0.001), "permutations=99 can never reach"),
    ],
)
def test_errors_name_the_option_as_it_is_written(options: RPIOptions, complaint: str) -> None:
    with pytest.raises(RelforestError, match=complaint):
        options.settings(RPISettings())


def test_errors_about_sarsa_name_the_option_as_it_is_written() -> None:
    with pytest.raises(UsageError, match=r"^--sarsa-lambda must be a number of at least 0 and of at most 1"):
        SarsaOptions(sarsa_lambda=7.0).settings()
