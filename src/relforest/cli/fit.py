"""``relforest fit``: a model from a table."""

# Heavy imports wait until the command runs, so that --help answers at once.
# ruff: noqa: PLC0415

from __future__ import annotations

from dataclasses import dataclass, field, fields, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Final, Literal, final

from tyro.conf import OmitArgPrefixes, Positional, UseAppendAction, arg

from relforest.cli.csv_options import CsvOptions
from relforest.cli.outputs import check_free
from relforest.cli.progress import note, working
from relforest.support.errors import InputError

if TYPE_CHECKING:
    from relforest.models import TrainingData
    from relforest.models.conversion import SceneLearner
    from relforest.scenes.scene_stream import SceneColumns

_OF_TREES: Final = ("test", "search", "alpha", "attempts", "permutations", "max_points")
_MODELS: Final = ("tree", "boosting", "forest", "smrf-forest", "rules", "outcome")
# Options of some models only, and these models.
_OPTIONS: Final = dict.fromkeys(_OF_TREES, ("tree", "smrf-forest")) | {
    "trees": _MODELS[1:],
    "objects": ("boosting", "forest", "rules", "outcome"),
}
_REMEDY: Final = "name its columns, such as --scene pass --object player --attribute location=x,y"


@final
@dataclass(frozen=True, slots=True)
class FitOptions:
    r"""Learn a model from a table of labelled scenes, print it in words, and write it to a model file.

    The table is long: one row per object, with columns for the ids of the scene and of the object. The label
    is a column too, with one value per scene: a class, or a number to predict. Of two classes, the model
    describes what exists in scenes of the positive one, which is the label that sorts last unless --positive
    names the other one. Empty cells are undefined attributes. Ids are kept as written: 007 and 7 are
    different.

    For example:
      relforest fit passes.parquet --scene pass --object player \
          --attribute location=x,y --attribute orientation=theta:angle \
          --arguments passer,receiver --label completed --out tree.json
      relforest fit scenes.parquet --label completed --out tree.json
      relforest fit scenes.parquet --label speed --model boosting --out speed.json

    The second form is for files written by Scenes.to_parquet, with a label column added.

    Parameters
    ----------
    table
        Parquet or CSV file, or a folder of Parquet files. A CSV file may be compressed (.csv.gz).
    label
        Column of what is to be predicted: words, booleans or numbers.
    target
        Whether the label is a class or a number. By default, numbers are predicted if some are not whole or
        if there are more than 10 different ones.
    model
        What to learn: a tree with tests of significance; boosting, a sum of small trees, the most accurate
        on hundreds of scenes; a forest, the mean of larger trees; a forest of trees with tests of
        significance (smrf-forest), half of them for the other one of two classes; rules, of which one must
        hold, for two classes: the shortest description, and the most accurate on a few dozen scenes; or
        outcome, for two classes: boosting and a forest, weighed such that both classes count alike however
        rare one is, also among more objects.
    positive
        The one of two labels that the model explains, written as in the table; for example False to find the
        causes of failures.
    out
        Model file to write (JSON). Besides what was learned it stores the names of the columns and, for the
        drawings of trees by relforest show, up to 150 training points of each class per question.
    scene
        Column of scene ids.
    object
        Column of object ids. By default, objects are numbered within their scene.
    attribute
        An attribute of the objects and its columns, one per component. Append ":angle" for an angle in
        radians; this is the default for the name "orientation". Append ":category" for names, such as a team,
        or ":location" for where objects are if the name is not "location".
    arguments
        Columns with the id of the object bound to each argument of the action, the same in all rows of a
        scene.
    relation
        A relation between objects, named by a verb, and its column, which contains for each object the ids of
        those that it is related to, in text separated by ";": "touches=contacts". Append ":directed" if it
        matters which object is named first. Models of boosting, forests and rules ask about relations.
    csv
        How a CSV file is written.
    trees
        Trees of boosting or a forest (100 by default), of the boosted model that proposes rules (200), or of
        each model that is weighed for an outcome (100).
    objects
        Most objects that a question of these models asks for besides the arguments: 0, 1 or 2. The default is
        1 for scenes with arguments, 2 for others.
    test
        Significance test for the questions of a tree, to which the following options belong as well. The
        likelihood ratio test is fast, but accepts questions on noise more often than alpha; the permutation
        test keeps its level and takes longer.
    search
        How the best question is found: the exhaustive search tries all possible questions on all scenes; the
        screened search tries them on a few scenes and then the best on all, which is about ten times faster.
    alpha
        Significance level.
    attempts
        Tries for each possible question (in the screened search for the best of them).
    permutations
        Shuffles of the permutation test.
    max_points
        Of questions with more instantiation sequences than this, the screened search sees a sample; the
        exhaustive search skips them. Their number is reported.
    seed
        The same seed gives the same model.
    jobs
        Threads for predictions and forests, -1 = one per core; the result does not depend on it.
    force
        Replace the model file if it exists.
    """

    table: Annotated[Positional[Path], arg(metavar="TABLE")]
    label: Annotated[str, arg(metavar="COLUMN")]
    out: Annotated[Path, arg(metavar="FILE")]
    scene: Annotated[str | None, arg(metavar="COLUMN", help_behavior_hint="")] = None
    object: Annotated[str | None, arg(metavar="COLUMN", help_behavior_hint="")] = None
    attribute: Annotated[UseAppendAction[tuple[str, ...]], arg(metavar="NAME=COLUMN[,COLUMN...]")] = ()
    arguments: Annotated[str, arg(metavar="COLUMN[,COLUMN...]", help_behavior_hint="")] = ""
    relation: Annotated[UseAppendAction[tuple[str, ...]], arg(metavar="NAME=COLUMN")] = ()
    csv: OmitArgPrefixes[CsvOptions] = field(default_factory=CsvOptions)
    target: Literal["auto", "classes", "numbers"] = "auto"
    positive: Annotated[str | None, arg(metavar="LABEL", help_behavior_hint="")] = None
    model: Literal["tree", "boosting", "forest", "smrf-forest", "rules", "outcome"] = "tree"
    trees: Annotated[int | None, arg(metavar="N", help_behavior_hint="")] = None
    objects: Annotated[int | None, arg(metavar="N", help_behavior_hint="")] = None
    test: Literal["likelihood-ratio", "permutation"] = "likelihood-ratio"
    search: Literal["screened", "exhaustive"] = "screened"
    alpha: float = 0.05
    attempts: int = 3
    permutations: int = 99
    max_points: int = 100_000
    seed: int = 0
    jobs: int = 1
    force: bool = False


def fit(options: FitOptions) -> int:
    """Learn a model with the given options; the exit code is 0."""
    from relforest.models import as_model, read_training_data, write_model

    check_free(options.out, force=options.force)
    data = read_training_data(
        options.table,
        options.label,
        target=options.target,
        positive=options.positive,
        dialect=options.csv.dialect,
        remedy=_REMEDY,
        **_columns(options),
    )
    learner = _learner(options, data)
    with working(f"learning from {len(data.scenes)} scenes"):
        learner.fit(data.scenes, data.y)
    model = as_model(learner, data)
    print(f"{model.text}\n")
    _report(data, learner, model.outcome)
    write_model(options.out, model)
    _comment(options, len(data.scenes), learner)
    return 0


def _learner(options: FitOptions, data: TrainingData) -> SceneLearner:
    """Return the estimator to fit.

    Raises
    ------
    InputError
        If an option belongs to another model, or the model is for other labels.
    """
    import relforest
    from relforest.forests import GrowthSettings
    from relforest.forests.forest_estimators import FOREST_GROWTH
    from relforest.forests.outcome_estimator import OUTCOME_GROWTH
    from relforest.forests.rule_set_estimator import RULE_GROWTH
    from relforest.trees import TreeSettings

    for entry in fields(options):
        models = _OPTIONS.get(entry.name, _MODELS)
        if options.model not in models and getattr(options, entry.name) != entry.default:
            name = entry.name.replace("_", "-")
            raise InputError(f"--{name} is an option of --model {', '.join(models)}, not of {options.model}")
    if options.model in {"rules", "outcome"} and (data.classes is None or len(data.classes) > 2):
        found = "numbers" if data.classes is None else f"{len(data.classes)} classes"
        raise InputError(
            f"--model {options.model} is for two classes, but column {data.label!r} holds {found}: "
            "use --model boosting"
        )
    chosen: dict[str, Any] = {name: getattr(options, name) for name in _OF_TREES}
    if options.model != "tree":
        conditions = {
            "boosting": GrowthSettings(),
            "forest": FOREST_GROWTH,
            "rules": RULE_GROWTH,
            "outcome": OUTCOME_GROWTH,
        }
        if options.model == "smrf-forest":
            chosen = {"growth": TreeSettings(**chosen)}
        else:
            chosen = {"growth": replace(conditions[options.model], max_free=options.objects)}
        if options.trees is not None:
            chosen["n_trees"] = options.trees
    names = {
        "tree": "SMRFTree",
        "boosting": "SMRFBoosting",
        "rules": "SMRFRuleSet",
        "outcome": "OutcomeForest",
    }
    task = "Regressor" if data.classes is None else "Classifier"
    learner: SceneLearner = getattr(relforest, f"{names.get(options.model, 'SMRFForest')}{task}")(
        **chosen, random_state=options.seed, n_jobs=options.jobs
    )
    return learner


def _columns(options: FitOptions) -> SceneColumns:
    from relforest.cli.columns import parse_attributes, parse_names, parse_relations

    attributes, arguments = parse_attributes(options.attribute), parse_names(options.arguments)
    relations = parse_relations(options.relation)
    if options.scene is None and options.object is None and not (attributes or arguments or relations):
        return {}
    if options.scene is None or not attributes:
        missing = "--scene COLUMN" if options.scene is None else "--attribute NAME=COLUMN,..."
        raise InputError(f"{missing} is missing: it is required if any column is named")
    return {
        "scene": options.scene,
        "object": options.object,
        "attributes": attributes,
        "arguments": arguments,
        "relations": relations,
    }


def _report(data: TrainingData, learner: SceneLearner, outcome: str) -> None:
    """Print what the numbers of a model are of, and how well it predicts."""
    import numpy as np
    from sklearn.metrics import r2_score

    from relforest.metrics import peirce_skill_score

    predicted = learner.predict(data.scenes)
    if data.classes is None:
        low, mean, high = data.y.min(), data.y.mean(), data.y.max()
        found = f"{low:.4g} to {high:.4g} with mean {mean:.4g}"
        print(f"predictions are of {outcome}, {found} in {len(data.y)} scenes")
        name, score = "R2", float(r2_score(data.y, predicted))
    elif len(data.classes) == 2:
        print(f"probabilities are of {outcome}, which {data.y.sum()} of {len(data.y)} scenes have")
        name, score = "Peirce skill score", peirce_skill_score(data.y, predicted)
    else:
        counts = ", ".join(map(str, np.bincount(data.y)))
        print(f"probabilities are of {outcome}, which {counts} of {len(data.y)} scenes have")
        name, score = "accuracy", float((predicted == data.y).mean())
    print(f"{name} on the training scenes: {score:.3f}")
    unseen = getattr(learner, "oob_score_", None)
    if unseen is not None:
        name = "R2" if data.classes is None else "accuracy"
        print(f"{name} on them by the trees that did not see them: {unseen:.3f}")


def _comment(options: FitOptions, n_scenes: int, learner: SceneLearner) -> None:
    """Tell what the search could not do, and where the model is."""
    from relforest.trees import SMRFTreeClassifier, SMRFTreeRegressor

    if isinstance(learner, SMRFTreeClassifier | SMRFTreeRegressor):
        if learner.tree_.is_stub:
            note(
                f"no question was significant at alpha = {options.alpha:g} on {n_scenes} scenes, so the tree "
                "is a single leaf"
            )
        _comment_search(options, learner.n_sampled_, learner.n_left_out_)
    elif options.model == "smrf-forest":
        _comment_search(options, learner.n_sampled_, getattr(learner, "n_left_out_", 0), "of a tree ")
    elif learner.n_sampled_:
        note(
            f"in {learner.n_sampled_} scenes a sample of the possible pairs of objects was searched, because "
            "there are too many"
        )
    note(f"wrote {options.out}")


def _comment_search(options: FitOptions, n_sampled: int, n_left_out: int, of: str = "") -> None:
    if n_sampled:
        note(
            f"{n_sampled} possible questions {of}were searched by a sample, because each has more than "
            f"{options.max_points} instantiation sequences"
        )
    if n_left_out:
        much = "" if options.search == "exhaustive" else "100 times "
        note(
            f"{n_left_out} possible questions {of}were skipped because each has more than "
            f"{much}{options.max_points} instantiation sequences: raise --max-points to include them"
        )
