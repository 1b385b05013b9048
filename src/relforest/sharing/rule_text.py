"""What the printers of rules share: which objects an answer is about, and what is said about a rule."""

from __future__ import annotations

from collections.abc import Iterator

from relforest.sharing.measures import Notation, Written, letter, write_answer, write_measure
from relforest.sharing.program import Asked, Branch, Program, Rule, Step
from relforest.support.errors import InputError
from relforest.trees.nodes import variable_name

_LONGEST = 4_000_000


def written_measures(program: Program, notation: Notation) -> list[Written]:
    """Write all measures of a program.

    Raises
    ------
    InputError
        If the text is too long, which happens if volumes have hundreds of dimensions.
    """
    found = [write_measure(measure, program.schema, notation) for measure in program.measures]
    if sum(len(each.value) for each in found) > _LONGEST:
        raise InputError(
            "the questions of the model have too many dimensions to be shared: fit it with fewer columns"
        )
    return found


def arguments(program: Program) -> list[str]:
    """Return the variables of the arguments in code."""
    return [letter(number) for number in range(program.schema.n_parameters)]


def by_depth(program: Program, rule: Rule) -> list[list[Asked]]:
    """Return the answers of a rule by how many free objects must be bound to know them, 0 to `n_free`."""
    found: list[list[Asked]] = [[] for _ in range(rule.n_free + 1)]
    for asked in rule.asked:
        last = max(program.measures[asked.measure].variables)
        found[max(last - program.schema.n_parameters + 1, 0)].append(asked)
    return found


def answers(
    program: Program, written: list[Written], notation: Notation, asked: list[Asked], call: str
) -> Iterator[str]:
    """Write answers; `call` is filled with the number of a measure."""
    for each in asked:
        names = ", ".join(letter(variable) for variable in program.measures[each.measure].variables)
        value = f"{call.format(each.measure)}({names})"
        yield write_answer(each, value, written[each.measure], notation)


def told(program: Program, branch: Branch) -> list[str]:
    """Return what a branch means, line by line."""
    lines = [branch.rule.said] if branch.rule.said else []
    lines += [f"{asked.said} -> {asked.answer}" for asked in branch.rule.asked if asked.said]
    if program.says and isinstance(branch.yes, int):
        lines.insert(0, f"{program.says[branch.yes]}{' if' if lines else ''}")
    return [" ".join(line.split()) for line in lines]


def about(program: Program) -> list[str]:
    """Return what a program is, line by line: what it predicts, from which arguments and columns."""
    schema, layout = program.schema, program.layout
    read = [layout.scene, *([layout.object] if layout.object else []), *layout.arguments]
    named = (f"{variable_name(i)} is the {name}" for i, name in enumerate(schema.parameters))
    what = {"number": "Predicts", "logistic": "Probabilities of"}.get(program.link, "Probability of")
    lines = [f"{what} {program.outcome}, learned by relforest."]
    if schema.parameters:
        lines.append(f"{', '.join(named)}.")
    lines.append(f"Columns: {', '.join(map(repr, [*read, *data_columns(program)]))}.")
    return [" ".join(line.split()) for line in lines]


def data_columns(program: Program) -> list[str]:
    """Return the columns of the table that hold the attributes, in the order of the schema."""
    return [name for _, names in program.layout.attributes for name in names]


def steps_along_no(step: Step | None) -> Iterator[Step]:
    """Yield a step, what follows if its rule does not hold, and so on."""
    while step is not None:
        yield step
        step = step.no if isinstance(step, Branch) else None
