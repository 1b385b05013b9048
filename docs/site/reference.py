"""The pages of the API: one for each package and public module, from what the stubs say is public."""

from __future__ import annotations

import ast
from functools import cache
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[2] / "src"
ROOT = "relforest"


@cache
def exports(package: str) -> dict[str, str]:
    """Return the public names of a package, each with the place that defines it.

    The stub ``__init__.pyi`` says both: names are those of ``__all__``, places follow from the imports.
    """
    places, public = {}, []
    for node in ast.parse(_stub(package).read_text("utf-8")).body:
        if isinstance(node, ast.ImportFrom):
            inside = ".".join(part for part in (package, node.module) if part)
            places.update({alias.name: f"{inside}.{alias.name}" for alias in node.names})
        elif isinstance(node, ast.Assign):
            public = ast.literal_eval(node.value)
    return {name: _defined(places[name]) for name in public}


@cache
def modules() -> tuple[str, ...]:
    """Return everything that has a page: packages with a stub, and the modules that they name, in order."""
    stubs = sorted(SOURCE.rglob("__init__.pyi"))
    packages = [".".join(stub.parent.relative_to(SOURCE).parts) for stub in stubs]
    named = {place for package in packages for place in exports(package).values() if _is_module(place)}
    return tuple(sorted({*packages, *named}))


def uri(module: str) -> str:
    """Return the address of the page of a module within the documentation."""
    return f"api/{module.removeprefix(f'{ROOT}.')}.md"


def page(module: str) -> str:
    """Return the page of a module: what it is, its names, and links to those documented elsewhere."""
    if not _stub(module).exists():
        return f"# {module}\n\n::: {module}\n    options:\n      show_root_heading: false\n"
    own, elsewhere = [], []
    for name, place in exports(module).items():
        home = _home(place)
        if home == module:
            own.append(f"::: {module}.{name}\n")
        elif _is_module(place):
            elsewhere.append(f"- [`{name}`]({Path(uri(place)).name}): {_summary(place)}")
        else:
            elsewhere.append(f"- [`{name}`]({Path(uri(home)).name}#{home}.{name}), of `{home}`")
    text = ast.get_docstring(ast.parse(_code(module).read_text("utf-8"))) or ""
    return "\n".join([f"# {module}\n", text, "", *elsewhere, "", *own])


def _home(place: str) -> str:
    """Return the module whose page documents a name: the innermost one that makes it public."""
    name = place.rpartition(".")[2]
    candidates = [place]
    while "." in place:
        place = place.rpartition(".")[0]
        candidates.append(place)
    known = set(modules())
    return next(
        module
        for module in candidates
        if module in known
        and (not _stub(module).exists() or module == candidates[0] or name in exports(module))
    )


def _defined(place: str) -> str:
    """Follow a name through packages that pass it on, to the module that defines it."""
    package, _, name = place.rpartition(".")
    if _stub(package).exists() and not _is_module(place):
        return exports(package).get(name, place)
    return place


def _summary(module: str) -> str:
    text = ast.get_docstring(ast.parse(_code(module).read_text("utf-8"))) or ""
    return text.partition("\n")[0]


def _is_module(place: str) -> bool:
    return _code(place).exists()


def _code(module: str) -> Path:
    path = SOURCE.joinpath(*module.split("."))
    return path / "__init__.py" if path.is_dir() else path.with_suffix(".py")


def _stub(module: str) -> Path:
    return SOURCE.joinpath(*module.split("."), "__init__.pyi")
