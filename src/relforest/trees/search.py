"""How the best question at a leaf is found: the exhaustive search of the source, or a screened one."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import TYPE_CHECKING, Final, Protocol, final

import numpy as np

from relforest.support.progress import report
from relforest.trees.bags import bags_of
from relforest.trees.candidates import Arrivals, Candidate, OpenLeaf, PreparedQuestion
from relforest.trees.settings import SearchName
from relforest.trees.significance import added_parameters, likelihood_ratio_p
from relforest.volumes import CovAggSettings, aggregate
from relforest.volumes.covagg import best_score

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from relforest.mappings.mapping import Space
    from relforest.trees.bags import Bags
    from relforest.trees.criterion import Target, View
    from relforest.trees.expansions import Expansion
    from relforest.trees.sequences import Sequences


# Beyond so many sequences for each of `max_points`, answering a question once would take minutes.
_LARGEST_RATIO: Final = 100


class SearchSettings(Protocol):
    """The part of `TreeSettings` that the search needs."""

    @property
    def attempts(self) -> int:
        """Tries per expansion."""
        ...

    @property
    def max_points(self) -> int:
        """Most instantiation sequences of an expansion that are looked at."""
        ...

    @property
    def covagg(self) -> CovAggSettings:
        """Parameters of covariant aggregation."""
        ...


class LeafSearch(Protocol):
    """A search at one leaf, for any target: a permutation test repeats it."""

    @property
    def n_left_out(self) -> int:
        """Expansions that are not tried."""
        ...

    @property
    def n_sampled(self) -> int:
        """Expansions of which only a sample of the instantiation sequences is searched."""
        ...

    def best(self, target: Target, at: OpenLeaf, rng: np.random.Generator) -> Candidate | None:
        """The most significant volume over all questions; None if no volume separates anything."""
        ...


class Search(Protocol):
    """A way to search."""

    def at(self, arrivals: Arrivals, settings: SearchSettings, rng: np.random.Generator) -> LeafSearch:
        """Prepare the search at a leaf."""
        ...


@final
@dataclass(frozen=True, slots=True)
class Exhaustive:
    """Aggregate every question on all scenes, several times.

    Expansions with too many instantiation sequences are left out.

    References
    ----------
    Palmer (2015), Algorithm 4.1.
    """

    def at(self, arrivals: Arrivals, settings: SearchSettings, rng: np.random.Generator) -> ExhaustiveLeaf:  # noqa: ARG002
        """Map the points of all questions."""
        questions: list[PreparedQuestion] = []
        n_left_out = 0
        for expansion in arrivals.expansions():
            report("expansions prepared", len(questions))
            sequences = arrivals.extended(expansion.n_new, settings.max_points)
            if sequences is None:
                n_left_out += 1
                continue
            question = PreparedQuestion(arrivals.scenes, expansion, sequences)
            if len(question.bags.points):
                questions.append(question)
        return ExhaustiveLeaf(questions, settings, n_left_out)


@final
@dataclass(frozen=True, slots=True, eq=False)
class ExhaustiveLeaf:
    """The questions at a leaf, each with all its points."""

    questions: list[PreparedQuestion]
    settings: SearchSettings
    n_left_out: int
    n_sampled: int = 0

    def best(self, target: Target, at: OpenLeaf, rng: np.random.Generator) -> Candidate | None:
        """Try each question so many times."""
        best: Candidate | None = None
        for number, question in enumerate(self.questions):
            report("expansions tried", number, len(self.questions))
            for _ in range(self.settings.attempts):
                best = _better(best, _tried(question, target, at, self.settings.covagg, rng))
        return None if best is None else best.among(len(self.questions) * self.settings.attempts)


@final
@dataclass(frozen=True, slots=True)
class Screened:
    """Aggregate every question on a few scenes with little effort, and the few best of them on all scenes.

    The scenes are drawn anew for each search from those that arrive at the leaf, as many of each class as
    possible. A question whose scenes all hold the same points cannot separate anything, and is skipped. What
    counts is the p-value of the gain in log likelihood that the volume has on the scenes drawn, extrapolated
    to all that arrive. The correction for multiple comparisons counts every question `attempts` times as in
    the exhaustive search, although only the best are tried so often.

    Parameters
    ----------
    n_scenes : int
        Scenes drawn.
    n_kept : int
        Questions that are then aggregated on all scenes.
    max_points : int
        Most instantiation sequences of the scenes drawn that an expansion looks at.
    covagg : CovAggSettings
        Parameters of covariant aggregation on the scenes drawn; shape and learner are those of the tree.
    """

    n_scenes: int = 120
    n_kept: int = 4
    max_points: int = 3_000
    covagg: CovAggSettings = field(default_factory=lambda: CovAggSettings(window=4, restarts=2, sampled=2))

    def at(self, arrivals: Arrivals, settings: SearchSettings, rng: np.random.Generator) -> LeafSearch:
        """Count the instantiation sequences, and draw them for the expansions that have too many."""
        expansions: list[Expansion] = []
        n_left_out = n_sampled = 0
        sizes: dict[int, float] = {}
        for expansion in arrivals.expansions():
            size = sizes.get(expansion.n_new)
            if size is None:
                size = sizes[expansion.n_new] = arrivals.size(expansion.n_new)
            if size > _LARGEST_RATIO * settings.max_points:
                n_left_out += 1
                continue
            n_sampled += int(size > settings.max_points)
            expansions.append(expansion)
        most = max((expansion.n_new for expansion in expansions), default=-1)
        full = arrivals.drawn(most, settings.max_points, rng)
        return _ScreenedLeaf(self, arrivals, expansions, full, settings, n_left_out, n_sampled)


@final
@dataclass(frozen=True, slots=True, eq=False)
class _ScreenedLeaf:
    plan: Screened
    arrivals: Arrivals
    expansions: list[Expansion]
    full: list[Sequences]
    settings: SearchSettings
    n_left_out: int
    n_sampled: int

    def best(self, target: Target, at: OpenLeaf, rng: np.random.Generator) -> Candidate | None:
        """Screen all questions and try the best."""
        promising, n_questions = self._screened(target, rng)
        best: Candidate | None = None
        for expansion in promising:
            question = PreparedQuestion(self.arrivals.scenes, expansion, self.full[expansion.n_new])
            for _ in range(self.settings.attempts):
                best = _better(best, _tried(question, target, at, self.settings.covagg, rng))
        if best is None:
            return None
        if best.question.sequences.ratio > 1.0:
            shape = self.settings.covagg.shape
            best = at.judged(best.question, best.volume, target, exactly=True, shape=shape)
        return best.among(n_questions * self.settings.attempts)

    def _screened(self, target: Target, rng: np.random.Generator) -> tuple[list[Expansion], int]:
        """Return the most promising expansions, and how many have points."""
        arrivals, plan = self.arrivals, self.plan
        present = np.unique(arrivals.sequences.scene)
        drawn = stratified(present, target.strata, plan.n_scenes, rng)
        share = len(present) / max(len(drawn), 1)
        most = max((expansion.n_new for expansion in self.expansions), default=-1)
        few = arrivals.only(drawn).drawn(most, plan.max_points, rng)
        ranked: list[tuple[float, float, int]] = []
        n_questions = 0
        for number, expansion in enumerate(self.expansions):
            report("expansions tried", number, len(self.expansions))
            mapping = expansion.mapping
            bags = bags_of(arrivals.scenes, few[expansion.n_new].distinct(expansion.variables), mapping)
            n_questions += int(len(bags.points) > 0)
            if not bags.differ:
                continue
            views = target.views(bags.scenes)
            gains = [share * self._gain(target, view, bags, mapping.space, rng) for view in views]
            gain = max(gains, default=-np.inf)
            if gain == -np.inf:
                continue
            n_parameters = added_parameters(
                mapping, has_errors=False, n_values=target.n_values, shape=self.settings.covagg.shape
            )
            ranked.append((likelihood_ratio_p(gain, n_parameters), -gain, number))
        return [self.expansions[number] for *_, number in sorted(ranked)[: plan.n_kept]], n_questions

    def _gain(self, target: Target, view: View, bags: Bags, space: Space, rng: np.random.Generator) -> float:
        """Return what the best volume found with little effort adds to the likelihood of the scenes drawn."""
        wanted = self.settings.covagg
        score = best_score(
            bags.points,
            bags.starts,
            view.labels,
            rng=rng,
            space=space,
            objective=view.objective,
            evidence=view.evidence,
            settings=replace(self.plan.covagg, shape=wanted.shape, learner=wanted.learner),
        )
        return -np.inf if score == -np.inf else target.gain(view, score, bags.scenes)


SEARCHES: Final[MappingProxyType[SearchName, Search]] = MappingProxyType(
    {"screened": Screened(), "exhaustive": Exhaustive()}
)


def stratified(
    scenes: NDArray[np.int64], strata: NDArray[np.int64], n: int, rng: np.random.Generator
) -> NDArray[np.int64]:
    """Draw about n of some scenes, ascending, the same number of each stratum as far as it has so many."""
    if len(scenes) <= n:
        return scenes
    members = [scenes[strata[scenes] == stratum] for stratum in np.unique(strata[scenes])]
    members.sort(key=len)
    parts, left = [], n
    for i, own in enumerate(members):
        size = min(len(own), max(left // (len(members) - i), 1))
        parts.append(rng.choice(own, size, replace=False))
        left -= size
    return np.sort(np.concatenate(parts))


def _tried(
    question: PreparedQuestion,
    target: Target,
    at: OpenLeaf,
    settings: CovAggSettings,
    rng: np.random.Generator,
) -> Candidate | None:
    """Aggregate the question's points once for each view of the target, and return the best volume."""
    bags, best = question.bags, None
    for view in target.views(bags.scenes):
        found = aggregate(
            bags.points,
            bags.starts,
            view.labels,
            rng=rng,
            space=question.expansion.mapping.space,
            objective=view.objective,
            evidence=view.evidence,
            settings=settings,
        )
        if found is not None:
            best = _better(best, at.judged(question, found.volume, target, shape=settings.shape))
    return best


def _better(best: Candidate | None, other: Candidate | None) -> Candidate | None:
    """Return the more significant candidate, the first of equals."""
    if other is None or (best is not None and best.beats(other)):
        return best
    return other
