"""Rule sets as a scikit-learn classifier of scenes."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Final, final

import numpy as np
from scipy.special import logit, xlogy
from sklearn.utils.validation import check_is_fitted

from relforest.forests.base import SceneClassifier, settings_or
from relforest.forests.boosting import Boosted, BoostingSettings, boost
from relforest.forests.descriptions import MOST_QUESTIONS, rule_set_in_words
from relforest.forests.ensemble import Ensemble
from relforest.forests.labels import class_targets
from relforest.forests.losses import Logistic
from relforest.forests.rule_sets import Pool, RuleSet, RuleSetSettings, choose_rule_sets, rule_pool
from relforest.forests.scene_tree import Node, SceneTree, Split, Value
from relforest.forests.settings import GrowthSettings
from relforest.scenes.mixing import mixed
from relforest.support.errors import InputError
from relforest.support.options import at_least
from relforest.support.progress import part
from relforest.support.rng import RandomState, generator, seed_sequence

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from relforest.forests.tables import Found
    from relforest.scenes import Scenes

_LEARNING_RATE: Final = 0.05
_N_MIXED: Final = 2000
# Rules for several causes are found below a first question; rules that differ are worth more than the best.
RULE_GROWTH: Final = GrowthSettings(max_leaves=4, share=0.2)


@final
@dataclass(kw_only=True, eq=False, repr=False)
class SMRFRuleSetClassifier(SceneClassifier):
    """Rule set: any of a few conditions holds, chosen by description length.

    The rules are conditions from the trees of a boosted model. Of all sets of a few of them, for either
    class, those that describe the labels in the fewest bits are sampled by simulated annealing. The mean of
    their log-odds, weighted by description length, and those of the boosted model predict with equal shares.
    The description in words is the most typical set: the one that most often agrees with this mean, on scenes
    in which objects of the given ones are exchanged. Of all models of this package it is the most readable,
    and the most accurate on a few dozen scenes.

    Parameters
    ----------
    rules : RuleSetSettings, optional
        How many rules a set may have, and what they cost: a higher cost gives shorter rules.
    averaged : bool, default True
        Whether all sampled sets and the boosted model predict; False for the most typical set alone.
    n_trees : int, default 200
        Trees of the boosted model that proposes the rules.
    growth : GrowthSettings, optional
        What a rule may be, and what is tried at every node of that model. Default: trees of four leaves,
        and a fifth of the half-lines for further statements.
    random_state : int, Generator, RandomState, SeedSequence or None, default None
        Seed; an integer makes `fit` reproducible.
    n_jobs : int, default 1
        Number of threads for prediction; -1 for all cores. Does not affect the result.
    verbose : bool, default False
        Whether `fit` prints to standard error what it is doing.
    class_weight : "balanced", dict or None, default None
        Weights of the classes, as in scikit-learn.

    Attributes
    ----------
    ensemble_ : Ensemble
        Log-odds. One tree per rule set, which asks the rules one after the other, the most typical set
        first; then the trees of the boosted model.
    classes_ : (2,) array
        The labels in sorted order.
    n_sampled_ : int
        Scenes of which only a sample of the choices was searched.
    """

    rules: RuleSetSettings | None = None
    averaged: bool = True
    n_trees: int = 200
    growth: GrowthSettings | None = None
    random_state: RandomState = None
    n_jobs: int = 1
    verbose: bool = False

    def _learn(self, scenes: Scenes, y: ArrayLike, sample_weight: ArrayLike | None) -> None:
        how, growth, chosen = self._settings()
        targets = class_targets(y, len(scenes), sample_weight, self.class_weight)
        if len(targets.classes) != 2:
            raise InputError(
                f"rule sets are for two classes, got {len(targets.classes)}: use SMRFBoostingClassifier"
            )
        positive = targets.numbers == 1
        rng = generator(seed_sequence(self.random_state))
        tables = self._tables(scenes, growth, rng)
        boosted = boost(tables, len(scenes), Logistic(positive, targets.weights), (how, growth), rng)
        rules, pool = rule_pool(boosted.trees, len(scenes), chosen)
        with part("choosing rules"):
            sets = choose_rule_sets(pool, positive, targets.weights, chosen, rng)
        self.classes_: NDArray[Any] = targets.classes
        chains = tuple(_chain(each, rules, pool, positive, targets.weights) for each in sets)
        found = Ensemble(scenes.schema, np.zeros(1), chains, np.array([each.weight for each in sets]))
        with part("comparing rules"):
            averaged = _with_boosted(found, boosted, how.learning_rate)
            found = _by_agreement(found, averaged, mixed(scenes, _N_MIXED, rng))
        if self.averaged:
            self.ensemble_ = _with_boosted(found, boosted, how.learning_rate)
        else:
            self.ensemble_ = replace(found, trees=found.trees[:1], weights=np.ones(1))

    def describe(self, *, most: int = MOST_QUESTIONS) -> str:
        """Return the best rule set in words; `most` bounds the rules that are listed."""
        check_is_fitted(self)
        return rule_set_in_words(self.ensemble_, self._scored(), most=at_least("most", most, 1))

    def _settings(self) -> tuple[BoostingSettings, GrowthSettings, RuleSetSettings]:
        how = BoostingSettings(self.n_trees, _LEARNING_RATE)
        growth = settings_or("growth", self.growth, RULE_GROWTH)
        return how, growth, settings_or("rules", self.rules, RuleSetSettings())


def _by_agreement(sets: Ensemble, averaged: Ensemble, scenes: Scenes) -> Ensemble:
    """Return rule sets in the order in which they agree with the mean of all, the most typical one first."""
    leaves = sets.leaves(scenes).T
    each = np.array([tree.values[leaf, 0] > 0.0 for tree, leaf in zip(sets.trees, leaves, strict=True)])
    agreement = (each == (averaged.scores(scenes)[:, 0] > 0.0)).mean(axis=1)
    order = np.argsort(-agreement, kind="stable")
    return replace(sets, trees=tuple(sets.trees[place] for place in order), weights=sets.weights[order])


def _with_boosted(sets: Ensemble, boosted: Boosted, learning_rate: float) -> Ensemble:
    """Return the mean of the log-odds of rule sets and of a boosted model."""
    trees = tuple(grown.tree for grown in boosted.trees)
    weights = np.concatenate([sets.weights, np.full(len(trees), learning_rate)])
    return Ensemble(sets.schema, 0.5 * boosted.start, sets.trees + trees, 0.5 * weights)


def _chain(
    chosen: RuleSet,
    rules: list[Found],
    pool: Pool,
    positive: NDArray[np.bool_],
    weights: NDArray[np.float64],
) -> SceneTree:
    """Return a rule set as a tree that asks one rule after the other.

    Whichever rule holds, the log-odds are those of the scenes for which any holds.
    """
    inside = np.asarray(pool.truth[list(chosen.rules)].any(axis=0))
    held = _log_odds(inside, positive, weights)
    nodes: list[Node] = []
    remaining = np.ones(len(positive), dtype=np.bool_)
    for number in chosen.rules:
        truth = pool.truth[number]
        gain = _gain(truth[remaining], positive[remaining], weights[remaining])
        nodes.append(Split(rules[number].condition, len(nodes) + 1, len(nodes) + 2, gain))
        nodes.append(Value((held,), int(np.count_nonzero(remaining & truth))))
        remaining &= ~truth
    nodes.append(Value((_log_odds(~inside, positive, weights),), int(np.count_nonzero(remaining))))
    return SceneTree(tuple(nodes))


def _gain(truth: NDArray[np.bool_], positive: NDArray[np.bool_], weights: NDArray[np.float64]) -> float:
    """Return by how much a rule raises the log likelihood of the scenes that no earlier rule decided."""

    def likelihood(chosen: NDArray[np.bool_]) -> float:
        sums = np.bincount(positive[chosen].astype(np.int64), weights[chosen], 2)
        return float(xlogy(sums, sums).sum() - xlogy(sums.sum(), sums.sum()))

    everything = np.ones(len(truth), dtype=np.bool_)
    return max(likelihood(truth) + likelihood(~truth) - likelihood(everything), 0.0)


def _log_odds(chosen: NDArray[np.bool_], positive: NDArray[np.bool_], weights: NDArray[np.float64]) -> float:
    """Return the log-odds of the smoothed share of positive scenes among the chosen ones."""
    return float(logit(((weights * positive)[chosen].sum() + 0.5) / (weights[chosen].sum() + 1.0)))
