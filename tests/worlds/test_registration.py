from __future__ import annotations

import subprocess
import sys

import gymnasium
import pytest

from relforest.worlds.registration import register_with_gymnasium

MAKE = "import gymnasium; print(gymnasium.make('relforest/Corridor-v0').unwrapped)"


@pytest.mark.parametrize(
    "script",
    [
        f"import relforest; {MAKE}",
        f"import gymnasium, relforest; {MAKE}",
        # Another package may ask whether Gymnasium is there without loading it.
        f"import relforest, importlib.util; importlib.util.find_spec('gymnasium'); {MAKE}",
        # Two registrars, as when the library is reloaded, are no more than one.
        f"import relforest; relforest.worlds.registration.register_with_gymnasium(); {MAKE}",
    ],
)
def test_worlds_are_registered_in_whatever_order_packages_are_imported(script: str) -> None:
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=False)

    assert (done.returncode, done.stderr) == (0, "")
    assert "CorridorEnv" in done.stdout


def test_gymnasium_can_still_be_asked_for_its_files() -> None:
    script = """
import sys, relforest
assert "gymnasium" not in sys.modules
import gymnasium, importlib.resources
print((importlib.resources.files(gymnasium) / "__init__.py").is_file(), len(sys.meta_path))
"""
    plain = "import sys, gymnasium; print(True, len(sys.meta_path))"
    results = [
        subprocess.run([sys.executable, "-c", text], capture_output=True, text=True, check=True).stdout
        for text in (script, plain)
    ]

    assert results[0] == results[1]


def test_a_loaded_gymnasium_needs_no_registrar() -> None:
    before = list(sys.meta_path)
    register_with_gymnasium()

    assert sys.meta_path == before
    assert "relforest/Corridor-v0" in gymnasium.registry
