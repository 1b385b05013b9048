"""Registration of the worlds as soon as Gymnasium is loaded; importing the library does not load it."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from contextlib import suppress
from importlib.machinery import ModuleSpec
from types import ModuleType
from typing import final

from relforest.worlds.registry import register_worlds


def register_with_gymnasium() -> None:
    """Register the worlds now if Gymnasium is loaded, else as soon as it is."""
    if "gymnasium" in sys.modules:
        register_worlds()
    else:
        sys.meta_path.insert(0, _Registrar())


@final
class _Registrar:
    """An import hook that registers the worlds once the code of Gymnasium has run."""

    def find_spec(
        self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        if fullname != "gymnasium":
            return None
        # Only finders further down the list, so that two registrars never call each other in turn.
        others = sys.meta_path[sys.meta_path.index(self) + 1 :]
        found = (finder.find_spec(fullname, path, target) for finder in others)
        spec = next((spec for spec in found if spec is not None), None)
        if spec is not None and spec.loader is not None:
            execute = spec.loader.exec_module

            def execute_and_register(module: ModuleType) -> None:
                execute(module)
                register_worlds()
                with suppress(ValueError):
                    sys.meta_path.remove(self)

            # The loader stays what it is: others may ask it for resources or source code.
            vars(spec.loader)["exec_module"] = execute_and_register
        return spec
