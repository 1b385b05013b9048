"""Packages that load their names on first use, so that importing the library costs next to nothing.

The names are listed in the package's ``__init__.pyi``, where type checkers and editors find them too.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from importlib import import_module
from importlib.util import find_spec
from types import ModuleType

import lazy_loader


def attach(package: str, file: str) -> tuple[Callable[[str], object], Callable[[], list[str]], list[str]]:
    """Return ``__getattr__``, ``__dir__`` and ``__all__`` of the package with this ``__name__`` and file."""
    load, _, names = lazy_loader.attach_stub(package, file)

    def get(name: str) -> object:
        if name in names:
            return load(name)
        # Other modules are attributes too, as they would be if the package had imported them.
        if not name.startswith("_") and find_spec(f"{package}.{name}"):
            return import_module(f"{package}.{name}")
        raise AttributeError(
            f"module {package!r} has no attribute {name!r}", name=name, obj=sys.modules[package]
        )

    def list_names() -> list[str]:
        present = vars(sys.modules[package]).items()
        extra = (name for name, value in present if name.startswith("_") or isinstance(value, ModuleType))
        return sorted({*names, *extra})

    return get, list_names, names
