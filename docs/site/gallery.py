"""The gallery: every script in `examples/` is run, and shown with what it printed and drew."""

from __future__ import annotations

import ast
import os
import subprocess
import sys
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

ROOT = Path(__file__).resolve().parents[2]
EXAMPLES = ROOT / "examples"
PICTURES = {".png", ".svg", ".webp"}


def names() -> list[str]:
    """Return the names of the examples."""
    return sorted(path.stem for path in EXAMPLES.glob("*.py"))


@cache
def pages() -> dict[str, str | bytes]:
    """Run all examples; return the address of every page and picture of the gallery, with its content."""
    content: dict[str, str | bytes] = {}
    cards, plain = [], []
    for name in names():
        printed, pictures = _run(name)
        first, _, about = _docstring(name).partition("\n")
        title = name.replace("_", " ").capitalize()
        content |= {f"gallery/{name}/{path}": data for path, data in pictures.items()}
        addresses = [f"{name}/{path}" for path in pictures]
        code = (EXAMPLES / f"{name}.py").read_text("utf-8").split('"""\n', 1)[1].strip()
        content[f"gallery/{name}.md"] = "\n\n".join(
            [
                f"# {title}",
                f"{first} {about}".strip(),
                *(f"![{title}]({address})" for address in addresses),
                f"## Code\n\n`examples/{name}.py`:\n\n```python\n{code}\n```",
                f"## Output\n\n```\n{printed}```\n",
            ]
        )
        if addresses:
            picture = f"[![{title}]({addresses[0]})]({name}.md)"
            cards.append(f"<figure markdown>\n{picture}\n\n**[{title}]({name}.md)**: {first}\n</figure>")
        else:
            plain.append(f"- **[{title}]({name}.md)**: {first}")
    content["gallery/index.md"] = "\n\n".join(
        [
            "# Gallery",
            "Every page shows a script of `examples/`, run when this site was built, and what it made.",
            '<div class="cards" markdown>',
            *cards,
            "</div>",
            *plain,
        ]
    )
    return content


def _docstring(name: str) -> str:
    return ast.get_docstring(ast.parse((EXAMPLES / f"{name}.py").read_text("utf-8"))) or name


def _run(name: str) -> tuple[str, dict[str, bytes]]:
    with TemporaryDirectory() as folder:
        command = [sys.executable, str(EXAMPLES / f"{name}.py")]
        environment = os.environ | {"PYTHONPATH": str(ROOT / "src"), "MPLBACKEND": "agg"}
        done = subprocess.run(
            command, cwd=folder, env=environment, capture_output=True, text=True, check=False
        )
        if done.returncode:
            raise RuntimeError(f"examples/{name}.py failed:\n{done.stderr}")
        made = sorted(path for path in Path(folder).iterdir() if path.suffix in PICTURES)
        return done.stdout, {path.name: path.read_bytes() for path in made}
