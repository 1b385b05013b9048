from __future__ import annotations

from relforest.experiments.concepts.analysis import concept_models, figures, summarize
from relforest.experiments.concepts.run import SCENES
from relforest.experiments.concepts.settings import THRESHOLDS, TITLES
from relforest.experiments.table import Row, Table


def row(concept: str, test: str, pss: float, replicate: int = 0, method: str = "tree, 0.001") -> Row:
    return {
        "concept": concept,
        "method": method,
        "replicate": replicate,
        "test": test,
        "pss": pss,
        "leaves": 3,
        "words": f"tree {replicate} of {concept}",
        "ellipse": 0.9 if concept == "between" else None,
    }


TABLE = Table.of(
    [
        row("between", "same", 0.95),
        row("between", "20 more objects", 0.7),
        row("between", "same", 0.87, replicate=1),
        row("between", "20 more objects", 0.6, replicate=1),
        row("between", "same", 0.5, method="tree, 0.05"),
        row("yellow", "same", 0.8),
        row("yellow", "same", 0.7, replicate=2, method="rules"),
    ]
)


def test_trees_are_told_apart_by_concept_test_scenes_and_method() -> None:
    found = [(*names, len(own)) for *names, own in concept_models(TABLE)]

    assert found == [
        ("between", "same", "tree, 0.001", 2),
        ("between", "same", "tree, 0.05", 1),
        ("between", "20 more objects", "tree, 0.001", 2),
        ("yellow", "same", "tree, 0.001", 1),
        ("yellow", "same", "rules", 1),
    ]


def test_means_are_compared_with_the_thresholds_that_exist() -> None:
    claims = summarize(TABLE).claims

    # Between: (.95 + .87) / 2 = .91 >= .9; yellow: .8 < .85; none for a crowd, none at .05.
    assert [round(claim.measured, 12) for claim in claims] == [0.91, 0.8]
    assert [(claim.low, claim.is_missed) for claim in claims] == [(0.9, False), (0.85, True)]


def test_one_tree_of_each_concept_is_told() -> None:
    text = str(summarize(TABLE))

    assert "Learned for an object between A and B:\ntree 0 of between" in text
    assert "tree 0 of yellow" in text
    assert "tree 2 of yellow" in text  # by rules
    assert "tree 1" not in text
    told = [line.split() for line in text.splitlines()]
    expected = ("same", "tree,", "0.001", "2", "0.910", "0.870", "0.90", "0.900", "3.0")
    assert [*TITLES["between"].split(), *expected] in told


def test_the_figure_has_a_line_per_kind_of_trees() -> None:
    (axes,) = figures(TABLE)["scores.png"].axes

    assert len(axes.get_yticklabels()) == 5


def test_every_threshold_is_about_a_test_that_is_run() -> None:
    assert set(SCENES) == set(TITLES)
    assert set(THRESHOLDS) <= {(concept, test) for concept, tests in SCENES.items() for test, _ in tests}
