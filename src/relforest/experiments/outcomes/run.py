"""A task and a draw of its scenes -> how well every model predicts outcomes."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from importlib.util import find_spec
from time import process_time

import numpy as np
from numpy.typing import NDArray
from scipy.special import logit
from scipy.stats import norm
from sklearn.metrics import roc_auc_score, roc_curve

from relforest.experiments.outcomes.networks import NETWORKS
from relforest.experiments.outcomes.protocol import repeated, row
from relforest.experiments.outcomes.rivals import LEARNERS, Learner, Scores
from relforest.experiments.outcomes.scenes import TESTING, TRAINING, Labelled, drawn
from relforest.experiments.outcomes.settings import OF_2012, OURS, SIZES, SMRF, OutcomeSetting
from relforest.experiments.study import Context, Unavailable
from relforest.experiments.table import Row
from relforest.forests import OutcomeForestClassifier
from relforest.metrics import peirce_skill_score
from relforest.support.progress import part as progress_of
from relforest.trees import TreeSettings
from relforest.volumes import CovAggSettings


def compute(setting: OutcomeSetting, context: Context) -> list[Row]:
    """Return rows of part, task, draw, trained, tested, method, measure, value.

    The scenes trained and tested on are ``small`` or ``large``.

    References
    ----------
    Palmer (2015), section 5.3.
    """
    sets = {
        (size, which): drawn(setting, context, size, which) for size in SIZES for which in (TRAINING, TESTING)
    }
    if setting.part == "protocol":
        part, rows = "protocol", repeated(setting, sets, context.stream)
    else:
        part, rows = "models", _compared(_learners(setting), sets, context)
    return [{"part": part, "task": setting.task, "draw": setting.draw, **each} for each in rows]


def unavailable(settings: Sequence[OutcomeSetting]) -> Mapping[OutcomeSetting, Unavailable]:
    """Return the settings with neural networks, unless PyTorch is installed."""
    if find_spec("torch") is not None:
        return {}
    why = Unavailable("neural networks", "PyTorch is not installed: install the extra 'relforest[bench]'.")
    return {setting: why for setting in settings if setting.part == "networks"}


def _learners(setting: OutcomeSetting) -> Mapping[str, Learner]:
    if setting.part == "networks":
        return NETWORKS
    published = TreeSettings()
    of_2012 = replace(published, covagg=CovAggSettings(learner="diverse-density"))
    return {
        OURS: outcome_forest,
        SMRF: partial(outcome_forest, smrf_trees=setting.smrf_trees, growth=published),
        OF_2012: partial(outcome_forest, smrf_trees=setting.smrf_trees, growth=of_2012),
        **LEARNERS,
    }


def _compared(
    learners: Mapping[str, Learner], sets: dict[tuple[str, int], Labelled], context: Context
) -> Iterator[Row]:
    seed = int(context.stream.generate_state(1)[0])
    if OURS in learners:
        _compile_kernels(sets[SIZES[0], TRAINING])
    for trained in SIZES:
        for method, learner in learners.items():
            with progress_of(f"{method}, {trained} scenes"):
                begin = process_time()
                scores = learner(sets[trained, TRAINING], seed)
                seconds = process_time() - begin
                for tested in SIZES:
                    scenes, labels = sets[tested, TESTING]
                    for measure, value in measures(labels, scores(scenes)).items():
                        yield row(trained, tested, method, measure, value)
            yield row(trained, trained, method, "seconds", seconds)


def measures(labels: NDArray[np.bool_], scores: NDArray[np.float64]) -> dict[str, float]:
    """Return the Peirce skill score with the threshold 0, the area under the curve, and the best score.

    The best one is with the threshold that is best for these scenes, so that what the ranking loses is told
    from what the threshold loses. The last measure is the probability that guesses as often positive score as
    much, by the normal approximation.
    """
    alarms, hits, _ = roc_curve(labels, scores)
    said = scores >= 0.0
    skill = peirce_skill_score(labels, said)
    n_positive, n = np.count_nonzero(labels), len(labels)
    error = np.sqrt(said.mean() * (1.0 - said.mean()) * (1.0 / n_positive + 1.0 / (n - n_positive)))
    return {
        "pss": skill,
        "auc": float(roc_auc_score(labels, scores)),
        "best": float((hits - alarms).max()),
        "log10 p": float(norm.logsf(skill / error) / np.log(10.0)) if error else 0.0,
    }


def outcome_forest(
    known: Labelled, seed: int, smrf_trees: int = 0, growth: TreeSettings | None = None
) -> Scores:
    """Learn the library's own model, or the source's forest of SMRF trees."""
    model = OutcomeForestClassifier(random_state=seed)
    if growth is not None:
        model.set_params(n_trees=smrf_trees, growth=growth)
    model.fit(known.scenes, known.labels)
    return lambda scenes: model.ensemble_.scores(scenes)[:, 0] - logit(model.threshold_)


def _compile_kernels(known: Labelled) -> None:
    """Use all kernels once, so that compilation is not timed."""
    scenes, labels = known.scenes.take(np.arange(min(200, len(known.labels)))), known.labels[:200]
    for growth in (None, TreeSettings(attempts=1)):
        OutcomeForestClassifier(n_trees=2, growth=growth, random_state=0).fit(scenes, labels)
