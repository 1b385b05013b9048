"""``relforest fit``: a model from a table."""

# Heavy imports wait until the command runs, so that --help answers at once.
# ruff: noqa: PLC0415

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Final, Literal, cast, final

from tyro.conf import Positional, UseAppendAction, arg

from relforest.cli.outputs import check_free
from relforest.cli.progress import note, working
from relforest.support.errors import InputError

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from relforest.cli.columns import Columns, SceneTable
    from relforest.cli.model_file import Label
    from relforest.forests import SMRFBoostingClassifier, SMRFForestClassifier, SMRFRuleSetClassifier
    from relforest.trees import SMRFTreeClassifier

    Learner = SMRFTreeClassifier | SMRFBoostingClassifier | SMRFForestClassifier | SMRFRuleSetClassifier

_OF_TREES: Final = ("test", "search", "alpha", "attempts", "permutations", "max_points")
_MODELS: Final = ("tree", "boosting", "forest", "smrf-forest", "rules")
# Options of some kinds of models only, and these kinds.
_OPTIONS: Final = dict.fromkeys(_OF_TREES, ("tree", "smrf-forest")) | {
    "trees": _MODELS[1:],
    "objects": ("boosting", "forest", "rules"),
}
_REMEDY: Final = "name its columns, such as --scene pass --object player --attribute location=x,y"


@final
@dataclass(frozen=True, slots=True)
class FitOptions:
    r"""Learn a model from a table of labelled scenes, print it in words, and write it to a model file.

    The table is long: one row per object, with columns for the ids of the scene and of the object. The label
    is a column too, with one value per scene: booleans, 0 and 1, -1 and +1, or two strings. The model
    describes what exists in scenes of the positive class, which is the label that sorts last unless
    --positive names the other one. Empty cells are undefined attributes. Ids are kept as written: 007 and 7
    are different.

    For example:
      relforest fit passes.parquet --scene pass --object player \
          --attribute location=x,y --attribute orientation=theta:angle \
          --arguments passer,receiver --label completed --out tree.json
      relforest fit scenes.parquet --label completed --out tree.json
      relforest fit scenes.parquet --label completed --model rules --out rules.json

    The second form is for files written by Scenes.to_parquet, with a label column added.

    Parameters
    ----------
    table
        Parquet or CSV file, or a folder of Parquet files. A CSV file may be compressed (.csv.gz).
    label
        Column of labels.
    model
        What to learn: a tree with tests of significance; boosting, a sum of small trees, the most accurate
        on hundreds of scenes; a forest, the mean of larger trees; a forest of trees with tests of
        significance (smrf-forest), half of them for the other class; or rules, of which one must hold: the
        shortest description, and the most accurate on a few dozen scenes.
    positive
        The label that the model explains, written as in the table; for example False to find the causes of
        failures.
    out
        Model file to write (JSON). Besides what was learned it stores the names of the columns and, for the
        drawings of trees by relforest show, up to 150 training points of each class per question.
    scene
        Column of scene ids.
    object
        Column of object ids. By default, objects are numbered within their scene.
    attribute
        An attribute of the objects and its columns, one per component. Append ":angle" for an angle in
        radians; this is the default for the name "orientation". Append ":category" for names, such as a team.
    arguments
        Columns with the id of the object bound to each argument of the action, the same in all rows of a
        scene.
    separator
        Field separator of a CSV file: one character or "tab". Detected by default.
    decimal
        Decimal mark of a CSV file: "." or ",". Detected by default where only one is possible.
    encoding
        Encoding of a CSV file, such as latin-1. The default is UTF-8, or UTF-16 where detected.
    trees
        Trees of boosting or a forest (100 by default), or of the boosted model that proposes rules (200).
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
    separator: Annotated[str | None, arg(metavar="CHARACTER", help_behavior_hint="")] = None
    decimal: Annotated[str | None, arg(metavar="CHARACTER", help_behavior_hint="")] = None
    encoding: Annotated[str | None, arg(metavar="NAME", help_behavior_hint="")] = None
    positive: Annotated[str | None, arg(metavar="LABEL", help_behavior_hint="")] = None
    model: Literal["tree", "boosting", "forest", "smrf-forest", "rules"] = "tree"
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
    from relforest.cli.columns import read_labels, read_scenes
    from relforest.cli.model_file import Model, write_model
    from relforest.metrics import peirce_skill_score
    from relforest.reports import question_points
    from relforest.scenes.dialect import Dialect
    from relforest.support.options import at_least
    from relforest.support.parallel import checked_jobs
    from relforest.trees import SMRFTreeClassifier

    at_least("seed", options.seed, 0)
    checked_jobs(options.jobs)
    check_free(options.out, force=options.force)
    dialect = Dialect(options.separator, options.decimal, options.encoding)
    source = read_scenes(
        options.table, _columns(options), remedy=_REMEDY, label=options.label, dialect=dialect
    )
    labels = read_labels(source, options.label)
    classes = _classes(labels, options)
    positive = labels == classes[1]
    learner = _learner(options)
    with working(f"learning from {len(source.scenes)} scenes"):
        learner.fit(source.scenes, positive)
    points = {}
    if isinstance(learner, SMRFTreeClassifier):
        points = question_points(learner.tree_, source.scenes, positive)
    learned = learner.tree_ if isinstance(learner, SMRFTreeClassifier) else learner.ensemble_
    kind = "forest" if options.model == "smrf-forest" else options.model
    model = Model(learned, kind, options.label, classes, source.columns, points)
    score = peirce_skill_score(positive, learner.predict(source.scenes))
    print(model.text)
    print()
    print(f"probabilities are of {model.positive}, which {positive.sum()} of {len(labels)} scenes have")
    print(f"Peirce skill score on the training scenes: {score:.3f}")
    write_model(options.out, model)
    _comment(options, source, learner)
    return 0


def _learner(options: FitOptions) -> Learner:
    """Return the estimator to fit.

    Raises
    ------
    InputError
        If an option belongs to another kind of model.
    """
    from relforest import SMRFBoostingClassifier, SMRFForestClassifier, SMRFRuleSetClassifier
    from relforest.forests import GrowthSettings
    from relforest.forests.forest_estimators import FOREST_GROWTH
    from relforest.forests.rule_set_estimator import RULE_GROWTH
    from relforest.trees import SMRFTreeClassifier, TreeSettings

    for field in fields(options):
        kinds = _OPTIONS.get(field.name, _MODELS)
        if options.model not in kinds and getattr(options, field.name) != field.default:
            name = field.name.replace("_", "-")
            raise InputError(f"--{name} is an option of --model {', '.join(kinds)}, not of {options.model}")
    seed, jobs = options.seed, options.jobs
    chosen = {name: getattr(options, name) for name in _OF_TREES}
    if options.model == "tree":
        return SMRFTreeClassifier(**chosen, random_state=seed, n_jobs=jobs)
    if options.model == "smrf-forest":
        trees = TreeSettings(**chosen)
        n_trees = options.trees or 100
        return SMRFForestClassifier(n_trees=n_trees, growth=trees, random_state=seed, n_jobs=jobs)
    defaults = {"boosting": GrowthSettings(), "forest": FOREST_GROWTH, "rules": RULE_GROWTH}
    growth = replace(defaults[options.model], max_free=options.objects)
    if options.model == "forest":
        n_trees = options.trees or 100
        return SMRFForestClassifier(n_trees=n_trees, growth=growth, random_state=seed, n_jobs=jobs)
    if options.model == "rules":
        n_trees = options.trees or 200
        return SMRFRuleSetClassifier(n_trees=n_trees, growth=growth, random_state=seed, n_jobs=jobs)
    n_trees = options.trees or 100
    return SMRFBoostingClassifier(n_trees=n_trees, growth=growth, random_state=seed, n_jobs=jobs)


def _classes(labels: NDArray[Any], options: FitOptions) -> tuple[Label, Label]:
    """Return the negative and the positive class."""
    from relforest.scenes.labels import binary_labels

    first, second = binary_labels(labels, len(labels), what="scenes").classes.tolist()
    if options.positive is None or _is_meant(options.positive, second):
        return first, second
    if _is_meant(options.positive, first):
        return second, first
    raise InputError(
        f"--positive {options.positive} is not a label in column {options.label!r}: use {first} or {second}"
    )


def _is_meant(text: str, label: Label) -> bool:
    """Return whether a text is how a label is written, in messages or in a table."""
    from relforest.scenes.label_text import parsed_label

    written = parsed_label(text)
    return text == str(label) or (written == label and isinstance(written, bool) == isinstance(label, bool))


def _columns(options: FitOptions) -> Columns | None:
    from relforest.cli.columns import Columns, parse_attributes, parse_names

    attributes, arguments = parse_attributes(options.attribute), parse_names(options.arguments)
    if options.scene is None and options.object is None and not attributes and not arguments:
        return None
    if options.scene is None or not attributes:
        missing = "--scene COLUMN" if options.scene is None else "--attribute NAME=COLUMN,..."
        raise InputError(f"{missing} is missing: it is required if any column is named")
    return Columns(options.scene, options.object, attributes, arguments)


def _comment(options: FitOptions, source: SceneTable, learner: Learner) -> None:
    if options.model == "tree":
        _comment_tree(options, source, cast("SMRFTreeClassifier", learner))
    elif options.model == "smrf-forest":
        _comment_search(options, cast("SMRFForestClassifier", learner), "of a tree ")
    elif learner.n_sampled_:
        note(
            f"in {learner.n_sampled_} scenes a sample of the possible pairs of objects was searched, because "
            "there are too many"
        )
    note(f"wrote {options.out}")


def _comment_tree(options: FitOptions, source: SceneTable, classifier: SMRFTreeClassifier) -> None:
    if classifier.tree_.is_stub:
        note(
            f"no question was significant at alpha = {options.alpha:g} on {len(source.scenes)} scenes, so "
            "the tree is a single leaf"
        )
    _comment_search(options, classifier)


def _comment_search(
    options: FitOptions, learner: SMRFTreeClassifier | SMRFForestClassifier, of: str = ""
) -> None:
    if learner.n_sampled_:
        note(
            f"{learner.n_sampled_} possible questions {of}were searched by a sample, because each has more "
            f"than {options.max_points} instantiation sequences"
        )
    if learner.n_left_out_:
        much = "" if options.search == "exhaustive" else "100 times "
        note(
            f"{learner.n_left_out_} possible questions {of}were skipped because each has more than "
            f"{much}{options.max_points} instantiation sequences: raise --max-points to include them"
        )
