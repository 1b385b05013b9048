"""Trees that predict the same class for every scene."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from relforest.cli.model_file import Model


def one_sided_hint(model: Model) -> str:
    """Return advice if all leaves are on the same side of 1/2, otherwise an empty text."""
    says_yes = model.tree.leaf_probabilities >= 0.5
    if not model.label or says_yes.any() != says_yes.all():
        return ""
    negative, positive = model.classes
    answer, bound = (positive, "1/2 or more") if says_yes.all() else (negative, "below 1/2")
    return (
        f"all leaf probabilities are {bound}, so the tree predicts {model.label} = {answer} for every scene: "
        f"try --positive {negative}, which looks for what exists in scenes of {negative}"
    )
