"""Trees to draw, made by hand, and a way to read the text of a picture."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure
from matplotlib.text import Text

from relforest.mappings import Mapping
from relforest.scenes import Attribute, Scenes, Schema
from relforest.trees import Leaf, Question, Tree
from relforest.volumes import Arc, Ellipsoid, Volume

SCHEMA = Schema(
    [Attribute("location", 2), Attribute("orientation"), Attribute("color", 3), Attribute("cost in $")],
    ["passer"],
)
LEAF = Leaf(0.5, 10, 10)
DISC = Ellipsoid(np.array([1.0, 0.0]), np.diag([4.0, 1.0]), 0.5, 5, 0.1)
NEAR = Ellipsoid(np.array([0.0]), np.eye(1), 2.0, 5, 0.1)
BALL = Ellipsoid(np.zeros(3), np.eye(3), 1.0, 5, 0.1)


def question(operation: str, attribute: str, variables: tuple[int, ...], volume: Volume) -> Question:
    return Question(Mapping(operation, SCHEMA[attribute]), variables, volume, 0, 0, 0)


def one_question() -> Tree:
    """A is the passer: is there a B whose offset from A lies in an ellipse? Leaves .9, .2 and (empty) .3."""
    tree = Tree.stub(SCHEMA, LEAF).expanded(0, 2, question("difference", "location", (0, 1), DISC))
    return tree.with_leaves([Leaf(0.9, 1, 9), Leaf(0.2, 8, 2), Leaf(0.3, 0, 0)])


def five_questions() -> Tree:
    """One question of every form: ellipse, arc, distance, interval, ball."""
    tree = one_question()
    tree = tree.expanded(0, 0, question("identity", "orientation", (1,), Arc(1.0, 0.5, 2.0)))
    tree = tree.expanded(3, 0, question("distance", "location", (0, 1), NEAR))
    tree = tree.expanded(3, 1, question("identity", "color", (2,), BALL))
    return tree.expanded(tree.n_leaves - 1, 0, question("identity", "cost in $", (0,), NEAR))


def chain(length: int) -> Tree:
    """Each question stands below the No answer of the one before."""
    tree = Tree.stub(SCHEMA, LEAF)
    for leaf in range(length):
        tree = tree.expanded(leaf, int(leaf == 0), question("identity", "location", (0,), DISC))
    return tree


def scenes_of(*locations: list[list[float]]) -> Scenes:
    """Scenes of objects at the given places, all other attributes 0; the first object is the passer."""
    records = [
        {
            "id": f"scene {number}",
            "objects": [
                {
                    "id": f"{name}{number}",
                    "location": place,
                    "orientation": 0.0,
                    "color": [0.0] * 3,
                    "cost in $": 0.0,
                }
                for name, place in zip("abcdef", places, strict=False)
            ],
            "arguments": {"passer": f"a{number}"},
        }
        for number, places in enumerate(locations)
    ]
    return Scenes.from_dicts(records, SCHEMA)


def texts_of(figure: Figure) -> list[str]:
    """Every visible text of a figure that is not empty."""
    return [text.get_text() for text in figure.findobj(Text) if isinstance(text, Text) and text.get_text()]
