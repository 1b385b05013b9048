"""The options of SMRF-RPI, checked once, and their JSON form."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, fields, is_dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final, Literal, TypeVar, final, get_type_hints

from relforest.support.errors import InputError, ModelFormatError
from relforest.support.options import at_least, in_range, one_of
from relforest.trees.settings import TreeSettings

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

Options = TypeVar("Options", bound="DataclassInstance")

FeatureMode = Literal["densities+bits", "bits", "probability"]
# Options of covariant aggregation that older runs do not name.
_NEWER: Final = MappingProxyType({"shape": "full", "learner": "covagg"})
FEATURE_MODES: Final[tuple[FeatureMode, ...]] = ("densities+bits", "bits", "probability")


@final
@dataclass(frozen=True, slots=True)
class LSPISettings:
    """Options of policy iteration.

    Parameters
    ----------
    epsilon : float
        Stop when the weights change by less than this (Euclidean norm).
    max_iterations : int
        Most policies that are evaluated.
    max_condition : float
        Largest condition number of the matrix A of LSTDQ.

    Raises
    ------
    InputError
        If an option is out of its range.
    """

    epsilon: float = 1e-6
    max_iterations: int = 50
    max_condition: float = 1e5

    def __post_init__(self) -> None:
        in_range("epsilon of LSPI", self.epsilon, 0.0, math.inf, open_low=True, open_high=True)
        at_least("max_iterations of LSPI", self.max_iterations, 1)
        in_range("max_condition of LSPI", self.max_condition, 1.0, math.inf, open_low=True, open_high=True)


@final
@dataclass(frozen=True, slots=True)
class RPISettings:
    """Options of SMRF-RPI; the defaults are those of Palmer (2015), section 7.2.

    Parameters
    ----------
    features : {"densities+bits", "bits", "probability"}
        The features that a tree contributes (section 6.4).
    epsilon : float
        Probability of a uniformly random action in training after the first iteration, 0 to 1. The source
        does not give a value.
    trees_per_label : int
        Candidate trees per action type and round on the labels, and the same number on the negated labels.
    max_scenes : int
        Largest number of scenes used to learn a candidate tree.
    max_samples : int
        Largest number of transitions for LSPI.
    alpha : float
        Significance level of the test that a tree must pass, divided by the number of candidates
        (Bonferroni), above 0 and below 1.
    max_rounds : int
        Largest number of rounds of representation and policy learning per iteration; unlimited in the source.
    bootstrap_on_truncation : bool
        Whether to use the value of a state in which a time limit cut the episode, so that the limit is part
        of the experiment, not of the task. The source does not say.
    wrapper : bool
        Whether candidates are tested by learning a policy with them. False keeps, in every round, the tree
        learned with the highest significance, to show the benefit of the test (section 7.3.2).
    lspi : LSPISettings
    tree : TreeSettings
        How trees are learned; by default with the exhaustive search, as published.

    Raises
    ------
    InputError
        If an option is out of its range.
    """

    features: FeatureMode = "densities+bits"
    epsilon: float = 0.1
    trees_per_label: int = 2
    max_scenes: int = 500
    max_samples: int = 100_000
    alpha: float = 0.05
    max_rounds: int = 20
    bootstrap_on_truncation: bool = True
    wrapper: bool = True
    lspi: LSPISettings = field(default_factory=LSPISettings)
    tree: TreeSettings = field(default_factory=lambda: TreeSettings(search="exhaustive"))

    def __post_init__(self) -> None:
        one_of("features", self.features, FEATURE_MODES)
        in_range("epsilon", self.epsilon, 0.0, 1.0)
        at_least("trees_per_label", self.trees_per_label, 1)
        at_least("max_scenes", self.max_scenes, 2)
        at_least("max_samples", self.max_samples, 1)
        in_range("alpha", self.alpha, 0.0, 1.0, open_low=True, open_high=True)
        at_least("max_rounds", self.max_rounds, 1)
        for name in ("bootstrap_on_truncation", "wrapper"):
            if not isinstance(getattr(self, name), bool):
                raise InputError(f"{name} must be True or False, got {getattr(self, name)!r}")
        for name, cls in (("lspi", LSPISettings), ("tree", TreeSettings)):
            if not isinstance(getattr(self, name), cls):
                raise InputError(f"{name} must be {cls.__name__}(...), got {getattr(self, name)!r}")

    @property
    def n_candidates(self) -> int:
        """Candidate trees attempted per action type and round."""
        return 2 * self.trees_per_label

    def to_dict(self) -> dict[str, Any]:
        """Return the options as plain JSON values."""
        document = asdict(self)
        # Only where they differ from the default, so that older runs can be resumed.
        covagg = document["tree"]["covagg"]
        for name, value in _NEWER.items():
            if covagg[name] == value:
                del covagg[name]
        return document

    @classmethod
    def from_dict(cls, document: object) -> RPISettings:
        """Read what `to_dict` returned.

        Raises
        ------
        ModelFormatError
            If an option is missing, unknown or out of its range.
        """
        if isinstance(document, Mapping) and isinstance(document.get("tree"), Mapping):
            # Runs from before there were two searches used the exhaustive one.
            tree = {"search": "exhaustive", **document["tree"]}
            if isinstance(tree.get("covagg"), Mapping):
                tree["covagg"] = {**_NEWER, **tree["covagg"]}
            document = {**document, "tree": tree}
        return read_options(cls, document)


def read_options(cls: type[Options], document: object) -> Options:
    """Build a dataclass of options, and those nested in it, from plain values."""
    names = {entry.name for entry in fields(cls)}
    if not isinstance(document, Mapping) or set(document) != names:
        raise ModelFormatError(
            f"malformed {cls.__name__}: expected {', '.join(sorted(names))}, got {document!r:.200}"
        )
    hints = get_type_hints(cls)
    values = {
        name: read_options(hints[name], value) if is_dataclass(hints[name]) else value
        for name, value in document.items()
    }
    try:
        return cls(**values)
    except (InputError, TypeError) as error:
        raise ModelFormatError(f"malformed {cls.__name__}: {error}") from error
