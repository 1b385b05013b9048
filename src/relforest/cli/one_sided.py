"""Trees that give the same answer to every scene."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from relforest.cli.model_file import Model


def one_sided_hint(model: Model) -> str:
    """Return what to try if all leaves are on one side of 1/2; an empty text if they are not."""
    says_yes = model.tree.leaf_probabilities >= 0.5
    if not model.label or says_yes.any() != says_yes.all():
        return ""
    negative, positive = model.classes
    answer, bound = (positive, "1/2 or more") if says_yes.all() else (negative, "below 1/2")
    return (
        f"all leaf probabilities are {bound}, so the tree predicts {model.label} = {answer} for every scene: "
        f"--positive {negative} asks what exists in the scenes of {negative} instead"
    )
