"""What a study is called and what it asks, read without loading it."""

from __future__ import annotations

from importlib import import_module


def heading(package: str) -> tuple[str, str]:
    """Return the name of a study and its question: the first line of the docstring of its package."""
    return package.rpartition(".")[2], str(import_module(package).__doc__).partition("\n")[0]
