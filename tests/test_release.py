"""What is said in several places for a release is the same in all of them."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

import relforest

ROOT = Path(__file__).parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
RECIPE = (ROOT / "conda" / "recipe.yaml").read_text("utf-8")
CONDA_NAMES = {"box2d": "pybox2d", "matplotlib": "matplotlib-base"}


def test_the_version_is_the_same_everywhere() -> None:
    citation = (ROOT / "CITATION.cff").read_text("utf-8")
    assert PROJECT["version"] == relforest.__version__
    assert f"\nversion: {relforest.__version__}\n" in citation
    assert f'\n  version: "{relforest.__version__}"\n' in RECIPE


def test_conda_needs_what_pip_needs() -> None:
    needed = set()
    for entry in PROJECT["dependencies"]:
        found = re.match(r"([a-z0-9-]+)([^;]*)", entry)
        assert found
        needed.add(f"{CONDA_NAMES.get(found[1], found[1])} {found[2].strip()}")
    listed = set(re.findall(r"^    - (\S+ \S+)$", RECIPE.partition("  run:\n")[2], re.MULTILINE))
    assert {entry for entry in listed if not entry.startswith("python ")} == needed
