"""The options of ``relforest learn`` for one method, and the settings that they change."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Final, final

from tyro.conf import arg

from relforest.cli.early_checks import naming_options
from relforest.rl.baselines.settings import SarsaSettings
from relforest.rl.fitted.settings import Q_DISCOUNT, QSettings, Source
from relforest.rl.settings import FeatureMode, RPISettings
from relforest.support.options import in_range
from relforest.trees.settings import SearchName, Test

if TYPE_CHECKING:
    from relforest.experiments.tasks import Task


def _default(value: object, metavar: str | None = None) -> Any:  # noqa: ANN401 - Tyro's annotation
    shown = metavar or ("INT" if isinstance(value, int) else "FLOAT")
    return arg(metavar=shown, help_behavior_hint=f"(default: {value})")


_RPI: Final = RPISettings()
_TREE: Final = _RPI.tree
_SARSA: Final = SarsaSettings()
_Q: Final = QSettings()


@final
@dataclass(frozen=True, slots=True)
class RPIOptions:
    """Options of --method smrf-rpi.

    Parameters
    ----------
    features
        What trees contribute: one bit per leaf, with or without the densities of the questions above it, or
        one probability per tree.
    epsilon
        Probability of a random action in training after the first iteration.
    discount
        Discount factor per unit of time.
    no_bootstrapping
        Treat the state at a time limit as terminal.
    rounds
        Maximum number of rounds of learning trees and a policy per iteration.
    trees_per_label
        Candidate trees per round and action type for high Bellman errors, and as many for low ones.
    alpha
        Significance level of the test that a candidate tree must pass.
    max_scenes
        Maximum number of scenes that a tree is learned from.
    max_samples
        Maximum number of transitions that a policy is learned from.
    lspi_iterations
        Maximum number of iterations of LSPI.
    question_test
        Test that a question of a tree must pass.
    question_alpha
        Significance level of the question test.
    search
        How the best question of a tree is found: exhaustively as in the source, or about ten times faster.
    permutations
        Shuffles per permutation test.
    attempts
        Tries for each possible question.
    max_points
        Possible questions with more instantiation sequences are left out or, if screened, sampled.
    """

    features: Annotated[FeatureMode | None, _default(_RPI.features, "{densities+bits,bits,probability}")] = (
        None
    )
    epsilon: Annotated[float | None, _default(_RPI.epsilon)] = None
    discount: Annotated[float | None, _default("that of the world", "FLOAT")] = None
    no_bootstrapping: bool = False
    rounds: Annotated[int | None, _default(_RPI.max_rounds)] = None
    trees_per_label: Annotated[int | None, _default(_RPI.trees_per_label)] = None
    alpha: Annotated[float | None, _default(_RPI.alpha)] = None
    max_scenes: Annotated[int | None, _default(_RPI.max_scenes)] = None
    max_samples: Annotated[int | None, _default(_RPI.max_samples)] = None
    lspi_iterations: Annotated[int | None, _default(_RPI.lspi.max_iterations)] = None
    question_test: Annotated[Test | None, _default(_TREE.test, "{likelihood-ratio,permutation}")] = None
    question_alpha: Annotated[float | None, _default(_TREE.alpha)] = None
    search: Annotated[
        SearchName | None,
        _default(f"{_TREE.search}, in keepaway screened", "{screened,exhaustive}"),
    ] = None
    permutations: Annotated[int | None, _default(_TREE.permutations)] = None
    attempts: Annotated[int | None, _default(_TREE.attempts)] = None
    max_points: Annotated[int | None, _default(_TREE.max_points)] = None

    def config(self, task: Task) -> dict[str, Any]:
        """Return them as options of `RunConfig`, for a task; see `settings`."""
        return {"rpi": self.settings(task.settings), "discount": self.discount}

    def settings(self, base: RPISettings) -> RPISettings:
        """Return the settings with the given options.

        Raises
        ------
        UsageError
            If one is out of its range.
        """
        if self.discount is not None:
            with naming_options(("discount",)):
                in_range("discount", self.discount, 0.0, 1.0)
        values = given(self)
        if self.no_bootstrapping:
            values["no_bootstrapping"] = False
        changed: dict[str, Any] = {"": base, "lspi": base.lspi, "tree": base.tree}
        for option, (place, name) in _PLACES.items():
            if option in values:
                with naming_options((), **{name: option}):
                    changed[place] = replace(changed[place], **{name: values[option]})
        settings: RPISettings = replace(changed[""], lspi=changed["lspi"], tree=changed["tree"])
        return settings


# The number of permutations comes first, since the level and the test are checked against it.
_PLACES: Final[Mapping[str, tuple[str, str]]] = {
    "features": ("", "features"),
    "epsilon": ("", "epsilon"),
    "no_bootstrapping": ("", "bootstrap_on_truncation"),
    "rounds": ("", "max_rounds"),
    "trees_per_label": ("", "trees_per_label"),
    "alpha": ("", "alpha"),
    "max_scenes": ("", "max_scenes"),
    "max_samples": ("", "max_samples"),
    "lspi_iterations": ("lspi", "max_iterations"),
    "permutations": ("tree", "permutations"),
    "search": ("tree", "search"),
    "attempts": ("tree", "attempts"),
    "max_points": ("tree", "max_points"),
    "question_alpha": ("tree", "alpha"),
    "question_test": ("tree", "test"),
}
"""Option -> which settings it changes (the learner's own, LSPI's, or the trees') and its name there."""


@final
@dataclass(frozen=True, slots=True)
class SarsaOptions:
    """Options of --method cmac-sarsa, cmac-sarsa-shared, rbf-sarsa and sarsa-on-smrf.

    Parameters
    ----------
    sarsa_alpha
        Step size.
    sarsa_gamma
        Discount factor per cycle.
    sarsa_epsilon
        Probability of a random action in training.
    sarsa_lambda
        Decay of eligibility traces.
    """

    sarsa_alpha: Annotated[float | None, _default(_SARSA.alpha)] = None
    sarsa_gamma: Annotated[float | None, _default(_SARSA.gamma)] = None
    sarsa_epsilon: Annotated[float | None, _default(_SARSA.epsilon)] = None
    sarsa_lambda: Annotated[float | None, _default(_SARSA.trace_decay)] = None

    def config(self, task: Task) -> dict[str, Any]:  # noqa: ARG002 - of every method
        """Return them as options of `RunConfig`; see `settings`."""
        return {"sarsa": self.settings()}

    def settings(self) -> SarsaSettings:
        """Return the settings of the benchmark with the given options.

        Raises
        ------
        UsageError
            If one is out of its range.
        """
        settings = SarsaSettings()
        for option, value in given(self).items():
            name = option.removeprefix("sarsa_")
            name = "trace_decay" if name == "lambda" else name
            with naming_options((), **{name: option}):
                settings = replace(settings, **{name: value})
        return settings


@final
@dataclass(frozen=True, slots=True)
class QOptions:
    """Options of --method smrf-q.

    Parameters
    ----------
    questions_from
        Only ask the questions of this run first, because its task is another one.
    q_discount
        Discount factor per unit of time.
    q_epsilon
        Probability of a random action in training after the first iteration.
    q_max_samples
        Maximum number of transitions that are learned from, those of the latest iterations.
    q_max_questions
        Maximum number of questions per action type, where the number of actions is unlimited.
    q_ridge
        Penalty on the weights of the questions.
    q_counts
        Conditions per action type whose objects are counted, where the number of actions is limited.
    q_trees
        Trees per action type, there also per number of remaining actions.
    q_min_leaf
        Least number of transitions in a leaf of these trees; more make smaller files.
    """

    questions_from: Annotated[Path | None, arg(metavar="RUN", help_behavior_hint="")] = None
    q_discount: Annotated[float | None, _default(Q_DISCOUNT)] = None
    q_epsilon: Annotated[float | None, _default(_Q.epsilon)] = None
    q_max_samples: Annotated[int | None, _default(_Q.max_samples)] = None
    q_max_questions: Annotated[int | None, _default(_Q.curves.max_questions)] = None
    q_ridge: Annotated[float | None, _default(_Q.curves.ridge)] = None
    q_counts: Annotated[int | None, _default(_Q.forests.counts)] = None
    q_trees: Annotated[int | None, _default(_Q.forests.trees)] = None
    q_min_leaf: Annotated[int | None, _default(_Q.forests.min_leaf)] = None

    def config(self, task: Task) -> dict[str, Any]:  # noqa: ARG002 - of every method
        """Return them as options of `RunConfig`.

        Raises
        ------
        UsageError
            If one is out of its range.
        """
        values = given(self)
        offered = values.pop("questions_from", None)
        source = None if offered is None else Source(offered, "questions")
        discount = values.pop("q_discount", None)
        if discount is not None:
            with naming_options((), discount="q_discount"):
                in_range("discount", discount, 0.0, 1.0)
        parts: dict[str, Any] = {"": QSettings(), "curves": _Q.curves, "forests": _Q.forests}
        for option, value in values.items():
            name = option.removeprefix("q_")
            place = next(place for place, part in parts.items() if hasattr(part, name))
            with naming_options((), **{name: option}):
                parts[place] = replace(parts[place], **{name: value})
        settings = replace(parts[""], curves=parts["curves"], forests=parts["forests"])
        return {"q": settings, "discount": discount, "source": source}


def given(options: RPIOptions | SarsaOptions | QOptions) -> dict[str, Any]:
    """Return the given options by name."""
    values = {entry.name: getattr(options, entry.name) for entry in fields(options)}
    return {name: value for name, value in values.items() if value is not None and value is not False}
