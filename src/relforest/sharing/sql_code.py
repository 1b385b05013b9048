"""A model as SQL for DuckDB: that objects exist is EXISTS."""

# Writing queries is the purpose of this module, and names and texts are quoted.
# ruff: noqa: S608

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

from relforest.models.model import Label
from relforest.sharing.measures import Notation, Written, columns_of, letter, write_answer
from relforest.sharing.program import Asked, Branch, Measure, Program, Rule, Step
from relforest.sharing.rule_text import (
    about,
    arguments,
    by_depth,
    data_columns,
    steps_along_no,
    told,
    written_measures,
)
from relforest.support.errors import InputError

# Without the exponent, numbers would be decimals, which round differently.
_NOTATION: Final = Notation(
    column=lambda variable, column: f"{variable}_c{column}",
    sqrt="sqrt({})",
    absolute="abs({})",
    atan2="atan2({}, {})",
    where="CASE WHEN {0} > 0 THEN {1} END",
    undefined="{} IS NULL",
    number="{}e0",
    keeps_names=False,
)
_PI: Final = "3.141592653589793e0"
_HELPERS: Final = f"""CREATE OR REPLACE TEMP MACRO wrapped(angle) AS
    angle - 2e0 * {_PI} * round_even(angle / (2e0 * {_PI}), 0);
CREATE OR REPLACE TEMP MACRO differs(x, y) AS
    CASE WHEN x = y THEN 0e0 WHEN x <> y THEN 1e0 END;
CREATE OR REPLACE TEMP MACRO turned(angle) AS
    CASE WHEN angle > -{_PI} AND angle <= {_PI} THEN angle
    ELSE angle - 2e0 * {_PI} * ceil((angle - {_PI}) / (2e0 * {_PI})) END;
CREATE OR REPLACE TEMP MACRO defined(x) AS CASE WHEN isnan(x::DOUBLE) THEN NULL ELSE x::DOUBLE END;"""


def sql_code(program: Program, table: str = "objects") -> str:
    """Return a script for DuckDB whose last statement selects a row of predictions for each scene.

    Parameters
    ----------
    program : Program
    table : str
        The name of a table or view with the columns that the model was learned from.

    Raises
    ------
    InputError
        If the questions have too many dimensions, or the table has arguments but no column of objects.
    """
    written, layout = written_measures(program, _NOTATION), program.layout
    if layout.object is None and layout.arguments:
        raise InputError(
            "the arguments of scenes are ids of objects: fit the model with --object to write SQL"
        )
    lines = [f"-- {line}" for line in about(program)]
    lines += [f"-- CREATE VIEW {_name(table)} AS FROM 'table.parquet';", _HELPERS]
    for number, (measure, text) in enumerate(zip(program.measures, written, strict=True)):
        columns = [f"{name}_c{at}" for name, at in columns_of(measure, program.schema)]
        lines.append(
            f"CREATE OR REPLACE TEMP MACRO measure_{number}({', '.join(columns)}) AS\n    {text.value};"
        )
    lines += [f"WITH {','.join(_data(program, table))}", _answered(program, written), *_scored(program)]
    return "\n".join(lines) + "\n"


def _data(program: Program, table: str) -> Iterator[str]:
    """Write the scenes, with how many objects are free, and all objects, with one that stands for none."""
    layout, width = program.layout, program.schema.width
    scene, key = _name(layout.scene), "NULL" if layout.object is None else _name(layout.object)
    given = [f"any_value({_name(name)})" for name in layout.arguments]
    bound = "".join(f", {value} AS {name}_key" for name, value in zip(arguments(program), given, strict=True))
    free = "count(*)" if layout.object is None else f"count({key})"
    free += f" - len(list_distinct([{', '.join(given)}]))" if given else ""
    yield f"""
scene AS MATERIALIZED (
    SELECT {scene} AS scene, {free} AS free{bound} FROM {_name(table)} GROUP BY ALL
)"""
    columns = "".join(f",\n        {text} AS c{at}" for at, text in enumerate(_columns(program)))
    there = "" if layout.object is None else f"\n    WHERE {key} IS NOT NULL"
    nothing = "".join(f", NULL AS c{at}" for at in range(width))
    yield f"""
object AS MATERIALIZED (
    SELECT {scene} AS scene, {key} AS id, row_number() OVER () AS place{columns}
    FROM {_name(table)}{there}
    UNION ALL SELECT scene, NULL AS id, -1 AS place{nothing} FROM scene
)"""


def _columns(program: Program) -> Iterator[str]:
    attributes = [attribute for attribute in program.schema.attributes for _ in range(attribute.dim)]
    for name, attribute in zip(map(_name, data_columns(program)), attributes, strict=True):
        if attribute.kind == "category":
            cases = " ".join(f"WHEN {_text(each)} THEN {i}e0" for i, each in enumerate(attribute.categories))
            wrong = f"error({_text(f'unknown {attribute.name}: ')} || {name})"
            yield f"CASE WHEN {name} IS NOT NULL THEN CASE {name} {cases} ELSE {wrong} END END"
        else:
            yield f"turned(defined({name}))" if attribute.kind == "angle" else f"defined({name})"


def _answered(program: Program, written: list[Written]) -> str:
    trees = [
        f"    {_step(program, written, step, '    ')} AS tree_{number}"
        for number, step in enumerate(program.trees)
    ]
    joins = [
        f"    LEFT JOIN object {name}"
        f" ON {name}.scene = s.scene AND {name}.id IS NOT DISTINCT FROM s.{name}_key"
        for name in arguments(program)
    ]
    scene = "s.scene"
    for name, column in zip(arguments(program), program.layout.arguments, strict=True):
        wrong = f"error({_text(f'{column} is no object of scene ')} || s.scene)"
        scene = f"CASE WHEN {name}.place IS NULL THEN {wrong} ELSE {scene} END"
    body = ",\n".join([f"    {scene} AS scene", *trees])
    return "\n".join([", answered AS (", "    SELECT", body, "    FROM scene s", *joins, ")"])


def _step(program: Program, written: list[Written], first: Step, indent: str) -> str:
    deeper, other, cases, n_rules = f"{indent}    ", "", ["CASE"], 0
    for step in steps_along_no(first):
        if not isinstance(step, Branch):
            other = str(step)
            continue
        cases += [f"-- {line}" for line in told(program, step)]
        reached = _step(program, written, step.yes, deeper)
        if step.no is None:
            other = reached
        else:
            n_rules += 1
            cases.append(f"WHEN {_rule(program, written, step.rule, deeper)} THEN {reached}")
    return f"\n{deeper}".join([*cases, f"ELSE {other} END"]) if n_rules else other


def _rule(program: Program, written: list[Written], rule: Rule, indent: str) -> str:
    known = [list(_tests(program, written, asked)) for asked in by_depth(program, rule)]
    if not rule.n_free:
        return " AND ".join(known[0]) or "TRUE"
    names = [letter(program.schema.n_parameters + number) for number in range(rule.n_free)]
    bound, free = arguments(program), []
    for number, name in enumerate(names):
        new = " AND ".join([f"{name}.place >= 0", *(f"{name}.place <> {other}.place" for other in bound)])
        if rule.or_none:
            new = f"({new} OR {name}.place < 0 AND s.free <= {number})"
        free.append([f"{name}.scene = s.scene", new])
        bound.append(name)
    if rule.every:
        tests = [test for tests in known for test in tests]
        inner = _select("1", names[1:], [*free[1], *tests], f"{indent}        ")
        lonely = _select("1", names[:1], [*free[0], f"NOT EXISTS {inner}"], f"{indent}    ")
        some = _select("1", names[:1], free[0], f"{indent}    ")
        return f"EXISTS {some}\n{indent}AND NOT EXISTS {lonely}"
    where = [test for found, tests in zip(free, known[1:], strict=True) for test in (*found, *tests)]
    exists = f"EXISTS {_select('1', names, where, f'{indent}    ')}"
    if rule.at_least > 1:
        exists = f"{_select('count(*)', names, where, f'{indent}    ')} >= {rule.at_least}"
    return f"\n{indent}AND ".join([*known[0], exists])


def _select(what: str, names: list[str], where: list[str], indent: str) -> str:
    source = ", ".join(f"object {name}" for name in names)
    return f"(SELECT {what} FROM {source}\n{indent}WHERE " + f"\n{indent}AND ".join(where) + ")"


def _tests(program: Program, written: list[Written], asked: list[Asked]) -> Iterator[str]:
    for each in asked:
        measure: Measure = program.measures[each.measure]
        columns = ", ".join(f"{name}.c{at}" for name, at in columns_of(measure, program.schema))
        yield write_answer(each, f"measure_{each.measure}({columns})", written[each.measure], _NOTATION)


def _scored(program: Program) -> Iterator[str]:
    """Write the sums over all trees, and what they say."""
    sums = []
    for output, start in enumerate(program.start.tolist()):
        terms = [_double(start)]
        for number, values in enumerate(program.values):
            said = ", ".join(_double(value) for value in values[:, output].tolist())
            terms.append(f"[{said}][tree_{number} + 1]")
        sums.append(f"    {' + '.join(terms)} AS s{output}")
    yield ", scored AS (\n    SELECT scene,\n" + ",\n".join(sums) + "\n    FROM answered\n)"
    scene, n, logistic = _name(program.layout.scene), len(program.start), program.link == "logistic"
    if program.link == "number":
        yield f"SELECT scene AS {scene}, s0 AS prediction FROM scored ORDER BY scored.scene;"
        return
    if len(program.classes) == 2:
        share = "1e0 / (1e0 + exp(-greatest(s0, -700e0)))" if logistic else "least(greatest(s0, 0e0), 1e0)"
        no, yes = map(_literal, program.classes)
        yield f", share AS (SELECT scene, {share} AS probability FROM scored)"
        said = f"CASE WHEN probability >= {_double(program.threshold)} THEN {yes} ELSE {no} END AS predicted"
        yield f"SELECT scene AS {scene}, probability, {said} FROM share ORDER BY share.scene;"
        return
    most = f"greatest({', '.join(f's{i}' for i in range(n))})"
    parts = [f"exp(s{i} - {most})" if logistic else f"greatest(s{i}, 0e0)" for i in range(n)]
    whole = "1e0" if program.link == "shares" else " + ".join(parts)
    shares = ", ".join(
        f"coalesce({part} / nullif({whole}, 0e0), {_double(1 / n)}) AS p{i}" for i, part in enumerate(parts)
    )
    yield f", share AS (SELECT scene, {shares} FROM scored)"
    best = f"greatest({', '.join(f'p{i}' for i in range(n))})"
    cases = " ".join(f"WHEN p{i} THEN {_literal(label)}" for i, label in enumerate(program.classes))
    named = ", ".join(f"p{i} AS {_name(f'probability_{label}')}" for i, label in enumerate(program.classes))
    said = f"CASE {best} {cases} END AS predicted"
    yield f"SELECT scene AS {scene}, {said}, {named} FROM share ORDER BY share.scene;"


def _double(value: float) -> str:
    digits = repr(value)
    text = digits if "e" in digits else f"{digits}e0"
    return f"({text})" if value < 0.0 else text


def _literal(label: Label) -> str:
    return _text(label) if isinstance(label, str) else str(label).upper()


def _text(value: str) -> str:
    return "'" + value.replace("'", "''") + "'"


def _name(name: str) -> str:
    return '"' + name.replace('"', '""') + '"'
