"""How the best question at a leaf is found: the exhaustive search of the source, or a screened one."""

from __future__ import annotations

from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import TYPE_CHECKING, Final, NamedTuple, final

import numpy as np

from relforest.support.progress import report
from relforest.trees.bags import bags_of
from relforest.trees.candidates import Arrivals, Candidate, OpenLeaf, PreparedQuestion
from relforest.trees.significance import added_parameters, likelihood_ratio_p, sidak
from relforest.volumes import CovAggSettings, aggregate
from relforest.volumes.covagg import best_score

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from relforest.mappings.mapping import Space
    from relforest.trees.bags import Bags
    from relforest.trees.criterion import Target
    from relforest.trees.expansions import Expansion
    from relforest.trees.sequences import Sequences
    from relforest.trees.settings import SearchName, TreeSettings


# Beyond so many sequences for each of `max_points`, answering a question once would take minutes.
_LARGEST_RATIO: Final = 100
# With more points a try takes so long that the screened search tries a question once.
_MANY_POINTS: Final = 8_000
# A leaf is given up where every promising question, tried once, has a p-value so many times as large as an
# accepted one may have: of 89 such leaves in keepaway and football, more tries saved none.
_HOPELESS: Final = 100


@final
@dataclass(frozen=True, slots=True, eq=False)
class Exhaustive:
    """Aggregates every question at a leaf on all scenes, several times.

    References
    ----------
    Palmer (2015), Algorithm 4.1.
    """

    questions: list[PreparedQuestion]
    settings: TreeSettings
    n_left_out: int  # expansions that are not tried, having too many instantiation sequences
    n_sampled: int = 0  # expansions of which only a sample of the sequences is searched: none

    @classmethod
    def at(cls, arrivals: Arrivals, settings: TreeSettings, rng: np.random.Generator) -> Exhaustive:  # noqa: ARG003
        """Map the points of all questions."""
        questions: list[PreparedQuestion] = []
        n_left_out = 0
        most = max((expansion.n_new for expansion in arrivals.expansions()), default=0)
        sequences = arrivals.extended(most, settings.max_points)
        for expansion in arrivals.expansions():
            report("expansions prepared", len(questions))
            if expansion.n_new >= len(sequences):
                n_left_out += 1
                continue
            question = PreparedQuestion(arrivals.scenes, expansion, sequences[expansion.n_new])
            if len(question.bags.points):
                questions.append(question)
        return cls(questions, settings, n_left_out)

    def best(self, target: Target, at: OpenLeaf, rng: np.random.Generator) -> Candidate | None:
        """Try each question so many times."""
        best: Candidate | None = None
        for number, question in enumerate(self.questions):
            report("expansions tried", number, len(self.questions))
            for _ in range(self.settings.attempts):
                best = _better(best, _tried(question, target, at, self.settings.covagg, rng))
        return None if best is None else best.among(len(self.questions) * self.settings.attempts)


class Round(NamedTuple):
    """One round of a screening."""

    n_scenes: int  # drawn
    max_points: int  # most instantiation sequences of the scenes drawn that an expansion looks at
    n_kept: int  # questions that stay
    covagg: CovAggSettings  # on the scenes drawn; shape and learner are those of the tree


ROUNDS: Final = (
    Round(120, 3_000, 16, CovAggSettings(window=4, restarts=2, sampled=2)),
    Round(240, 12_000, 4, CovAggSettings(window=4, restarts=4, sampled=2)),
)


@final
@dataclass(frozen=True, slots=True, eq=False)
class Screened:
    """Aggregates every question on a few scenes with little effort, and the few best of them on all scenes.

    In each round the scenes are drawn anew from those that the leaf decides, as many of each class as
    possible: what other leaves decide, they explain already, and to find it again would be no gain. A
    question whose scenes all hold the same points cannot separate anything, and is skipped; so is one that
    has the same points as another, be it only that new variables change places. What counts is the p-value of
    the gain in log likelihood that the volume has on the scenes drawn, extrapolated to all of them.

    The questions that stay are aggregated on all scenes that arrive: once, and unless none of them comes near
    the level, `attempts` times each, and the best of them `attempts` - 1 times more; those with very many
    points just once. The correction for multiple comparisons counts every question `attempts` times as in the
    exhaustive search.
    """

    arrivals: Arrivals
    expansions: list[Expansion]
    full: list[Sequences]  # the sequences on which the best questions are tried, by number of new variables
    settings: TreeSettings
    n_left_out: int
    n_sampled: int
    """Both as of `Exhaustive`."""
    rounds: tuple[Round, ...] = ROUNDS
    """The first ones are left out where there are no more questions than they would keep. The last should see
    all pairs of objects of ordinary scenes: a sample of them misses what few pairs show, such as that two
    objects are far apart."""

    @classmethod
    def at(cls, arrivals: Arrivals, settings: TreeSettings, rng: np.random.Generator) -> Screened:
        """Count the instantiation sequences, and draw them for the expansions that have too many."""
        possible = list(arrivals.expansions())
        sizes = {n_new: arrivals.size(n_new) for n_new in {each.n_new for each in possible}}
        kept = [each for each in possible if sizes[each.n_new] <= _LARGEST_RATIO * settings.max_points]
        n_left_out = len(possible) - len(kept)
        n_sampled = sum(sizes[expansion.n_new] > settings.max_points for expansion in kept)
        most = max((expansion.n_new for expansion in kept), default=-1)
        full = arrivals.drawn(most, settings.max_points, rng)
        return cls(arrivals, kept, full, settings, n_left_out, n_sampled)

    def best(self, target: Target, at: OpenLeaf, rng: np.random.Generator) -> Candidate | None:
        """Screen all questions and try the best."""
        promising, n_questions = self.screened(target, at, rng)
        questions = [
            PreparedQuestion(self.arrivals.scenes, expansion, self.full[expansion.n_new])
            for expansion in promising
        ]
        best: Candidate | None = None
        for question in questions:
            best = _better(best, _tried(question, target, at, self.settings.covagg, rng))
        if best is None:
            return None
        n_tried = n_questions * self.settings.attempts
        if best.p_value <= _HOPELESS * sidak(self.settings.alpha, n_tried):
            for question in questions:
                best = self._retried(best, question, target, at, rng)
            best = self._retried(best, best.question, target, at, rng)
        if best.question.sequences.ratio > 1.0:
            shape = self.settings.covagg.shape
            best = at.judged(best.question, best.volume, target, exactly=True, shape=shape)
        return best.among(n_tried)

    def _retried(
        self,
        best: Candidate,
        question: PreparedQuestion,
        target: Target,
        at: OpenLeaf,
        rng: np.random.Generator,
    ) -> Candidate:
        """Return the better of a candidate and what other tries of a question bring."""
        is_large = len(question.bags.points) > _MANY_POINTS
        for _ in range(0 if is_large else self.settings.attempts - 1):
            best = _better(best, _tried(question, target, at, self.settings.covagg, rng)) or best
        return best

    def screened(self, target: Target, at: OpenLeaf, rng: np.random.Generator) -> tuple[list[Expansion], int]:
        """Return the most promising expansions, and how many have points."""
        arriving = self.arrivals.sequences.scenes
        scenes = arriving[at.assignment.winner[arriving] == at.leaf]
        promising, n_questions = self.expansions, None
        *first, last = self.rounds
        for plan in (*(plan for plan in first if len(promising) > plan.n_kept), last):
            promising, n = self._ranked(promising, scenes, plan, target, rng)
            n_questions = n if n_questions is None else n_questions
        return promising, n_questions or 0

    def _ranked(
        self,
        expansions: list[Expansion],
        scenes: NDArray[np.int64],
        plan: Round,
        target: Target,
        rng: np.random.Generator,
    ) -> tuple[list[Expansion], int]:
        """Return the best of some expansions, the most promising first, and how many have points."""
        arrivals, wanted = self.arrivals, self.settings.covagg
        settings = replace(plan.covagg, shape=wanted.shape, learner=wanted.learner)
        drawn = stratified(scenes, target.strata, plan.n_scenes, rng)
        share = len(scenes) / max(len(drawn), 1)
        most = max((expansion.n_new for expansion in expansions), default=-1)
        few = arrivals.only(drawn).drawn(most, plan.max_points, rng)
        asked: dict[tuple[int, tuple[int, ...]], Sequences] = {}
        has_points: dict[Expansion, bool] = {}
        first_new = max(arrivals.sequences.depth, arrivals.places.shape[1])
        seen: set[int] = set()
        ranked: list[tuple[float, float, int]] = []
        n_questions = 0
        for number, expansion in enumerate(expansions):
            report("expansions tried", number, len(expansions))
            mapping, pattern = expansion.mapping, expansion.pattern(first_new)
            if pattern in has_points:
                n_questions += has_points[pattern]
                continue
            key = (expansion.n_new, expansion.variables)
            if key not in asked:
                asked[key] = few[expansion.n_new].distinct(expansion.variables)
            bags = bags_of(arrivals.scenes, asked[key], mapping)
            has_points[pattern] = len(bags.points) > 0
            n_questions += has_points[pattern]
            parts = (bags.points, bags.starts, bags.scenes)
            points = hash((mapping.space, *(part.tobytes() for part in parts)))
            if points in seen or not bags.differ:
                continue
            seen.add(points)
            gain = _gain(target, bags, mapping.space, settings, rng)
            if gain == -np.inf:
                continue
            n_parameters = added_parameters(
                mapping, has_errors=False, n_values=target.n_values, shape=wanted.shape
            )
            # Half a unit per parameter comes from fitting noise (half the mean of chi-square), and does not
            # grow with the number of scenes.
            gain = share * gain - (share - 1.0) * n_parameters / 2.0
            ranked.append((likelihood_ratio_p(gain, n_parameters), -gain, number))
        return [expansions[number] for *_, number in sorted(ranked)[: plan.n_kept]], n_questions


LeafSearch = Screened | Exhaustive
"""A search at one leaf, for any target: a permutation test repeats it."""

SEARCHES: Final[MappingProxyType[SearchName, type[LeafSearch]]] = MappingProxyType(
    {"screened": Screened, "exhaustive": Exhaustive}
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


def _gain(
    target: Target, bags: Bags, space: Space, settings: CovAggSettings, rng: np.random.Generator
) -> float:
    """Return what the best volume for any view of the target adds to the likelihood of the bags' scenes."""
    best = -np.inf
    for view in target.views(bags.scenes):
        score = best_score(
            bags.points,
            bags.starts,
            view.labels,
            rng=rng,
            space=space,
            objective=view.objective,
            evidence=view.evidence,
            settings=settings,
        )
        if score > -np.inf:
            best = max(best, target.gain(view, score, bags.scenes))
    return best


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
