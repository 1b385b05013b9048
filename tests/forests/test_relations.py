"""Questions about given relations: that they are found, told, kept in files, and asked of nothing else."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from forest_scenes import RELATIONS, holds, random_condition, random_scenes, related
from interpreted import compiled_only
from relforest import (
    OutcomeForestClassifier,
    SMRFBoostingClassifier,
    SMRFForestClassifier,
    SMRFRuleSetClassifier,
    SMRFTreeClassifier,
)
from relforest.explaining import moves
from relforest.forests import Condition, Ensemble, GrowthSettings, SceneTree, Split, Value
from relforest.forests.bindings import bindings
from relforest.forests.columns import columns
from relforest.forests.features import features
from relforest.forests.statements import Bound, Is, Statement
from relforest.forests.tables import condition_tables
from relforest.forests.words import sentence
from relforest.mappings import Mapping, Related
from relforest.models import as_model
from relforest.scenes import Attribute, Relation, Scenes, Schema
from relforest.sharing import program_of
from relforest.support.errors import InputError, ModelFormatError
from relforest.trees import TreeSettings

COLOR = Attribute("color", kind="category", categories=["red", "green", "blue"])
TOUCHES, PASSES = Relation("touches"), Relation("passes to", directed=True)
PITCH = Schema([Attribute("location", 2), COLOR], ["passer"], [TOUCHES, PASSES])
FEW = GrowthSettings(max_leaves=4, share=0.5, n_discs=0)


def colored(rng: np.random.Generator, n: int, relation: Relation) -> tuple[Scenes, NDArray[np.bool_]]:
    """Scenes of five objects of random colors and pairs; is there a red one related to a blue one?"""
    matrix = np.column_stack([rng.uniform(0, 10, (5 * n, 2)), rng.integers(0, 3, 5 * n)])
    starts = 5 * np.arange(n)
    scenes = Scenes(
        Schema([Attribute("location", 2), COLOR]), matrix, np.arange(5 * n), starts, np.full(n, 5)
    )
    pairs = [
        (scene, 5 * scene + one, 5 * scene + other)
        for scene in range(n)
        for one in range(5)
        for other in range(5)
        if (one < other or (relation.directed and one != other)) and rng.random() < 0.3
    ]
    scenes = scenes.with_relations({relation: pairs})
    labels = np.zeros(n, dtype=np.bool_)
    for one, other in scenes.relations[relation.name].tolist():
        labels[one // 5] |= matrix[one, 2] == 0 and matrix[other, 2] == 2
    return scenes, labels


@compiled_only
@pytest.mark.parametrize("relation", [TOUCHES, PASSES])
def test_a_relation_that_matters_only_for_some_objects_is_found(relation: Relation) -> None:
    scenes, labels = colored(np.random.default_rng(0), 400, relation)
    model = SMRFRuleSetClassifier(averaged=False, n_trees=30, growth=FEW, random_state=0)
    model.fit(scenes[:200], labels[:200])

    assert 0.2 < labels.mean() < 0.8
    assert model.score(scenes[200:], labels[200:]) > 0.97
    assert f"{relation.name} " in model.describe()
    assert model.importances()[0].question.startswith(
        f"identity(color) of C; identity(color) of D; {relation.name}"
    )


def test_a_search_begins_with_related_objects() -> None:
    rng = np.random.default_rng(0)
    scenes = related(rng, random_scenes(rng, 30, 1))
    for table in condition_tables(scenes, 2, most=1000, rng=rng):
        firsts = table.table.categories[: table.table.firsts[1]]
        begun = [table.columns[column] for _, column, _ in firsts[list(table.related)].tolist()]
        expected = [
            column
            for column in table.columns
            if isinstance(column.mapping, Related)
            and set(range(1, 1 + table.n_free)) <= set(column.variables)
        ]
        assert begun == expected
    asked = [column.variables for column in columns(PITCH, 1) if isinstance(column.mapping, Related)]
    assert asked == [(0,), (1,), (0, 1), (0,), (1,), (0, 1), (1, 0)]


def test_of_too_many_pairs_the_related_ones_are_kept() -> None:
    rng = np.random.default_rng(0)
    scenes = related(rng, random_scenes(rng, 20, 1, most=12), 0.03)
    chosen, n_sampled = bindings(scenes, 2, most=15, rng=rng)

    assert n_sampled > 5
    pairs = np.concatenate(list(scenes.relations.values())).tolist()
    for scene in range(len(scenes)):
        here = chosen.rows[chosen.starts[scene] : chosen.starts[scene + 1], 1:].tolist()
        free = set(scenes.objects(scene).tolist()) - {scenes.arguments[scene, 0]}
        missing = [pair for pair in pairs if set(pair) <= free and pair not in here]
        assert not missing or (len(here) == 15 and all(each in pairs for each in here))
        assert len({tuple(pair) for pair in here}) == len(here) == min(15, len(free) * (len(free) - 1))


def said(statements: list[Statement], n_free: int = 1, **options: Any) -> str:
    return sentence(Condition(n_free, tuple(statements), **options), PITCH)


def test_relations_are_told_as_verbs() -> None:
    def is_related(relation: Relation, *variables: int, value: int = 1) -> Statement:
        return Statement(Related(relation), variables, Is(value))

    near = Statement(Mapping("distance", PITCH["location"]), (0, 1), Bound(0, "at most", 3.0))
    red = Statement(Mapping("identity", COLOR), (1,), Is(0))
    touches, back = is_related(TOUCHES, 0, 1), is_related(PASSES, 0, 1)

    assert said([touches]) == "some object touches the passer"
    assert said([touches, near]) == "some object that touches the passer is within 3 of the passer"
    assert said([touches, red]) == "some object with color red touches the passer"
    assert said([near, red, touches]) == (
        "some object with color red that touches the passer is within 3 of the passer"
    )
    assert said([is_related(PASSES, 1, 0)]) == "some object passes to the passer"
    assert said([back, red]) == "some object has color red; the passer passes to it"
    assert said([back]) == "there is another object; the passer passes to it"
    assert said([is_related(TOUCHES, 0, 1, value=0)]) == "some object does not touch the passer"
    anything = Statement(Related(TOUCHES, 1), (1,), Is(1))
    assert said([anything]) == "some object touches another object"
    assert said([anything, near]) == "some object that touches another object is within 3 of the passer"
    nothing = Statement(Related(TOUCHES, 1), (1,), Is(1, negated=True))
    assert said([nothing, red]) == "some object with color red does not touch any other object"
    assert said([is_related(TOUCHES, 1, 2)], 2, every=True) == (
        "every object C has another, D, such that D touches C"
    )
    assert said([is_related(PASSES, 1, 2), red], 2, at_least=2) == (
        "there are at least 2 pairs of objects C and D such that C passes to D and C has color red"
    )


@pytest.mark.parametrize(
    ("verb", "expected"),
    [
        ("touches", "does not touch"),
        ("is bonded to", "is not bonded to"),
        ("has a bond with", "does not have a bond with"),
        ("carries", "does not carry"),
        ("holds", "does not hold"),
        ("boxes", "does not box"),
        ("can reach", "can not reach"),
    ],
)
def test_verbs_are_denied(verb: str, expected: str) -> None:
    schema = Schema([COLOR], ["A"], [verb])
    statement = Statement(Related(Relation(verb)), (0, 1), Is(1, negated=True))
    assert sentence(Condition(1, (statement,)), schema) == f"some object {expected} A"


def an_ensemble(rng: np.random.Generator, scenes: Scenes) -> Ensemble:
    conditions = [random_condition(rng, scenes.schema.n_parameters, RELATIONS) for _ in range(30)]
    trees = tuple(
        SceneTree((Split(each, 1, 2, 0.0), Value((1.0,), 0), Value((0.0,), 0))) for each in conditions
    )
    return Ensemble(scenes.schema, np.zeros(1), trees, np.ones(len(trees)))


def test_models_come_back_from_files_and_older_ones_are_written_as_before() -> None:
    rng = np.random.default_rng(1)
    scenes = related(rng, random_scenes(rng, 40, 1))
    ensemble = an_ensemble(rng, scenes)
    document = json.loads(json.dumps(ensemble.to_dict()))
    read = Ensemble.from_dict(document)

    assert document["version"] == 2
    assert read.conditions == ensemble.conditions
    assert np.array_equal(read.leaves(scenes), ensemble.leaves(scenes))
    plain = Ensemble(Schema([COLOR]), np.zeros(1), (), np.empty(0))
    assert plain.to_dict()["version"] == 1
    for change, message in (
        ({"relation": "sees"}, "unknown relation 'sees'"),
        ({"relation": ["touches"]}, "unknown relation|malformed"),
        ({"relation": "touches", "variables": []}, "objects must be an integer from 1 to 2, got 0"),
        ({"relation": "touches", "is": 2}, "category must be an integer from 0 to 1, got 2"),
        ({"relation": "touches", "is": None}, "category"),
    ):
        statement = {"relation": "touches", "variables": [0, 1], "is": 1} | change
        broken = document | {
            "trees": [
                [
                    {
                        "condition": {"free": 1, "at_least": 1, "statements": [statement]},
                        "yes": 1,
                        "no": 2,
                        "gain": 0.0,
                    },
                    *document["trees"][0][1:],
                ]
            ]
        }
        with pytest.raises(ModelFormatError, match=message):
            Ensemble.from_dict(broken | {"weights": [1.0]})


def test_counts_and_distances_are_those_of_categories() -> None:
    rng = np.random.default_rng(2)
    scenes = related(rng, random_scenes(rng, 20, 1))
    touches = Statement(Related(TOUCHES), (0, 1), Is(1))
    condition = Condition(1, (touches,))
    tree = SceneTree((Split(condition, 1, 2, 0.0), Value((1.0,), 0), Value((0.0,), 0)))
    ensemble = Ensemble(scenes.schema, np.zeros(1), (tree,), np.ones(1))
    pairs = scenes.relations["touches"].tolist()
    expected = [
        sum([argument, row] in pairs for row in scenes.objects(scene).tolist())
        for scene, argument in enumerate(scenes.arguments[:, 0].tolist())
    ]

    assert features(ensemble, scenes, "counts")[:, 0].tolist() == expected
    distances = features(ensemble, scenes, "distances")[:, 0]
    assert [distance <= 0 for distance in distances] == [n > 0 for n in expected]
    assert [holds(condition, scenes, scene) for scene in range(20)] == [n > 0 for n in expected]


def test_a_model_refuses_scenes_without_its_relation_and_explains_others() -> None:
    scenes, labels = colored(np.random.default_rng(0), 60, TOUCHES)
    model = SMRFBoostingClassifier(n_trees=5, growth=FEW, random_state=0).fit(scenes, labels)
    plain = Scenes(Schema(scenes.schema.attributes), *scenes.parts[1:5])

    with pytest.raises(InputError, match=r"model is for scenes with .*; relations touches, and these"):
        model.predict(plain)
    with pytest.raises(InputError, match=r"and these have .*; relations touches \(directed\)"):
        model.predict(plain.with_relations({Relation("touches", directed=True): []}))
    reason = next(each for each in model.explain(scenes[labels][:1])[0].reasons if each.holds)
    assert "touches" in reason.sentence
    rows = [scenes.object_ids.tolist().index(reason.witnesses[name]) for name in "CD"]
    assert rows in scenes.relations["touches"].tolist()
    moved = moves.moved(moves.single(scenes[:1]), np.array([0, 3]), np.zeros((2, 2)))
    first = scenes[:1].compact().relations["touches"].tolist()
    assert moved.relations["touches"].tolist() == first + (np.array(first) + 5).tolist()


@pytest.mark.parametrize(
    "model",
    [
        SMRFTreeClassifier(),
        SMRFForestClassifier(growth=TreeSettings(), n_trees=2),
        OutcomeForestClassifier(growth=TreeSettings(), n_trees=2),
    ],
    ids=["tree", "forest", "outcome"],
)
def test_smrf_trees_refuse_relations(model: Any) -> None:
    scenes, labels = colored(np.random.default_rng(0), 60, TOUCHES)
    with pytest.raises(
        InputError, match="SMRF trees do not ask about relations, such as 'touches': learn boost"
    ):
        model.fit(scenes, labels)


def test_a_model_that_asks_about_relations_is_not_written_as_code() -> None:
    scenes, labels = colored(np.random.default_rng(0), 60, TOUCHES)
    model = SMRFBoostingClassifier(n_trees=3, growth=FEW, random_state=0).fit(scenes, labels)
    with pytest.raises(
        InputError, match="asks about the relation 'touches', which code without relforest cannot"
    ):
        program_of(as_model(model))


def test_any_other_object_is_one_of_the_same_scene() -> None:
    both = Scenes(
        Schema([COLOR]), np.zeros((3, 1)), np.array([0, 1, 0, 2]), np.array([0, 2]), np.array([2, 2])
    ).with_relations({TOUCHES: [(0, 0, 1)]})
    statement = Statement(Related(TOUCHES, 1), (0,), Is(1))
    tree = SceneTree((Split(Condition(1, (statement,)), 1, 2, 0.0), Value((1.0,), 0), Value((0.0,), 0)))
    ensemble = Ensemble(both.schema, np.zeros(1), (tree,), np.ones(1))
    choices, _ = bindings(both, 1, most=10, rng=np.random.default_rng(0))

    assert ensemble.scores(both)[:, 0].tolist() == [1.0, 0.0]
    assert features(ensemble, both, "counts")[:, 0].tolist() == [2.0, 0.0]
    values = Related(TOUCHES, 1).evaluate(both, choices.rows, np.array([0, 0, 1, 1]))
    assert values[:, 0].tolist() == [1.0, 1.0, 0.0, 0.0]
