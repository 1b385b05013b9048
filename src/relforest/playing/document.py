"""Pages made of a template within the package: style, script and data included."""

from __future__ import annotations

import json
import pkgutil
import re
from collections.abc import Mapping
from typing import Any, Final

from relforest.playing.frames import Stage
from relforest.support.errors import InputError

_PLACE: Final = re.compile(r"@@([a-z]+)@@")
# Within a script element, "</script" and "<!--" would end or hide what follows, and JSON allows line
# separators that old JavaScript does not.
_UNSAFE: Final = {"<": "\\u003c", ">": "\\u003e", "&": "\\u0026", "\u2028": "\\u2028", "\u2029": "\\u2029"}


def filled(template: str, parts: Mapping[str, str]) -> str:
    """Return a template with every place, such as ``@@title@@``, filled by the part of that name."""
    # In one pass, so that placeholders inside a part are not filled.
    return _PLACE.sub(lambda place: parts[place[1]], template)


def asset(package: str, name: str) -> str:
    """Return the text of a file within a package.

    Raises
    ------
    InputError
        If this installation lacks it.
    """
    data = pkgutil.get_data(package, name)
    if data is None:
        raise InputError(f"{name} is missing from {package}: reinstall relforest")
    return data.decode("utf-8").rstrip("\n")


def colors(stage: Stage) -> str:
    """Return the style that defines the colors of a stage, light and dark."""
    light, dark = (
        " ".join(f"--{role}: {pair[shade]};" for role, pair in stage.shades.items()) for shade in (0, 1)
    )
    return f":root {{ {light} }}\n@media (prefers-color-scheme: dark) {{ :root {{ {dark} }} }}"


def embedded(document: Mapping[str, Any]) -> str:
    """Return JSON that is safe inside a script element."""
    text = json.dumps(document, separators=(",", ":"), allow_nan=False)
    return re.sub("[<>&\u2028\u2029]", lambda found: _UNSAFE[found[0]], text)
