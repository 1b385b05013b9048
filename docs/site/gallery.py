"""The gallery: every script in `examples/` is run, and shown with what it printed and the pictures it made."""

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
    cards = []
    for name in names():
        text, pictures = _run(name)
        title, _, about = _docstring(name).partition("\n")
        title = title.rstrip(".")
        addresses = {f"{name}/{path}": data for path, data in pictures.items()}
        content |= {f"gallery/{address}": data for address, data in addresses.items()}
        shown = "\n\n".join(f"![{title}]({address})" for address in addresses)
        code = (EXAMPLES / f"{name}.py").read_text("utf-8").split('"""\n', 1)[1].strip()
        content[f"gallery/{name}.md"] = (
            f"---\ntitle: {name.replace('_', ' ').capitalize()}\n---\n\n"
            f"# {title}\n\n{about.strip()}\n\n{shown}\n\n"
            f"## Code\n\n`examples/{name}.py`:\n\n```python\n{code}\n```\n\n## Output\n\n```\n{text}```\n"
        )
        picture = next((f"![]({address})" for address in addresses), "")
        cards.append(f'<figure markdown="span">\n[{picture}]({name}.md)\n\n[{title}]({name}.md)\n</figure>\n' if picture else f'<figure markdown="span">\n[{title}]({name}.md)\n</figure>\n')
    content["gallery/index.md"] = (
        "# Gallery\n\nEvery page shows a script of `examples/`, run when this site was built, and what it made.\n\n"
        '<div class="cards" markdown>\n\n' + "\n".join(cards) + "\n</div>\n"
    )
    return content


def _docstring(name: str) -> str:
    return ast.get_docstring(ast.parse((EXAMPLES / f"{name}.py").read_text("utf-8"))) or name


def _run(name: str) -> tuple[str, dict[str, bytes]]:
    with TemporaryDirectory() as folder:
        command = [sys.executable, str(EXAMPLES / f"{name}.py")]
        environment = os.environ | {"PYTHONPATH": str(ROOT / "src"), "MPLBACKEND": "agg"}
        done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)
        if done.returncode:
            raise RuntimeError(f"examples/{name}.py failed:\n{done.stderr}")
        made = sorted(path for path in Path(folder).iterdir() if path.suffix in PICTURES)
        return done.stdout, {path.name: path.read_bytes() for path in made}
