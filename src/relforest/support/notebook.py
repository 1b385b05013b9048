"""How values of all layers come to be drawn in notebooks."""

from __future__ import annotations

from importlib import import_module


def drawn(value: object) -> str:
    """Return a value as HTML, for notebooks.

    A class is drawn by ``_repr_html_ = drawn`` and a function in `relforest.reports.notebook`. That layer is
    above the values, which must not know it; so it is loaded by name, when a notebook asks.
    """
    return str(import_module("relforest.reports.notebook").as_html(value))
