"""The plain twins of ``tests/reference``, which every kernel is timed against."""

from __future__ import annotations

import importlib
import sys
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from reference import covagg, tree
else:
    sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "tests"))
    covagg = importlib.import_module("reference.covagg")
    tree = importlib.import_module("reference.tree")

__all__ = ["covagg", "tree"]
