"""Trees to JSON and back; documents that are malformed or hostile."""

from __future__ import annotations

import copy
import json
import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from relforest.mappings import Mapping
from relforest.scenes import Attribute, Schema
from relforest.support.errors import ModelFormatError
from relforest.support.files import read_json, write_json
from relforest.trees import Instantiation, Leaf, Node, Question, Tree, query, structure
from relforest.trees.bounds import Bounds
from relforest.trees.node_json import node_to_dict
from relforest.trees.tree import FORMAT, VERSION
from relforest.volumes import Arc, Ellipsoid, Slab
from small_trees import ball, leaf, scenes_in

Document = dict[str, Any]

SCHEMA = Schema((Attribute("location", 2), Attribute("orientation")), ("passer",))


def tree() -> Tree:
    """Every type of node, both types of volume, numbers that are no short decimals."""
    near = Question(
        Mapping("distance", SCHEMA["location"]),
        (0, 1),
        Ellipsoid(np.array([1 / 3]), np.array([[math.pi]]), math.sqrt(2), 7, 0.1),
        3,
        7,
        8,
        (Bounds(0, -math.inf, 1 / 7),),
    )
    turned = Question(Mapping("identity", SCHEMA["orientation"]), (1,), Arc(0.1 + 0.2, 1 / 7, 2.5), 4, 5, 6)
    nodes: tuple[Node, ...] = (
        Instantiation(1),
        Instantiation(2),
        near,
        turned,
        Leaf(2 / 3, 1, 2),
        *(leaf(p) for p in (0.5, 0.25, 0.1, 0.0)),
    )
    return Tree(SCHEMA, nodes)


def test_round_trip_through_text_is_exact() -> None:
    text = json.dumps(tree().to_dict(), allow_nan=False)
    again = Tree.from_dict(json.loads(text))

    assert json.dumps(again.to_dict()) == text
    assert again.schema == SCHEMA
    assert str(again) == str(tree())
    np.testing.assert_array_equal(again.packed.nodes, tree().packed.nodes)
    np.testing.assert_array_equal(again.packed.numbers, tree().packed.numbers)


def test_round_trip_through_a_file(tmp_path: Any) -> None:
    write_json(tmp_path / "tree.json", tree().to_dict())
    again = Tree.from_dict(read_json(tmp_path / "tree.json", format=FORMAT, version=VERSION))

    assert again.to_dict() == tree().to_dict()


def test_the_document_in_full() -> None:
    schema = Schema((Attribute("weight", operations=("identity",)),))
    question = Question(Mapping("identity", schema["weight"]), (0,), ball([5.0], 2.0), 2, 3, 4)
    nodes = (Instantiation(1), question, Leaf(0.75, 1, 3), Leaf(0.0, 4, 0), Leaf(0.5, 0, 0))

    assert Tree(schema, nodes).to_dict() == {
        "format": "relforest-tree",
        "version": 1,
        "schema": {
            "attributes": [{"name": "weight", "dim": 1, "kind": "euclidean", "operations": ["identity"]}],
            "parameters": [],
        },
        "nodes": [
            {"kind": "instantiation", "child": 1},
            {
                "kind": "question",
                "operation": "identity",
                "attribute": "weight",
                "variables": [0],
                "volume": {
                    "shape": "ellipsoid",
                    "mean": [5.0],
                    "covariance": [[1.0]],
                    "radius": 2.0,
                    "n_keys": 1,
                    "prior_weight": 0.0,
                },
                "yes": 2,
                "no": 3,
                "error": 4,
            },
            {"kind": "leaf", "probability": 0.75, "negatives": 1, "positives": 3},
            {"kind": "leaf", "probability": 0.0, "negatives": 4, "positives": 0},
            {"kind": "leaf", "probability": 0.5, "negatives": 0, "positives": 0},
        ],
    }


def changed(change: Callable[[Document], object]) -> Document:
    """The document of `tree` after a change in place."""
    document = copy.deepcopy(tree().to_dict())
    change(document)
    return document


PATHS: list[tuple[str | int, ...]] = [
    ("format",),
    ("version",),
    ("schema",),
    ("schema", "attributes"),
    ("schema", "parameters"),
    ("schema", "attributes", 0, "dim"),
    ("nodes",),
    ("nodes", 0, "kind"),
    ("nodes", 0, "child"),
    ("nodes", 2, "kind"),
    ("nodes", 2, "operation"),
    ("nodes", 2, "attribute"),
    ("nodes", 2, "variables"),
    ("nodes", 2, "volume"),
    ("nodes", 2, "volume", "shape"),
    ("nodes", 2, "volume", "mean"),
    ("nodes", 2, "volume", "covariance"),
    ("nodes", 2, "volume", "radius"),
    ("nodes", 2, "volume", "n_keys"),
    ("nodes", 2, "volume", "prior_weight"),
    ("nodes", 3, "volume", "mean"),
    ("nodes", 3, "volume", "radius"),
    ("nodes", 3, "volume", "kappa"),
    ("nodes", 2, "yes"),
    ("nodes", 2, "no"),
    ("nodes", 2, "error"),
    ("nodes", 4, "kind"),
    ("nodes", 4, "probability"),
    ("nodes", 4, "negatives"),
    ("nodes", 4, "positives"),
]


def holder(document: Any, path: tuple[str | int, ...]) -> Any:
    for step in path[:-1]:
        document = document[step]
    return document


@pytest.mark.parametrize(
    "bounds",
    [
        *(1, [0], [[0, 1]], [[0, None, None]], [[0, 2, 1]], [[1, 0, 1]], [[-1, 0, 1]], [[0.5, 0, 1]]),
        *([[0, "1", 2]], [[0, 1e200, None]], [[0, 1, None], [0, None, 2]]),
    ],
)
def test_bounds_that_make_no_sense_are_refused(bounds: object) -> None:
    with pytest.raises(ModelFormatError):
        Tree.from_dict(changed(lambda whole: whole["nodes"][2].update(bounds=bounds)))


def test_files_without_bounds_are_read() -> None:
    document = changed(lambda whole: whole["nodes"][2].pop("bounds"))

    assert "is within 0.143 of A" not in str(Tree.from_dict(document))


@pytest.mark.parametrize("path", PATHS, ids=lambda path: ".".join(map(str, path)))
def test_every_missing_key_is_refused(path: tuple[str | int, ...]) -> None:
    document = changed(lambda whole: holder(whole, path).pop(path[-1]))
    with pytest.raises(ModelFormatError):
        Tree.from_dict(document)


WRONG: list[object] = [None, True, "text", "1", -1, 1.5, 10**400, [], [[]], {}, [None], {"kind": "leaf"}]

# Those of them that are well-formed in some places.
RIGHT_AFTER_ALL: dict[tuple[str | int, ...], tuple[str, ...]] = {
    ("schema", "parameters"): ("[]",),
    ("nodes", 2, "volume", "radius"): ("1.5",),
    ("nodes", 2, "volume", "prior_weight"): ("1.5",),
    ("nodes", 3, "volume", "mean"): ("-1", "1.5"),
    ("nodes", 3, "volume", "radius"): ("1.5",),
    ("nodes", 3, "volume", "kappa"): ("1.5",),
}


@pytest.mark.parametrize("path", PATHS, ids=lambda path: ".".join(map(str, path)))
def test_every_value_of_a_wrong_type_is_refused(path: tuple[str | int, ...]) -> None:
    for value in WRONG:
        document = changed(lambda whole, value=value: holder(whole, path).update({path[-1]: value}))  # type: ignore[misc]
        if repr(value) in RIGHT_AFTER_ALL.get(path, ()):
            Tree.from_dict(document)
            continue
        with pytest.raises(ModelFormatError):
            Tree.from_dict(document)


@pytest.mark.parametrize("document", [None, [], "text", 7, {}, {"format": FORMAT}, {"nodes": []}])
def test_what_is_no_tree_at_all_is_refused(document: object) -> None:
    with pytest.raises(ModelFormatError, match="tree"):
        Tree.from_dict(document)


def set_at(*path: str | int, to: object) -> Callable[[Document], object]:
    return lambda document: holder(document, path).update({path[-1]: to})


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (set_at("version", to=3), "written by a newer relforest: relforest-tree version 3"),
        (set_at("format", to="relforest-policy"), "its format is 'relforest-policy'"),
        (set_at("nodes", to=[]), "a tree needs at least one node"),
        (set_at("nodes", 0, "kind", to="forest"), "unknown node type 'forest': expected leaf, instantiation"),
        (set_at("nodes", 0, "child", to=0), "node 0 points to node 0"),
        (set_at("nodes", 0, "child", to=2), "node 0 points to node 2|node 1 has no parent"),
        (set_at("nodes", 1, "child", to=0), "node 1 points to node 0"),
        (set_at("nodes", 2, "yes", to=2), "node 2 points to node 2"),
        (set_at("nodes", 2, "error", to=7), "node 2 points to node 7: every node must have one parent"),
        (
            set_at("nodes", 2, "variables", to=[0, 2]),
            r"needs 2 different bound variables, got \(0, 2\) with 2",
        ),
        (set_at("nodes", 2, "variables", to=[0, 0]), "needs 2 different bound variables"),
        (set_at("nodes", 2, "variables", to=[-1, 0]), "needs 2 different bound variables"),
        (set_at("nodes", 2, "variables", to=[0, True]), "expected a whole number, got True"),
        (set_at("nodes", 2, "variables", to="01"), "expected a whole number, got '0'"),
        (set_at("nodes", 2, "operation", to="reframe"), "needs 3 different bound variables"),
        (set_at("nodes", 2, "operation", to="exec"), "unknown operation 'exec'"),
        (set_at("nodes", 2, "attribute", to="speed"), "unknown attribute 'speed'"),
        (set_at("nodes", 2, "attribute", to="orientation"), "not defined for kind 'angle'"),
        (set_at("nodes", 2, "volume", to=Arc(0.0, 1.0, 1.0).to_dict()), "needs an ellipsoid in 1 dimension"),
        (set_at("nodes", 3, "volume", to=ball([0.0], 1.0).to_dict()), "needs an arc in 1 dimension"),
        (set_at("nodes", 2, "volume", "radius", to=-1.0), "radius must be a number of at least 0"),
        (set_at("nodes", 2, "volume", "radius", to=math.nan), "not finite"),
        (set_at("nodes", 2, "volume", "covariance", to=[[0.0]]), "not positive definite"),
        (set_at("nodes", 4, "probability", to=1.5), "probability must be a number .* at most 1, got 1.5"),
        (set_at("nodes", 4, "probability", to=-0.1), "probability must be a number of at least 0"),
        (set_at("nodes", 4, "probability", to=math.inf), "not finite"),
        (set_at("nodes", 4, "negatives", to=-3), r"malformed leaf: counts \[-3, 2\]"),
        (set_at("nodes", 4, "positives", to=2.0), "expected a whole number, got 2.0"),
        (set_at("schema", "parameters", to=["passer", "passer"]), "two arguments are named 'passer'"),
    ],
)
def test_the_message_says_what_is_wrong(change: Callable[[Document], object], message: str) -> None:
    with pytest.raises(ModelFormatError, match=message):
        Tree.from_dict(changed(change))


def test_a_document_nested_too_deep_is_refused() -> None:
    nested: object = 0.5
    for _ in range(100):
        nested = [nested]
    with pytest.raises(ModelFormatError, match="nested more than 64 levels deep"):
        Tree.from_dict(changed(set_at("nodes", 4, "probability", to=nested)))


def test_a_branch_too_long_is_refused_before_memory_runs_out() -> None:
    volume = ball([0.0, 0.0], 1.0).to_dict()
    n = 3000
    nodes: list[Document] = [{"kind": "instantiation", "child": 1}]
    for i in range(1, n):
        links = {"yes": i + 1, "no": i + 2, "error": i + 3}
        nodes.append(
            {
                "kind": "question",
                "operation": "identity",
                "attribute": "location",
                "variables": [0],
                "volume": volume,
            }
            | links
        )
    # Not even a tree: its nodes have several parents. That is found at the second question already.
    with pytest.raises(ModelFormatError, match="every node must have one parent"):
        Tree.from_dict(changed(set_at("nodes", to=nodes)))
    for i in range(1, n):
        nodes[i] |= {"no": 2 * n - i, "error": 3 * n - i}
    leaves = [leaf_document() for _ in range(3 * n)]
    with pytest.raises(ModelFormatError, match="question number 1001 of its branch"):
        Tree.from_dict(changed(set_at("nodes", to=nodes + leaves)))


def leaf_document() -> Document:
    return {"kind": "leaf", "probability": 0.5, "negatives": 0, "positives": 0}


def question_document(yes: int, no: int, error: int) -> Document:
    return {
        "kind": "question",
        "operation": "identity",
        "attribute": "location",
        "variables": [0],
        "volume": ball([0.0, 0.0], 1.0).to_dict(),
        "yes": yes,
        "no": no,
        "error": error,
    }


def instantiations(count: int) -> list[Document]:
    return [{"kind": "instantiation", "child": i + 1} for i in range(count)]


def stub_of(schema: Document) -> Callable[[Document], object]:
    return lambda document: document.update(schema=schema, nodes=[leaf_document()])


def many_attributes(count: int, dim: int = 1) -> Document:
    names = (f"a{i}" for i in range(count))
    return Schema([Attribute(name, dim, operations=["identity"]) for name in names]).to_dict()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (set_at("nodes", to=[*instantiations(200), leaf_document()]), "node 100 binds variable number 101"),
        (set_at("nodes", to=[*instantiations(100_000), leaf_document()]), "a tree with 100001 nodes is too"),
        (
            stub_of(many_attributes(1001)),
            "a tree with 1001 attributes is too large",
        ),
        (stub_of(many_attributes(1, 10**30)), f"{10**30} components of attributes is too large"),
        (set_at("schema", "parameters", to=[f"p{i}" for i in range(101)]), "101 action arguments"),
        (set_at("nodes", 4, "positives", to=2**53 + 1), "malformed leaf: counts"),
    ],
    ids=range(6),
)
def test_what_could_not_be_learned_is_too_large(change: Callable[[Document], object], message: str) -> None:
    with pytest.raises(ModelFormatError, match=message):
        Tree.from_dict(changed(change))


def test_matrices_of_slabs_are_bounded() -> None:
    schema = Schema((Attribute("weights", 50_000),))
    wide = Slab(ball([0.0], 1.0), 1, 50_000)
    question = Question(Mapping("identity", schema["weights"]), (0,), wide, 2, 3, 4)
    document = Tree(schema, (leaf(0.5),)).to_dict()
    document["nodes"] = [node_to_dict(node) for node in (Instantiation(1), question, *(leaf(0.5),) * 3)]
    with pytest.raises(ModelFormatError, match="numbers in the matrices of its slabs is too large"):
        Tree.from_dict(document)


def test_long_branches_are_bounded_in_all(monkeypatch: pytest.MonkeyPatch) -> None:
    # Above the nodes stand 0, 1, 2 and five times 1 or 2 questions, each node counted itself.
    nodes = [*instantiations(1), question_document(2, 6, 7), question_document(3, 4, 5)]
    document = changed(set_at("nodes", to=nodes + [leaf_document()] * 5))

    monkeypatch.setattr(structure, "MAX_ABOVE", 11)
    Tree.from_dict(document)
    monkeypatch.setattr(structure, "MAX_ABOVE", 10)
    with pytest.raises(ModelFormatError, match="the branches ask more than 10 questions in all"):
        Tree.from_dict(document)


@pytest.mark.parametrize("change", [("radius", 1e95), ("radius", 1e85), ("mean", [1e80])])
def test_a_volume_beyond_what_can_be_learned_is_refused(change: tuple[str, object]) -> None:
    with pytest.raises(ModelFormatError, match="malformed ellipsoid: "):
        Tree.from_dict(changed(set_at("nodes", 2, "volume", change[0], to=change[1])))


def test_the_largest_volume_contains_everything() -> None:
    schema = Schema((Attribute("location", 2),), ("passer",))
    document = changed(set_at("nodes", 2, "volume", "radius", to=1e39))
    del document["nodes"][2]["bounds"]
    assert "there is a B within 1.77e+39 of A" in str(Tree.from_dict(document))
    nodes = [
        *document["nodes"][:2],
        document["nodes"][2] | {"yes": 3, "no": 4, "error": 5},
        *[leaf_document()] * 3,
    ]
    plain = Tree.from_dict(document | {"schema": schema.to_dict(), "nodes": nodes})
    scenes = scenes_in(schema, [[(0.0, 0.0), (1e9, 1e9)], [(0.0, 0.0)]], [[0], [0]])
    assert query(plain.with_leaves([leaf(0.9), leaf(0.1), leaf(0.2)]), scenes).leaf.tolist() == [0, 2]
