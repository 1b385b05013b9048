"""Learn a tree from a data frame, read it, draw it, and see which objects a prediction rests on.

In the picture, points are places of another player C relative to passer and receiver. The way of a pass that
was cut is marked, with the player who cut it.
"""

from __future__ import annotations

from make_passes import passes

import relforest as rf
from relforest.reports import save_figure, tree_figure

ATTRIBUTES = {"location": ["x", "y"]}


def scenes_and_labels(n_passes: int, seed: int) -> tuple[rf.Scenes, list[bool]]:
    """Return the scenes of a passes table, and for each of them whether the pass was intercepted."""
    table = passes(n_passes, seed)
    scenes = rf.Scenes.from_frame(
        table, scene="pass", object="player", attributes=ATTRIBUTES, arguments=["passer", "receiver"]
    )
    completed = dict(zip(table["pass"].to_pylist(), table["completed"].to_pylist(), strict=True))
    return scenes, [not completed[number] for number in scenes.scene_ids.tolist()]


scenes, intercepted = scenes_and_labels(600, seed=0)
model = rf.SMRFTreeClassifier(alpha=0.001, random_state=0).fit(scenes, intercepted)
print(model.tree_)

unseen, truth = scenes_and_labels(600, seed=1)
score = rf.metrics.peirce_skill_score(truth, model.predict(unseen))
print(f"Peirce skill score on unseen passes: {score:.2f}")
print(model.explain(unseen.take([0]))[0])

cut = unseen.take([truth.index(True)])
save_figure(
    tree_figure(model.tree_, scenes, intercepted, highlight=cut, title="A pass that was cut"), "tree.png"
)
