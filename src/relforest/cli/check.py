"""``relforest check``: whether a model or a policy does what people say it must."""

# Heavy imports wait until the command runs, so that --help answers at once.
# ruff: noqa: PLC0415

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, final

from tyro.conf import Positional, arg

from relforest.support.errors import InputError


@final
@dataclass(frozen=True, slots=True)
class CheckOptions:
    """Check that a learned model or policy does what it must in situations that you write down.

    Each situation of the file has a name, objects, and what to expect: of a model, what relforest predict
    would write; of a policy, which of some actions must be chosen, avoided, or better than another one. A
    line is printed for each, and below those that failed what was found instead, and why. The exit code is 1
    if one has failed, and also after an error.

    For example:
      relforest check runs/keepaway --unit keepaway.toml
      relforest check tree.json --unit passes.toml

    Parameters
    ----------
    model
        Model file written by relforest fit, a tree from a run folder, or the folder of a run of smrf-q or
        smrf-rpi.
    unit
        TOML file of situations.
    """

    model: Annotated[Positional[Path], arg(metavar="MODEL")]
    unit: Annotated[Path, arg(metavar="FILE")]


def check(options: CheckOptions) -> int:
    """Check situations; the exit code is 1 if one has failed, otherwise 0."""
    from relforest.checking import check_model, check_policy, read_situations
    from relforest.experiments.learned_policies import method_of
    from relforest.models import read_model
    from relforest.rl.saved_policy import read_policy

    situations = read_situations(options.unit)
    if options.model.is_dir():
        method = method_of(options.model)
        if method.report is None:
            raise InputError(
                f"{options.model} was learned by {method.title}, which knows no other situations"
            )
        verdicts = check_policy(read_policy(options.model), situations)
    else:
        verdicts = check_model(read_model(options.model), situations)
    for verdict in verdicts:
        print(verdict)
    n_failed = sum(bool(verdict.faults) for verdict in verdicts)
    print(f"{len(verdicts)} situation{'' if len(verdicts) == 1 else 's'}, {n_failed or 'none'} failed")
    return int(n_failed > 0)
