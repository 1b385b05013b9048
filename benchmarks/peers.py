"""The plain twins of ``tests/reference``, which every kernel is timed against."""

from __future__ import annotations

import importlib
import sys
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from reference import blocks, covagg, keepaway, keepaway_agreement, tree
else:
    sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "tests"))
    blocks = importlib.import_module("reference.blocks")
    covagg = importlib.import_module("reference.covagg")
    keepaway = importlib.import_module("reference.keepaway")
    keepaway_agreement = importlib.import_module("reference.keepaway_agreement")
    tree = importlib.import_module("reference.tree")

__all__ = ["blocks", "covagg", "keepaway", "keepaway_agreement", "tree"]
