"""Every format that relforest reads: a valid file of it, ways to damage that, and how to read it."""

from __future__ import annotations

import gzip
import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final, final

import numpy as np
import pandas as pd
import pyarrow as pa
from matplotlib.figure import Figure
from pyarrow import parquet

from mutations import (
    Mutation,
    damaged,
    either,
    inside_gzip,
    with_other_arrays,
    with_other_fields,
    with_other_values,
)
from relforest import CovAggClassifier, load, save
from relforest.datasets import read_arff, read_c45, read_csv
from relforest.experiments.claims import Findings
from relforest.experiments.keepaway_team import Team
from relforest.experiments.run_config import RunConfig
from relforest.experiments.runner import run_study
from relforest.experiments.sarsa import SarsaLearner, Trained, trained_team
from relforest.experiments.study import Context, Study
from relforest.experiments.table import Row, Table
from relforest.experiments.tasks import task_named
from relforest.experiments.vectors import vector_learner, vector_value
from relforest.forests import Condition, Ensemble, SceneTree, Split, Value
from relforest.forests.statements import Bound, Is, Near, Statement
from relforest.mappings import Mapping as MappingFunction
from relforest.mappings import Related
from relforest.models import Model, read_model, write_model
from relforest.reports import QuestionPoints, save_figure, tree_figure
from relforest.reports.run_report import metrics_table, run_report
from relforest.reports.tree_path import path_in_words, tree_path
from relforest.rl.baselines import SarsaSettings, TileCoding, make_team
from relforest.rl.configuration import restore_run
from relforest.rl.fitted import CurveSettings, ForestSettings, QLearner, QSettings
from relforest.rl.learner import Knowledge, RPILearner
from relforest.rl.rollout import world_of
from relforest.rl.saved_policy import read_policy
from relforest.rl.settings import RPISettings
from relforest.rl.value import ValueFunction
from relforest.runs.learner import METRIC_NAMES, Learner, Run, advance
from relforest.runs.manifest import held
from relforest.runs.store import RunStore, metrics_of, read_checkpoint
from relforest.scenes import Attribute, Relation, Scenes, Schema, iter_scene_batches, read_table
from relforest.scenes.frames import FrameLayout
from relforest.smdp import Decision
from relforest.support.rng import seed_sequence
from relforest.trees import ClassLeaf, MeanLeaf, Tree, query
from relforest.volumes import Slab
from relforest.worlds.keepaway.server.options import KeepawayOptions
from reports.drawn_trees import NEAR, five_questions, one_question, question, scenes_of
from reports.drawn_trees import SCHEMA as DRAWN_SCHEMA
from rl.small_worlds import ACTION_TYPES, PICK_SCHEMA, SCHEMA, Limited, Picking, beside, near, two_episodes

TABLE: Final = "".join(
    ["scene,object,x,y,theta,label\n"]
    + [f"{i // 3},o{i},{i % 7 - 3.5},{i * i % 11 / 4},{i % 6 - 3},{i // 3 % 2}\n" for i in range(24)]
)
BAGS: Final = TABLE.replace("scene", "bag_id").replace("label", "bag_label")
ATTRIBUTES: Final[Mapping[str | Attribute, Sequence[str]]] = {
    "location": ("x", "y"),
    Attribute("orientation"): ("theta",),
}
SCENES: Final = scenes_of([[0, 0], [1, 0.1], [0.5, 0]], [[0, 0], [4, 4]], [[1, 1], [2.5, 1]])
RELATED: Final = SCENES.with_relations(
    {"touches": [("scene 0", "a0", "b0"), ("scene 0", "b0", "c0"), ("scene 2", "a2", "b2")]}
)
DATA: Final = Path(__file__).parent / "data"
FORESTS: Final = ((near(SCHEMA), near(SCHEMA, mean=0.9)), (beside(), near(PICK_SCHEMA)))
NAMES: Final = (("0001-wait-1.json", "0002-wait-1.json"), ("0001-pick-1.json", "0002-pick-1.json"))
CONFIG: Final = RunConfig("corridor", episodes=3, iterations=2, seed=7)
LEARNER: Final = RPILearner(Picking(), RPISettings(), seed_sequence(7), 3, 3)
SARSA: Final = SarsaLearner(KeepawayOptions(), SarsaSettings(), False, seed_sequence(7), 3, 3)  # noqa: FBT003
FEW: Final = QSettings(
    curves=CurveSettings(rounds=2, candidates=20, min_scenes=5, ridge=1.0),
    forests=ForestSettings(counts=4, trees=2),
)
SUM: Final = QLearner(Picking(), FEW, seed_sequence(7), 20, 3)
HORIZON: Final = QLearner(Limited(), FEW, seed_sequence(7), 20, 3)
KEEPAWAY: Final = task_named("keepaway").make()
VECTORS: Final = vector_learner("linear-q", KEEPAWAY, seed_sequence(7), (4, 1))
ROWS: Final = [
    {
        "iteration": number,
        "test_reward": 0.5 * number,
        "train_reward": None if number == 0 else 1.5,
        "trees": 2 * number,
        "leaves": 6 * number,
    }
    for number in range(3)
]


@final
@dataclass(frozen=True, slots=True)
class Format:
    """One format.

    Parameters
    ----------
    make : callable
        Writes valid files into an empty folder.
    mutations : mapping of str to Mutation
        How each of its files may be damaged; patterns of `Path.glob`.
    read : callable
        Reads the folder through the public reader and uses what it got.
    weight : int
        Of how many cases it gets, against 1 of a format that is quick to read.
    """

    make: Callable[[Path], object]
    mutations: Mapping[str, Mutation]
    read: Callable[[Path], object]
    weight: float = field(default=1.0)


def mutate(files: Mapping[str, bytes], chosen: Format, rng: np.random.Generator) -> dict[str, bytes]:
    """Return the files of a format, one of which is damaged."""
    targets = [
        (name, mutation)
        for name in sorted(files)
        for pattern, mutation in chosen.mutations.items()
        if Path(name).match(pattern)
    ]
    name, mutation = targets[int(rng.integers(len(targets)))]
    return {**files, name: mutation(files[name], rng)}


def _frame(path: Path) -> Scenes:
    scenes = Scenes.from_frame(read_table(path), scene="scene", object="object", attributes=ATTRIBUTES)
    assert len(scenes.scene_ids) == len(scenes)
    return scenes


def _foreign_parquet(folder: Path) -> None:
    columns: dict[str, list[Any]] = {name: [] for name in TABLE.split("\n")[0].split(",")}
    for line in TABLE.split("\n")[1:-1]:
        for name, value in zip(columns, line.split(","), strict=True):
            columns[name].append(value if name == "object" else float(value))
    table = pa.table(columns)
    table = table.set_column(0, "scene", table["scene"].cast("int64")).append_column(
        "when", pa.array([None] * 24, pa.timestamp("us"))
    )
    parquet.write_table(table, folder / "table.parquet", compression="snappy", row_group_size=10)


def _own_scenes(path: Path) -> None:
    scenes = Scenes.from_parquet(path)
    assert len(scenes.scene_ids) == len(scenes)


def _stream(source: Path, **columns: Any) -> None:
    for scenes in iter_scene_batches(source, batch_size=4, **columns):
        assert len(scenes.scene_ids) == len(scenes)


def _model(folder: Path) -> None:
    names = (("x", "y"), ("theta",), ("r", "g", "b"), ("cost",))
    columns = FrameLayout(
        "pass", "player", tuple(zip(DRAWN_SCHEMA.attributes, names, strict=True)), ("passer",)
    )
    points = QuestionPoints(np.arange(8.0).reshape(-1, 2) / 3, np.arange(4) % 2 == 0)
    write_model(
        folder / "model.json",
        Model(five_questions(), "tree", "completed", ("no", "yes"), columns, {2: points}),
    )


TEAMS: Final = Schema(
    (*DRAWN_SCHEMA.attributes[:2], Attribute("team", kind="category", categories=["home", "guest"])),
    ("passer",),
    (Relation("touches"),),
)


def _ensemble(folder: Path) -> None:
    location, theta, team = TEAMS.attributes
    statements = (
        Statement(MappingFunction("distance", location), (0, 1), Bound(0, "at most", 3.5)),
        Statement(MappingFunction("difference", location), (0, 1), Near(0, (1.0, 0.5), (2.0, 0.25))),
        Statement(MappingFunction("identity", theta), (1,), Near(0, (3.0,), (0.5,))),
        Statement(MappingFunction("same", team), (0, 1), Is(1, negated=True)),
        Statement(Related(TEAMS.relations[0]), (1, 0), Is(1)),
    )
    trees = tuple(
        SceneTree((Split(Condition(1, asked, 2), 1, 2, 0.5), Value((0.3,), 4), Value((-0.1,), 7)))
        for asked in (statements[:2], statements[2:])
    )
    attributes = ((location, ("x", "y")), (theta, ("theta",)), (team, ("team",)))
    columns = FrameLayout("pass", "player", attributes, ("p",), ((TEAMS.relations[0], "near"),))
    learned = Ensemble(TEAMS, np.zeros(1), trees, np.array([0.5, 0.25]))
    write_model(folder / "boosting.json", Model(learned, "boosting", "completed", ("no", "yes"), columns))


def _smrf_forest(folder: Path) -> None:
    tree = five_questions()
    learned = Ensemble(tree.schema, np.array([0.5]), (tree, tree), np.array([0.5, -0.5]))
    write_model(folder / "forest.json", Model(learned, "forest", "", ("no", "yes"), None))


def _forest_of_numbers(folder: Path) -> None:
    tree = five_questions()
    tree = tree.with_leaves([MeanLeaf(float(number), 0, 3, 0.5) for number in range(tree.n_leaves)])
    learned = Ensemble(tree.schema, np.zeros(1), (tree, tree), np.array([0.5, 0.5]))
    write_model(folder / "numbers.json", Model(learned, "forest", "speed", None, None))


def _several_classes(folder: Path) -> None:
    tree = one_question()
    shares = ((0.5, 0.25, 0.25), (0.0, 1.0, 0.0), (0.25, 0.0, 0.75))
    tree = tree.with_leaves([ClassLeaf(max(each[1:]), 2, 2, each, (2, 1, 1)) for each in shares])
    write_model(folder / "classes.json", Model(tree, "tree", "where", ("a", "b", "c"), None))


def _volume(folder: Path) -> None:
    bags = np.arange(32.0).reshape(8, 2, 2) % 7
    frames = [pd.DataFrame(bag, columns=["x", "y"]) for bag in bags]
    save(CovAggClassifier(random_state=0).fit(frames, [0, 1] * 4), folder / "volume.json")


def _use_volume(path: Path) -> None:
    classifier = load(path)
    assert isinstance(classifier, CovAggClassifier)
    columns = getattr(classifier, "feature_names_in_", None)
    bag = pd.DataFrame(np.zeros((3, classifier.n_features_in_)), columns=columns)
    assert len(classifier.predict([bag])) == 1


def _use_ensemble(path: Path) -> None:
    model = read_model(path)
    assert model.text
    matrix = np.array([[0.0, 0.0, 0.1, 0.0], [1.0, 0.5, 3.0, 1.0], [2.0, 2.0, np.nan, np.nan]])
    if model.schema == TEAMS:
        rows, count = np.arange(3), np.array([3])
        scenes = Scenes(model.schema, matrix, rows, np.array([0]), count, np.array([[0]]))
        assert len(model.predictions(scenes).predicted) == 1
    if model.schema == SCENES.schema:
        probability = model.predictions(SCENES).probability
        assert probability is None or (probability >= 0.0).all()


def _use_model(path: Path) -> None:
    model = read_model(path)
    assert str(model.tree)
    assert model.outcome
    scene = None
    if model.tree.schema == SCENES.schema:
        query(model.tree, SCENES)
        scene = SCENES.take([0])
        assert path_in_words(model.tree, tree_path(model.tree, scene))
    # A picture takes a hundred times longer than the rest: a share of the cases gets one.
    if path.stat().st_size % 8 == 0:
        figure = tree_figure(model.tree, points=model.points, highlight=scene, title=model.outcome)
        save_figure(figure, path.with_suffix(".svg" if path.stat().st_size % 16 else ".png"))


def _six_questions() -> Tree:
    """Volumes of all shapes."""
    tree = five_questions()
    return tree.expanded(tree.n_leaves - 1, 0, question("difference", "location", (0, 1), Slab(NEAR, 1, 2)))


def _value() -> ValueFunction:
    weights = (np.linspace(-1, 1, 13), np.linspace(0, 1, 20))
    return ValueFunction(SCHEMA, ACTION_TYPES, "densities+bits", FORESTS, weights)


def _act(value: ValueFunction) -> None:
    things = np.array([0.2, 0.7, 0.4])
    offered = Decision(things[:, None], np.array([0, 1, 1, 1]), np.array([[-1], [0], [1], [2]]), np.arange(4))
    if value.schema == SCHEMA and value.action_types == ACTION_TYPES:
        assert np.isfinite(value.values(offered)).all()


def _run(folder: Path) -> None:
    knowledge = Knowledge(_value(), NAMES, (two_episodes(), two_episodes()))
    with held(folder, CONFIG.manifest(), is_finished=lambda: True):
        RunStore(folder, LEARNER).write(Run(knowledge, tuple(ROWS)))


def _use_run(folder: Path) -> None:
    with held(folder, CONFIG.manifest(), is_finished=lambda: True):
        rows = metrics_of(folder)
    assert metrics_table(rows, METRIC_NAMES)
    assert run_report(folder)
    restore_run(read_checkpoint(folder).configuration, folder)
    run = RunStore(folder, LEARNER).resume()
    if run is not None:
        _act(run.state.value)


def _sarsa(folder: Path) -> None:
    team: Team = make_team(TileCoding([2.0, 10.0], 3, tilings=2), 3, SarsaSettings(), random_state=0)
    for number in range(2):
        RunStore(folder, SARSA).write(Run(Trained(team), tuple(ROWS[: number + 1])))


def _use_sarsa(folder: Path) -> None:
    assert metrics_table(metrics_of(folder), METRIC_NAMES)
    for agent in trained_team(folder):
        if agent.features.n_features < 1000 and agent.features.to_dict()["widths"] == [2.0, 10.0]:
            agent.start(np.array([1.0, 5.0]))


def _learned_run(learner: Learner[Any]) -> Callable[[Path], None]:
    def make(folder: Path) -> None:
        run = None
        for _ in range(2):
            run, _ = advance(learner, run)
            RunStore(folder, learner).write(run)

    return make


def _use_fitted(learner: QLearner, folder: Path) -> None:
    assert run_report(folder)
    run = RunStore(folder, learner).resume()
    value = read_policy(folder)
    if run is not None and value.schema == SCHEMA and value.action_types == ACTION_TYPES:
        learner.env.reset(seed=1)
        assert np.isfinite(value.values(world_of(learner.env).decision())).all()


def _use_vectors(folder: Path) -> None:
    RunStore(folder, VECTORS).resume()
    KEEPAWAY.reset(seed=1)
    assert np.isfinite(vector_value(folder, KEEPAWAY)[1].values(world_of(KEEPAWAY).decision())).all()


@final
@dataclass(frozen=True, slots=True)
class Count:
    """A setting of the study below."""

    count: int

    def __str__(self) -> str:
        return f"{self.count} rows"


def _count(setting: Count, context: Context) -> list[Row]:
    return [
        {"number": number, "name": f"row {context.index}", "value": 0.5} for number in range(setting.count)
    ]


def _findings(table: Table) -> Findings:
    return Findings(f"{len(table)} rows, {table.numbers('value').mean():.3g}, {table.distinct('name')}")


def _no_figures(_: Table) -> Mapping[str, Figure]:
    return {}


STUDY: Final = Study(
    "counting",
    "How many?",
    (Count(2), Count(3)),
    (Count(1),),
    _count,
    _findings,
    _no_figures,
    compiles=False,
)


_TEXT: Final = either(damaged, with_other_fields, with_other_fields)
_JSON: Final = either(damaged, with_other_values, with_other_values, with_other_values)
_ARRAYS: Final = either(damaged, with_other_arrays, with_other_arrays)

FORMATS: Final[Mapping[str, Format]] = {
    "csv": Format(
        lambda folder: (folder / "table.csv").write_text(TABLE),
        {"table.csv": _TEXT},
        lambda folder: _frame(folder / "table.csv"),
    ),
    "parquet, ours": Format(
        lambda folder: RELATED.to_parquet(folder / "scenes.parquet"),
        {"scenes.parquet": damaged},
        lambda folder: _own_scenes(folder / "scenes.parquet"),
    ),
    "parquet, foreign": Format(
        _foreign_parquet, {"table.parquet": damaged}, lambda folder: _frame(folder / "table.parquet")
    ),
    "parquet, streamed": Format(
        lambda folder: RELATED.take([0, 1, 0, 2]).to_parquet(folder / "scenes.parquet"),
        {"scenes.parquet": damaged},
        lambda folder: _stream(folder / "scenes.parquet"),
    ),
    "parquet, foreign, streamed": Format(
        _foreign_parquet,
        {"table.parquet": damaged},
        lambda folder: _stream(folder, scene="scene", object="object", attributes=ATTRIBUTES),
    ),
    "bags as csv": Format(
        lambda folder: (folder / "bags.csv").write_text(BAGS),
        {"bags.csv": _TEXT},
        lambda folder: read_csv(folder / "bags.csv", features=["x", "y"]),
    ),
    "bags as csv.gz": Format(
        lambda folder: (folder / "bags.csv.gz").write_bytes(gzip.compress(BAGS.encode(), mtime=0)),
        {"bags.csv.gz": inside_gzip(_TEXT)},
        lambda folder: read_csv(folder / "bags.csv.gz", features=["x", "y"]),
        0.3,
    ),
    "arff": Format(
        lambda folder: (folder / "bags.arff").write_bytes((DATA / "few_molecules.arff").read_bytes()),
        {"bags.arff": _TEXT},
        lambda folder: read_arff(folder / "bags.arff"),
    ),
    "c45": Format(
        lambda folder: (folder / "bags.data").write_bytes((DATA / "few_molecules.data").read_bytes()),
        {"bags.data": _TEXT},
        lambda folder: read_c45(folder / "bags.data"),
    ),
    "model": Format(_model, {"model.json": _JSON}, lambda folder: _use_model(folder / "model.json"), 0.7),
    "ensemble": Format(
        _ensemble, {"boosting.json": _JSON}, lambda folder: _use_ensemble(folder / "boosting.json"), 0.7
    ),
    "smrf-forest": Format(
        _smrf_forest, {"forest.json": _JSON}, lambda folder: _use_ensemble(folder / "forest.json"), 0.7
    ),
    "forest of numbers": Format(
        _forest_of_numbers,
        {"numbers.json": _JSON},
        lambda folder: _use_ensemble(folder / "numbers.json"),
        0.7,
    ),
    "tree of several classes": Format(
        _several_classes, {"classes.json": _JSON}, lambda folder: _use_ensemble(folder / "classes.json"), 0.7
    ),
    "volume": Format(
        _volume, {"volume.json": _JSON}, lambda folder: _use_volume(folder / "volume.json"), 0.7
    ),
    "tree": Format(
        lambda folder: (folder / "tree.json").write_text(json.dumps(_six_questions().to_dict())),
        {"tree.json": _JSON},
        lambda folder: _use_model(folder / "tree.json"),
        0.7,
    ),
    "run": Format(
        _run,
        {
            "run.json": _JSON,
            "checkpoint.json": _JSON,
            "metrics.jsonl": damaged,
            "experience/*.npz": _ARRAYS,
            "trees/*.json": _JSON,
        },
        _use_run,
        0.7,
    ),
    "smrf-q": Format(
        _learned_run(SUM),
        {"checkpoint.json": _JSON, "metrics.jsonl": damaged, "experience/*.npz": _ARRAYS},
        lambda folder: _use_fitted(SUM, folder),
        0.7,
    ),
    "smrf-q, forests": Format(
        _learned_run(HORIZON),
        {"checkpoint.json": _JSON, "experience/*.npz": _ARRAYS, "forests/*.npz": _ARRAYS},
        lambda folder: _use_fitted(HORIZON, folder),
        0.7,
    ),
    "vectors": Format(
        _learned_run(VECTORS),
        {"checkpoint.json": _JSON, "values/*.npz": _ARRAYS},
        _use_vectors,
        0.7,
    ),
    "sarsa": Format(
        _sarsa,
        {"checkpoint.json": _JSON, "model-*/sarsa.json": _JSON, "model-*/*.npz": _ARRAYS},
        _use_sarsa,
    ),
    "study": Format(
        lambda folder: run_study(STUDY, folder),
        {"study.json": _JSON, "settings/*.json": _JSON},
        lambda folder: run_study(STUDY, folder),
        0.7,
    ),
}
