"""The policy in the folder of a run, whichever learner it is of."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TypeAlias

from relforest.rl.fitted.policy_json import KEY, learned_value
from relforest.rl.fitted.value import QValue
from relforest.rl.policy_json import policy_of
from relforest.rl.value import ValueFunction
from relforest.runs.store import read_checkpoint

AnyValue: TypeAlias = ValueFunction | QValue


def read_policy(folder: str | os.PathLike[str]) -> AnyValue:
    """Read the policy from a run folder, even while the run goes on; its experience is not needed.

    Raises
    ------
    InputError
        If it is a run of smrf-q that has not learned anything yet.
    ModelFormatError
        If a file is missing or malformed, or the files do not match.
    """
    checkpoint, path = read_checkpoint(folder), Path(folder)
    if KEY not in checkpoint.document:
        return policy_of(checkpoint.document, path)[0]
    return learned_value(checkpoint, path)
