"""The house rules that a machine can check, read from the syntax of every module."""

from __future__ import annotations

import ast
import builtins
import re
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from typing import TypeVar

ROOT = Path(__file__).resolve().parents[1]
SOURCE = ROOT / "src" / "relforest"
TEXTS = {
    path.relative_to(SOURCE).as_posix(): path.read_text("utf-8") for path in sorted(SOURCE.rglob("*.py"))
}
TREES = {name: ast.parse(text) for name, text in TEXTS.items()}

LONGEST_MODULE = 500
LONGEST_FUNCTION = 80
MOST_PARAMETERS = 8
VAGUE_NAMES = {"base_utils", "common", "core", "helper", "helpers", "misc", "util", "utils"}
MAY_OPEN_FILES = {"cli/streams.py", "support/archives.py", "support/files.py", "support/locks.py"}
MAY_PRINT = {"cli"}
OPENING = {"fdopen", "mkstemp", "open", "read_bytes", "read_text", "write_bytes", "write_text"}
# Python's own protocols (indices, attributes, imports, paths, hooks of json) ask for its own errors.
MAY_RAISE_BUILTIN_ERRORS = {
    "scenes/batch.py",
    "support/documents.py",
    "support/files.py",
    "support/front_door.py",
    "worlds/keepaway/parallel.py",
}
UNSAFE_MODULES = {"cloudpickle", "dill", "marshal", "pickle", "shelve"}
# Field lists that Python itself keeps immutable or closed.
VALUE_BASES = {"Enum", "IntEnum", "NamedTuple", "StrEnum", "TypedDict"}

Node = TypeVar("Node", bound=ast.AST)


def each(*types: type[Node]) -> Iterator[tuple[str, Node]]:
    """Yield every node of these types in the source, with the place it stands in."""
    for name, tree in TREES.items():
        for node in ast.walk(tree):
            if isinstance(node, types):
                yield f"{name}:{getattr(node, 'lineno', 0)}", node


def each_function() -> Iterator[tuple[str, ast.FunctionDef | ast.AsyncFunctionDef]]:
    yield from each(ast.FunctionDef)
    yield from each(ast.AsyncFunctionDef)


def each_import() -> Iterator[tuple[str, str]]:
    for where, statement in each(ast.Import):
        yield from ((where, alias.name) for alias in statement.names)
    for where, origin in each(ast.ImportFrom):
        yield where, origin.module or ""


def module_of(where: str) -> str:
    return where.rpartition(":")[0]


def last_name(node: ast.expr) -> str:
    """Return ``dataclass`` for ``dataclasses.dataclass(frozen=True)``."""
    if isinstance(node, ast.Call):
        return last_name(node.func)
    if isinstance(node, ast.Subscript):
        return last_name(node.value)
    if isinstance(node, ast.Attribute):
        return node.attr
    return node.id if isinstance(node, ast.Name) else ""


def bases_of(node: ast.ClassDef) -> set[str]:
    return {last_name(base) for base in node.bases}


def is_concrete(node: ast.ClassDef) -> bool:
    return not bases_of(node) & {"ABC", "Protocol", *VALUE_BASES} and not node.name.endswith("Error")


def option(call: ast.expr, name: str) -> str | None:
    keywords = call.keywords if isinstance(call, ast.Call) else []
    return next((ast.unparse(keyword.value) for keyword in keywords if keyword.arg == name), None)


def door(folder: Path) -> str:
    return (folder / "__init__.py").relative_to(SOURCE).as_posix()


def test_modules_are_short() -> None:
    lengths = {name: len(text.splitlines()) for name, text in TEXTS.items()}

    assert {name: length for name, length in lengths.items() if length > LONGEST_MODULE} == {}
    assert sum(length <= 250 for length in lengths.values()) >= 0.75 * len(lengths)


def test_modules_are_named_for_their_ideas() -> None:
    assert [name for name in TEXTS if set(name.removesuffix(".py").split("/")) & VAGUE_NAMES] == []


def test_modules_say_what_they_are_for() -> None:
    assert [name for name, tree in TREES.items() if not ast.get_docstring(tree)] == []


def test_front_doors_hold_only_their_purpose_and_load_names_on_first_use() -> None:
    allowed = {
        "from __future__ import annotations",
        "from relforest.support.front_door import attach",
        "__getattr__, __dir__, __all__ = attach(__name__, __file__)",
    }
    root = {"from relforest.worlds.registration import register_with_gymnasium", "register_with_gymnasium()"}
    extra = [
        (name, line)
        for name, tree in TREES.items()
        if name.endswith("__init__.py")
        for line in map(ast.unparse, tree.body[1:])
        if line not in allowed | (root if name == "__init__.py" else set())
        if not line.startswith("__version__ = ")
    ]

    assert extra == []


def test_stubs_of_front_doors_hold_only_the_names_of_their_own_package() -> None:
    stubs = {path.parent: ast.parse(path.read_text("ascii")) for path in SOURCE.rglob("*.pyi")}

    assert [path.name for path in SOURCE.rglob("*.pyi") if path.name != "__init__.pyi"] == []
    assert {folder for folder in stubs if "attach(" in TEXTS[door(folder)]} == set(stubs)
    for folder, tree in stubs.items():
        imports = [node for node in tree.body if isinstance(node, ast.ImportFrom)]
        package = import_module(".".join(["relforest", *folder.relative_to(SOURCE).parts]))
        listed = next(node.value for node in tree.body if isinstance(node, ast.Assign))

        assert all(node.level == 1 for node in imports), folder
        names = sorted(alias.name for node in imports for alias in node.names)
        assert sorted(ast.literal_eval(listed)) == names == sorted(package.__all__), folder
        assert all(hasattr(package, name) for name in names), folder


def test_functions_are_short() -> None:
    lengths = {where: (node.end_lineno or 0) - node.lineno + 1 for where, node in each_function()}

    assert {where: length for where, length in lengths.items() if length > LONGEST_FUNCTION} == {}


def test_functions_have_few_parameters() -> None:
    counts = {}
    for where, node in each_function():
        named = [*node.args.posonlyargs, *node.args.args, *node.args.kwonlyargs]
        # Every long estimator has some besides its own options.
        common = {"self", "cls", "verbose", "n_jobs", "random_state"}
        counts[where] = len([argument for argument in named if argument.arg not in common])

    assert {where: count for where, count in counts.items() if count > MOST_PARAMETERS} == {}


def test_dataclasses_are_frozen() -> None:
    # Options of estimators are fields that scikit-learn sets.
    estimators = ("Estimator", "Classifier", "Mixin")
    thawed = [
        where
        for where, node in each(ast.ClassDef)
        for decorator in node.decorator_list
        if last_name(decorator) == "dataclass" and option(decorator, "frozen") != "True"
        if not any(base.endswith(estimators) for base in bases_of(node))
    ]

    assert thawed == []


def test_classes_are_interfaces_or_final() -> None:
    concrete = [(where, node) for where, node in each(ast.ClassDef) if is_concrete(node)]
    names = {node.name for _, node in concrete}
    decorators = {where: {last_name(item) for item in node.decorator_list} for where, node in concrete}

    assert [where for where, found in decorators.items() if "final" not in found] == []
    assert [where for where, node in each(ast.ClassDef) if bases_of(node) & names] == []


def test_files_are_opened_in_one_place() -> None:
    opened = []
    for where, call in each(ast.Call):
        # `write_text(path, ...)` and `files.write_text(path, ...)` are ours, `path.write_text(...)` is not.
        plain = isinstance(call.func, ast.Name) and call.func.id != "open"
        ours = isinstance(call.func, ast.Attribute) and ast.unparse(call.func.value) == "files"
        if last_name(call.func) in OPENING and not plain and not ours:
            opened.append(where)

    assert [where for where in opened if module_of(where) not in MAY_OPEN_FILES] == []


def test_only_the_edges_print() -> None:
    printed = [where for where, call in each(ast.Call) if ast.unparse(call.func) == "print"]

    assert [where for where in printed if where.split("/")[0] not in MAY_PRINT] == []


def test_kernels_are_compiled_in_one_way() -> None:
    using = [module_of(where) for where, name in each_import() if name.split(".")[0] == "numba"]

    assert set(using) <= {"support/jit.py"}


def test_nothing_is_unpickled() -> None:
    allowing = [
        where for where, call in each(ast.Call) if option(call, "allow_pickle") not in {None, "False"}
    ]

    assert [where for where, name in each_import() if name.split(".")[0] in UNSAFE_MODULES] == []
    assert allowing == []


def test_no_random_state_is_global() -> None:
    local = {"Generator", "PCG64", "SeedSequence", "default_rng"}
    shared = [
        where
        for where, node in each(ast.Attribute)
        if ast.unparse(node.value) in {"np.random", "numpy.random"} and node.attr not in local
    ]

    assert shared == []
    assert [where for where, name in each_import() if name == "random"] == []


def test_tests_mirror_the_source() -> None:
    folders = {path.parent.relative_to(ROOT / "tests") for path in (ROOT / "tests").rglob("test_*.py")}

    assert [folder.as_posix() for folder in folders if not (SOURCE / folder).is_dir()] == []


def test_errors_are_those_of_the_library() -> None:
    raised = [
        (where, name)
        for where, statement in each(ast.Raise)
        if statement.exc is not None and module_of(where) not in MAY_RAISE_BUILTIN_ERRORS
        if hasattr(builtins, name := last_name(statement.exc)) and name != "AssertionError"
    ]

    assert raised == []


def test_docstrings_write_shapes_in_one_way() -> None:
    docstrings = [
        (where, node.value.value)
        for where, node in each(ast.Expr)
        if isinstance(node.value, ast.Constant) and isinstance(node.value.value, str)
    ]

    other = re.compile(r"(of|[,;:])\s+shape \(|(ndarray|array-like) \(")
    assert [where for where, text in docstrings if other.search(text)] == []
