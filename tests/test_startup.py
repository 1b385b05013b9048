"""Importing the library and asking the command line for help load nothing heavy."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

HEAVY = {"gymnasium", "joblib", "matplotlib", "numba", "numpy", "pyarrow", "rich", "scipy", "sklearn"}


def loaded_by(script: str) -> set[str]:
    """Run Python code in a new process and return which heavy packages it has loaded."""
    listing = "import json, sys; print(json.dumps(list(sys.modules)), file=sys.__stderr__)"
    command = [sys.executable, "-c", f"{script}\n{listing}"]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    return HEAVY & set(json.loads(done.stderr.splitlines()[-1]))


def test_importing_the_library_loads_nothing_heavy() -> None:
    assert loaded_by("import relforest") == set()
    assert loaded_by("import relforest; dir(relforest), relforest.ENVIRONMENT_IDS") == set()


def test_help_and_wrong_usage_load_nothing_heavy(tmp_path: Path) -> None:
    (tmp_path / "exists.html").touch()
    commands: list[tuple[list[str], int]] = [
        (["--help"], 0),
        (["--version"], 0),
        *(([name, "--help"], 0) for name in ("learn", "play", "fit", "predict", "show", "experiment")),
        (["experiment"], 0),
        ([], 2),
        (["fti"], 2),
        (["fit"], 2),
        (["fit", "t.csv", "--lable", "y"], 2),
        (["learn", "maze"], 2),
        (["learn", "corridor", "--episodes", "0"], 2),
        (["learn", "corridor", "--jobs", "0"], 2),
        (["experiment", "none"], 2),
        (["play", "arch", "--keepers", "3"], 2),
        (["play", "keepaway", "--policy", "none"], 2),
        (["play", "arch", "--out", str(tmp_path / "exists.html")], 1),
        (["show", str(tmp_path / "none.json")], 1),
        (["show", str(tmp_path / "exists.html"), "--scene", "3"], 1),
        (["predict", str(tmp_path / "none.json"), "t.csv"], 1),
    ]
    script = f"""
from relforest.cli.app import main
for arguments, code in {commands!r}:
    assert main(arguments) == code, arguments
"""

    assert loaded_by(script) == set()


def test_names_are_where_they_always_were() -> None:
    script = """
import pickle, relforest
import relforest.reports.tree_figure
from relforest import SMRFRPI, SMRFTreeClassifier
from relforest.mappings.catalogue import catalogue as function
from relforest.mappings import catalogue
from relforest.reports import tree_figure
assert catalogue is function and tree_figure.__name__ == "tree_figure"
relforest.trees.grow, relforest.datasets.fetch, relforest.mil.baselines.tuned
relforest.support.errors.InputError, relforest.trees.growth.grow
assert pickle.loads(pickle.dumps(relforest.SMRFTreeClassifier(alpha=0.01))).alpha == 0.01
"""
    for text in (
        script,
        "import os; os.environ['EAGER_IMPORT'] = '1'; from relforest import *; Scenes, metrics",
    ):
        done = subprocess.run([sys.executable, "-c", text], capture_output=True, text=True, check=False)
        assert (done.returncode, done.stderr) == (0, "")


def test_the_package_can_be_run() -> None:
    command = [sys.executable, "-m", "relforest"]
    version = subprocess.run([*command, "--version"], capture_output=True, text=True, check=False)
    wrong = subprocess.run([*command, "fti"], capture_output=True, text=True, check=False)

    assert (version.returncode, version.stdout.split()[0]) == (0, "relforest")
    assert (wrong.returncode, wrong.stderr) == (2, "relforest: unknown command 'fti': did you mean fit?\n")
