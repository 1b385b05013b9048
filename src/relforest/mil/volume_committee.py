"""A committee of ellipsoidal volumes, for concepts that a single volume cannot describe."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, ClassVar, final

import numpy as np

from relforest.mil.bag_classifier import (
    WeightedBagClassifier,
    bags_like_those_of_fit,
    two_classes_only,
)
from relforest.mil.committee_training import (
    PanelMember,
    Training,
    find_split_volumes,
    train_panels,
)
from relforest.mil.feature_view import FeatureView, principal_view, scaled_view
from relforest.mil.instance_influence import excess, lead
from relforest.mil.left_out import split_bags
from relforest.mil.panel_weights import panel_weights, score_spread
from relforest.mil.placed_volume import (
    Balls,
    PlacedVolume,
    bag_blocks,
    bag_nearness,
    point_nearness,
    typical_squared_distance,
)
from relforest.mil.volume_panels import BALL_RULES, BALL_SHARES, NEAR_BALLS, PANELS, VOLUME_PANELS
from relforest.scenes.bags import Bags
from relforest.support.blas import one_blas_thread
from relforest.support.errors import InputError
from relforest.support.options import at_least, one_of
from relforest.support.parallel import checked_jobs, run_tasks
from relforest.support.progress import report
from relforest.support.rng import RandomState, generator, seed_sequence, stream

if TYPE_CHECKING:
    from numpy.typing import NDArray

_COMPONENTS, _BALLS, _SPLITS, _VOLUMES = range(4)


@final
@dataclass(kw_only=True, eq=False, repr=False)
class VolumeCommitteeClassifier(WeightedBagClassifier):
    """Multiple-instance classifier that weighs the evidence of many ellipsoidal volumes.

    A bag's nearness to a volume is ``2 ** -(D / r) ** 2``, with D the Mahalanobis distance of its witness and
    r the radius: 1 at the centre, one half on the boundary. The score of a bag is an intercept plus the
    weighted nearness to every volume. Volumes come from five panels: ellipsoids aggregated from samples of
    the bags, in random subsets of the features ("parts") or in the principal components ("components"); a few
    ellipsoids aggregated from all bags ("whole"), in all features or, if there are more than `n_components`,
    in the principal components; and balls around training instances, which measure the nearness of the
    nearest instance ("near balls") or the mean nearness of all instances ("ball shares"). Half of the
    ellipsoids of the first two panels enclose negative bags. Cross-validation over the training bags
    determines the weight of each panel: volumes and weights are learned from some bags, and the panels
    compared on the others.

    Parameters
    ----------
    n_splits : int, default 5
        Number of cross-validation splits, at most the number of bags in the smaller class. With 1, no bags
        are left out and all panels have equal weight.
    n_volumes : int, default 30
        Number of volumes of the "parts" panel in each split; "components" has half as many, "whole" a
        seventh.
    part_size : int, default 8
        Number of features used by a volume of the "parts" panel.
    n_components : int, default 20
        Largest number of principal components.
    n_balls : int, default 1000
        Largest number of balls.
    panels : sequence of str, default all five
        The panels to use.
    probability : bool, default False
        Without effect: scores are log odds, so there are always probabilities.
    random_state : int, Generator, RandomState, SeedSequence or None, default None
        Seed of all sampling; an integer makes `fit` reproducible.
    n_jobs : int, default 1
        Number of splits trained in parallel; -1 for all cores. Does not affect the result.
    verbose : bool, default False
        Whether `fit` prints to standard error what it is doing, at most one line a second.

    Attributes
    ----------
    volumes_ : tuple of PlacedVolume
        The aggregated volumes, sorted by descending absolute weight.
    balls_ : Balls
        The balls and their weights.
    intercept_ : float
        Score of a bag far from all volumes.
    panel_weights_ : dict of str to float
        Weight of each panel's score, scaled to unit standard deviation.
    classes_, n_features_in_, feature_names_in_
        As in `CovAggClassifier`.

    Notes
    -----
    Both classes have equal weight in every fit, so the threshold of 0 suits balanced classes, whatever their
    frequencies in training. So do the probabilities: scores are log odds, fitted to the bags left out by the
    splits. Features are scaled to unit variance, so their units do not matter; constant features are ignored.
    If a class has a single bag, no bags are left out.

    With `sample_weight`, bags of more weight are sampled more often for the panels "parts" and "components",
    and count more in the weights of volumes, balls and panels.

    References
    ----------
    Palmer (2015), Algorithm 3.1, for the aggregation; Chen, Bi and Wang (2006), "MILES: multiple-instance
    learning via embedded instance selection", for bags described by their nearness to instances; Gaertner et
    al. (2002), "Multi-instance kernels", for mean nearness; Breiman (1996), "Stacked regressions", for
    weights from bags left out.

    Examples
    --------
    >>> import numpy as np
    >>> from relforest.mil import VolumeCommitteeClassifier
    >>> rng = np.random.default_rng(0)
    >>> bags = rng.normal(size=(40, 3, 2))
    >>> bags[:20, 0] = rng.choice([-4, 4], size=(20, 1)) + rng.normal(0, 0.3, size=(20, 2))
    >>> model = VolumeCommitteeClassifier(random_state=0).fit(bags, [1] * 20 + [0] * 20)
    >>> model.predict([[[4, 4], [0, 0]], [[-4, -4], [0, 0]], [[0, 0], [1, 0]]])
    array([1, 1, 0])
    """

    _scores_are_log_odds: ClassVar[bool] = True

    n_splits: int = 5
    n_volumes: int = 30
    part_size: int = 8
    n_components: int = 20
    n_balls: int = 1000
    panels: Sequence[str] = PANELS
    random_state: RandomState = None
    n_jobs: int = 1
    verbose: bool = False

    def _fit(self, bags: Bags, positive: NDArray[np.bool_], weights: NDArray[np.float64]) -> None:
        panels, sizes = self._checked_panels(), self._checked_sizes()
        checked_jobs(self.n_jobs)
        seed = seed_sequence(self.random_state)
        view = scaled_view(bags.points)
        coordinates = view.coordinates(bags.points)
        rng = generator(stream(seed, _BALLS))
        rows = np.sort(rng.choice(len(coordinates), min(sizes["n_balls"], len(coordinates)), replace=False))
        balls = _unweighted_balls(view, coordinates[rows])
        ball_features = {}
        if any(name in BALL_RULES for name in panels):
            near, shares = balls.bag_nearness(bags.points, bags.starts)
            ball_features = {NEAR_BALLS: near, BALL_SHARES: shares}
        training = Training(
            shown=self._shown(bags.points, view, panels, seed),
            points=bags.points,
            starts=bags.starts,
            positive=positive,
            weights=weights,
            ball_bags=np.searchsorted(bags.starts, rows, side="right") - 1,
            ball_features=ball_features,
            n_volumes=sizes["n_volumes"],
            part_size=sizes["part_size"],
        )
        splits = split_bags(positive, sizes["n_splits"], generator(stream(seed, _SPLITS)))
        tasks = [
            (training, panels, train, stream(seed, _VOLUMES, number))
            for number, (train, _) in enumerate(splits)
        ]
        found = run_tasks(find_split_volumes, tasks, n_jobs=self.n_jobs, prefer="threads")
        members = []
        for number, split in enumerate(splits):
            report("weighing volumes: splits", number, len(splits))
            members.append(train_panels(training, panels, found[number], *split))
        self._combine(panels, members, [test for _, test in splits], training, balls)

    def _checked_panels(self) -> tuple[str, ...]:
        names = [self.panels] if isinstance(self.panels, str) else list(self.panels)
        panels = tuple(one_of("each of panels", name, PANELS) for name in names)
        if not panels or len(set(panels)) < len(panels):
            raise InputError(f"panels must name at least one panel, and none twice, got {self.panels!r}")
        return panels

    def _checked_sizes(self) -> dict[str, int]:
        names = ("n_splits", "n_volumes", "part_size", "n_components", "n_balls")
        return {name: at_least(name, getattr(self, name), 1) for name in names}

    def _shown(
        self,
        points: NDArray[np.float64],
        view: FeatureView,
        panels: tuple[str, ...],
        seed: np.random.SeedSequence,
    ) -> dict[str, tuple[FeatureView, NDArray[np.float64]]]:
        """Return the view of each volume panel, and the points in that view."""
        coordinates = view.coordinates(points)
        shown = {name: (view, coordinates) for name in panels if name in VOLUME_PANELS}
        is_wide = view.dim > self.n_components
        spaces = ("components", "whole") if is_wide else ("components",)
        rotated = [name for name in shown if VOLUME_PANELS[name].space in spaces]
        if rotated:
            rng = generator(stream(seed, _COMPONENTS))
            turned = principal_view(view, coordinates, self.n_components, rng)
            shown |= dict.fromkeys(rotated, (turned, turned.coordinates(points)))
        return shown

    def _combine(
        self,
        panels: tuple[str, ...],
        members: list[list[PanelMember]],
        tested: list[NDArray[np.int64]],
        training: Training,
        balls: Balls,
    ) -> None:
        scores = np.empty((len(training.positive), len(panels)))
        for split, bags in zip(members, tested, strict=True):
            scores[bags] = np.column_stack([member.scores for member in split])
        spread = score_spread(scores)
        if len(members) > 1:
            weights, intercept = panel_weights(scores, training.positive, training.weights)
        else:
            weights, intercept = 1.0 / (len(panels) * spread), 0.0
        near = {name: np.zeros(len(balls.centres)) for name in BALL_RULES}
        volumes: list[PlacedVolume] = []
        for split in members:
            for name, weight, member in zip(panels, weights / len(members), split, strict=True):
                intercept += weight * member.rule.intercept
                if name in near:
                    near[name][member.balls] += weight * member.rule.coefficients
                else:
                    worth = weight * member.rule.coefficients
                    volumes += [
                        replace(volume, weight=float(value))
                        for volume, value in zip(member.volumes, worth, strict=True)
                    ]
        self.volumes_ = tuple(sorted(volumes, key=lambda volume: -abs(volume.weight)))
        self.balls_ = replace(
            balls, near_weights=near[NEAR_BALLS], share_weights=near[BALL_SHARES]
        ).without_idle()
        self.intercept_ = float(intercept)
        self.panel_weights_ = dict(zip(panels, (weights * spread).tolist(), strict=True))

    def _bag_scores(self, bags: Bags) -> NDArray[np.float64]:
        scores = np.full(len(bags), self.intercept_)
        if self.volumes_:
            weights = np.array([volume.weight for volume in self.volumes_])
            scores += bag_nearness(self.volumes_, bags.points, bags.starts) @ weights
        if len(self.balls_.centres):
            nearest, shares = self.balls_.bag_nearness(bags.points, bags.starts)
            scores += nearest @ self.balls_.near_weights + shares @ self.balls_.share_weights
        return scores

    def influences(self, bags: object) -> list[NDArray[np.float64]]:
        """Contribution of each instance to the score of its bag; one array per bag, in the bag's order.

        This is the score minus the score without the instance; for the only instance of a bag, the score
        minus the intercept. It raises the errors of `decision_function`, and an `InputError` if there are
        more than two classes.
        """
        two_classes_only(self)
        data = bags_like_those_of_fit(self, bags)
        with one_blas_thread():
            return np.split(self._influences(data), data.starts[1:-1])

    def _influences(self, data: Bags) -> NDArray[np.float64]:
        influence = np.zeros(len(data.points))
        for volume, near in zip(self.volumes_, point_nearness(self.volumes_, data.points), strict=True):
            influence += volume.weight * lead(near[:, None], data.starts)[:, 0]
        for first, last in bag_blocks(data.starts) if len(self.balls_.centres) else []:
            rows = slice(data.starts[first], data.starts[last])
            within = data.starts[first : last + 1] - data.starts[first]
            near, share = self.balls_.point_nearness(self.balls_.view.coordinates(data.points[rows]))
            influence[rows] += lead(near, within) @ self.balls_.near_weights
            influence[rows] += excess(share @ self.balls_.share_weights, within)
        return influence


def _unweighted_balls(view: FeatureView, centres: NDArray[np.float64]) -> Balls:
    # exp(-d^2 / s) = 2 ** -(d / r)^2 for r^2 = s ln 2.
    squared = np.log(2.0) * typical_squared_distance(centres)
    none = np.zeros(len(centres))
    return Balls(view, centres, float(np.sqrt(squared)), float(np.sqrt(squared / 2.0)), none, none)
