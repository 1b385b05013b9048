"""A model as a Python module that needs nothing but the standard library."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

from relforest.sharing.measures import Notation, Written, letter
from relforest.sharing.program import Branch, Program, Rule, Step
from relforest.sharing.rule_text import (
    about,
    answers,
    arguments,
    by_depth,
    data_columns,
    steps_along_no,
    told,
    written_measures,
)

_NOTATION: Final = Notation(
    column=lambda variable, column: f"{variable}[{column}]",
    sqrt="sqrt({})",
    absolute="abs({})",
    atan2="atan2({}, {})",
    where="({1} if {0} > 0.0 else nan)",
    undefined="isnan({})",
)

_HELPERS: Final = '''

def wrapped(angle):
    """Return an angle moved into [-pi, pi]."""
    return angle if isnan(angle) else angle - 2.0 * pi * round(angle / (2.0 * pi))


def differs(x, y):
    """Return 1 where two numbers differ, else 0."""
    return nan if isnan(x) or isnan(y) else float(x != y)


def others(objects, *bound):
    """Return the objects that are not bound yet."""
    return [each for each in objects if not any(each is one for one in bound)]


def others_or_none(objects, *bound):
    """Return the objects that are not bound yet, or no object if there are none."""
    return others(objects, *bound) or [NO_OBJECT]


def read(row):
    """Return the attributes of an object as numbers, nan = undefined."""
    values = []
    for name, kind, categories in COLUMNS:
        value = row.get(name)
        if value is None or value != value:
            values.append(nan)
        elif kind == "category":
            if value not in categories:
                raise ValueError(f"{name} is {value!r}, which is none of {', '.join(categories)}")
            values.append(float(categories.index(value)))
        else:
            number = float(value)
            turned = number - 2.0 * pi * ceil((number - pi) / (2.0 * pi)) if kind == "angle" else number
            values.append(number if kind != "angle" or -pi < number <= pi else turned)
    return values


def predict(rows):
    """Return what the model predicts for one scene.

    `rows` are dictionaries, one per object, with the columns of the table that the model was learned from.
    """
    there = [row for row in rows if OBJECT is None or row.get(OBJECT) is not None]
    objects = [read(row) for row in there]
    bound = []
    for name in ARGUMENTS:
        key = rows[0].get(name)
        found = [item for row, item in zip(there, objects) if key is not None and row[OBJECT] == key]
        if key is not None and not found:
            raise ValueError(f"{name} is {key!r}, which is no object of the scene")
        bound.append(found[0] if found else NO_OBJECT)
    scores = list(START)
    for tree, values in zip(TREES, VALUES):
        added = values[tree(objects, *bound)]
        scores = [score + more for score, more in zip(scores, added)]
    return answer(scores)
'''

_NUMBER: Final = '''

def answer(scores):
    """Return the prediction."""
    return {"prediction": scores[0]}
'''

_TWO: Final = '''

def answer(scores):
    """Return the probability of the second class, and the class."""
    p = {share}
    return {{"probability": p, "predicted": CLASSES[int(p >= {threshold!r})]}}
'''

_SEVERAL: Final = '''

def answer(scores):
    """Return the most probable class, and the probability of each."""
    {shares}
    total = {total}
    shares = [each / total if total > 0.0 else 1.0 / len(shares) for each in shares]
    predicted = CLASSES[shares.index(max(shares))]
    return {{"predicted": predicted}} | {{f"probability_{{name}}": p for name, p in zip(CLASSES, shares)}}
'''


def python_code(program: Program) -> str:
    """Return a module with a function ``predict(rows)``.

    `rows` is a list of dictionaries, the rows of one scene in the table that the model is for. The result has
    the keys ``prediction``, or ``probability`` and ``predicted``, or for more than two classes ``predicted``
    and ``probability_...``, as the columns that ``relforest predict`` writes.

    Raises
    ------
    InputError
        If the questions have too many dimensions.
    """
    written = written_measures(program, _NOTATION)
    lines = [
        '"""' + "\n".join([*about(program), '"""']).replace("\\", "\\\\").replace('"""', '"')[:-1] + '"""'
    ]
    lines += ["", "from math import atan2, ceil, exp, isnan, nan, pi, sqrt", ""]
    attributes = [attribute for attribute in program.schema.attributes for _ in range(attribute.dim)]
    columns = [
        (name, attribute.kind, attribute.categories)
        for name, attribute in zip(data_columns(program), attributes, strict=True)
    ]
    lines += [f"OBJECT = {program.layout.object!r}", f"ARGUMENTS = {program.layout.arguments!r}"]
    lines += ["COLUMNS = (", *(f"    {column!r}," for column in columns), ")"]
    lines += [f"NO_OBJECT = (nan,) * {program.schema.width}", f"CLASSES = {program.classes!r}"]
    lines.append(_HELPERS)
    for number, measure in enumerate(written):
        names = ", ".join(letter(each) for each in program.measures[number].variables)
        lines += ["", f"def measure_{number}({names}):"]
        lines += [f"    {name} = {expression}" for name, expression in measure.names]
        lines += [f"    return {measure.value}", ""]
    for number, step in enumerate(program.trees):
        lines += ["", f"def tree_{number}({', '.join(['objects', *arguments(program)])}):"]
        lines += [*_block(program, written, step, "    "), ""]
    lines.append(f"\nTREES = ({''.join(f'tree_{number}, ' for number in range(len(program.trees)))})")
    lines += [f"START = {program.start.tolist()}", "VALUES = ("]
    lines += [*(f"    {values.tolist()}," for values in program.values), ")"]
    return "\n".join([*lines, *_answer(program).splitlines()]) + "\n"


def _block(program: Program, written: list[Written], first: Step, indent: str) -> Iterator[str]:
    for step in steps_along_no(first):
        if not isinstance(step, Branch):
            yield f"{indent}return {step}"
            continue
        yield from (f"{indent}# {line}" for line in told(program, step))
        if step.no is None:
            yield from _block(program, written, step.yes, indent)
            continue
        yield f"{indent}if {_condition(program, written, step.rule, indent)}:"
        yield from _block(program, written, step.yes, f"{indent}    ")


def _condition(program: Program, written: list[Written], rule: Rule, indent: str) -> str:
    known = [
        " and ".join(answers(program, written, _NOTATION, asked, "measure_{}"))
        for asked in by_depth(program, rule)
    ]
    bound, loops = ["objects", *arguments(program)], []
    among = "others_or_none" if rule.or_none else "others"
    for number, test in enumerate(known[1:]):
        name = letter(program.schema.n_parameters + number)
        loops.append(f"for {name} in {among}({', '.join(bound)})" + (f" if {test}" if test else ""))
        bound.append(name)
    if rule.every:
        first, second = (loop.partition(" if ") for loop in loops)
        tests = " and ".join(test for test in (known[0], first[2], second[2]) if test)
        inner = f"any(True {second[0]} if {tests})"
        return f"{among}({', '.join(bound[:-2])}) and all({inner} {first[0]})"
    joined = f"\n{indent}        ".join(["", *loops, ""]).rstrip() + f"\n{indent}    "
    exists = f"any(True{joined})" if rule.at_least == 1 else f"sum(1{joined}) >= {rule.at_least}"
    return " and ".join([*([known[0]] if known[0] else []), *([exists] if loops else [])]) or "True"


def _answer(program: Program) -> str:
    if program.link == "number":
        return _NUMBER
    if len(program.classes) == 2:
        share = "min(max(scores[0], 0.0), 1.0)"
        if program.link == "logistic":
            share = "1.0 / (1.0 + exp(-scores[0])) if scores[0] > -700.0 else 0.0"
        return _TWO.format(share=share, threshold=program.threshold)
    shares, total = "shares = [max(score, 0.0) for score in scores]", "sum(shares)"
    if program.link == "shares":
        total = "1.0"
    if program.link == "logistic":
        shares = "shares = [exp(score - max(scores)) for score in scores]"
    return _SEVERAL.format(shares=shares, total=total)
