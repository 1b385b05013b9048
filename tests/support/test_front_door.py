from __future__ import annotations

import sys
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from types import ModuleType

import pytest

DOOR = """
from relforest.support.front_door import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
"""


@pytest.fixture
def package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[ModuleType]:
    """A package whose module ``shape`` has a function of that name; ``corner`` is another module."""
    folder = tmp_path / "figures"
    folder.mkdir()
    (folder / "__init__.py").write_text(DOOR)
    (folder / "__init__.pyi").write_text("from . import corner\nfrom .shape import SIDES, shape\n")
    (folder / "shape.py").write_text("SIDES = 4\ndef shape(): return SIDES\n")
    (folder / "corner.py").write_text("")
    (folder / "edge.py").write_text("LENGTH = 2\n")
    monkeypatch.syspath_prepend(tmp_path)
    yield import_module("figures")
    for name in [name for name in sys.modules if name.partition(".")[0] == "figures"]:
        del sys.modules[name]


def loaded() -> set[str]:
    return {name for name in sys.modules if name.startswith("figures.")}


def test_names_and_modules_are_loaded_when_they_are_used(package: ModuleType) -> None:
    assert loaded() == set()
    assert package.SIDES == 4
    assert loaded() == {"figures.shape"}
    assert package.corner is sys.modules["figures.corner"]


def test_modules_that_are_not_listed_are_attributes_too(package: ModuleType) -> None:
    assert package.edge.LENGTH == 2
    assert "edge" not in package.__all__


def test_a_function_is_not_hidden_by_the_module_of_its_name(package: ModuleType) -> None:
    import_module("figures.shape")

    assert package.shape() == 4


def test_names_are_listed_before_they_are_loaded(package: ModuleType) -> None:
    assert package.__all__ == ["SIDES", "corner", "shape"]
    assert {"SIDES", "corner", "shape", "__doc__"} <= set(dir(package))
    assert "attach" not in dir(package)
    assert loaded() == set()


def test_what_is_missing_is_an_attribute_error(package: ModuleType) -> None:
    with pytest.raises(AttributeError, match="module 'figures' has no attribute 'face'"):
        _ = package.face
    assert not hasattr(package, "_private")
