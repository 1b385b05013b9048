"""The options of ``smrf-q``, checked once, and their JSON form."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any, Final, Literal, TypeAlias, final

from relforest.rl.settings import read_options
from relforest.support.errors import InputError
from relforest.support.options import at_least, in_range, one_of

Q_DISCOUNT: Final = 0.99
"""The discount of tasks that are learned with ``smrf-q``: in keepaway, .9 looks ahead for one second."""


What: TypeAlias = Literal["policy", "questions"]
_WHAT: Final[tuple[What, ...]] = ("policy", "questions")


@final
@dataclass(frozen=True, slots=True)
class Source:
    """Another run of ``smrf-q``, in a world with the same attributes.

    Parameters
    ----------
    folder : path
        Its folder, which is read once, when the new run begins.
    what : {"policy", "questions"}
        Begin with its policy, and learn how values differ from its values: the action types must be the same.
        Or only ask its questions first, those of the action types in common, because the task is another one.
    """

    folder: Path
    what: What = "policy"

    def __post_init__(self) -> None:
        one_of("what", self.what, _WHAT)

    def to_dict(self) -> dict[str, str]:
        """Return it as plain JSON values."""
        return {"from": str(self.folder), "what": self.what}


@final
@dataclass(frozen=True, slots=True)
class CurveSettings:
    """How a sum of curves is learned, where the number of actions is not limited.

    Parameters
    ----------
    rounds : int
        Rounds of new questions for every hundred new episodes, at least one each time of learning.
    candidates : int
        Random questions tried for an action type in a round.
    kept : int
        Most of them that are kept.
    max_questions : int
        Most questions of an action type.
    max_scenes : int
        Scenes on which questions are tried.
    min_scenes : int
        Least number of scenes on either side of the best cut of a question.
    ridge : float
        Penalty on the standardised weights, above 0.
    prior : float
        Penalty on what differs from the weights that a run begins with, see `Source`; above 0. They count
        about as much as so many transitions.
    trace : float
        Lambda of the returns that are learned from, 0 to 1.
    sweeps : int
        Most times that returns and weights are computed in turn.
    """

    rounds: int = 4
    candidates: int = 60
    kept: int = 2
    max_questions: int = 40
    max_scenes: int = 1500
    min_scenes: int = 20
    ridge: float = 30.0
    prior: float = 3000.0
    trace: float = 0.9
    sweeps: int = 15

    def __post_init__(self) -> None:
        for name in ("rounds", "candidates", "kept", "max_questions", "min_scenes", "sweeps"):
            at_least(name, getattr(self, name), 1)
        at_least("max_scenes", self.max_scenes, 2)
        for name in ("ridge", "prior"):
            in_range(name, getattr(self, name), 0.0, 1e9, open_low=True)
        in_range("trace", self.trace, 0.0, 1.0)


@final
@dataclass(frozen=True, slots=True)
class ForestSettings:
    """How forests are learned.

    Parameters
    ----------
    counts : int
        Where the number of actions is limited, conditions of an action type whose objects are counted: half
        of them those that mattered most before, the others new.
    tried : int
        Random conditions among which the new ones are chosen, but no more than there are transitions.
    max_scenes : int
        Scenes on which they are tried.
    trees : int
        Trees for each action type and, where the number of actions is limited, each number that remains.
    min_leaf : int
        Least number of transitions in a leaf.
    share : float
        Share of the features that are tried at a node, above 0 and at most 1.
    """

    counts: int = 100
    tried: int = 1200
    max_scenes: int = 3000
    trees: int = 30
    min_leaf: int = 4
    share: float = 1 / 3

    def __post_init__(self) -> None:
        for name in ("counts", "tried"):
            at_least(name, getattr(self, name), 0)
        for name in ("max_scenes", "trees", "min_leaf"):
            at_least(name, getattr(self, name), 1)
        in_range("share", self.share, 0.0, 1.0, open_low=True)


@final
@dataclass(frozen=True, slots=True)
class QSettings:
    """Options of ``smrf-q``; the same for every task.

    Parameters
    ----------
    epsilon : float
        Probability of a uniformly random action in training after the first iteration, 0 to 1.
    portion : int
        It learns again after at least so many training episodes, also within an iteration.
    growth : float
        It learns again when there is this share more of them, 0 to 1.
    max_samples : int
        Most transitions that are learned from: those of the latest batches.
    max_values : int
        An attribute with at most so many different values is a category.
    curves : CurveSettings
    forests : ForestSettings

    Raises
    ------
    InputError
        If an option is out of its range.
    """

    epsilon: float = 0.05
    portion: int = 25
    growth: float = 0.25
    max_samples: int = 100_000
    max_values: int = 6
    curves: CurveSettings = field(default_factory=CurveSettings)
    forests: ForestSettings = field(default_factory=ForestSettings)

    def __post_init__(self) -> None:
        in_range("epsilon", self.epsilon, 0.0, 1.0)
        at_least("portion", self.portion, 1)
        in_range("growth", self.growth, 0.0, 1.0)
        at_least("max_samples", self.max_samples, 1)
        at_least("max_values", self.max_values, 0)
        for name, cls in (("curves", CurveSettings), ("forests", ForestSettings)):
            if not isinstance(getattr(self, name), cls):
                raise InputError(f"{name} must be {cls.__name__}(...), got {getattr(self, name)!r}")

    def to_dict(self) -> dict[str, Any]:
        """Return the options as plain JSON values."""
        return asdict(self)

    @classmethod
    def from_dict(cls, document: object) -> QSettings:
        """Read what `to_dict` returned.

        Raises
        ------
        ModelFormatError
            If an option is missing, unknown or out of its range.
        """
        return read_options(cls, document)
