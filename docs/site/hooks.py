"""What the site shows that is not in `docs/`: the API, the executed examples, the studies, the changelog.

MkDocs calls the functions ``on_...``; see its manual, "Hooks".
"""

from __future__ import annotations

import re
import sys
from pathlib import Path
from typing import Any

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page

sys.path.insert(0, str(Path(__file__).parent))

import gallery
import reference

ROOT = Path(__file__).resolve().parents[2]
STUDIES = ROOT / "src" / "relforest" / "experiments"
ELSEWHERE = {"changelog.md": ROOT / "CHANGELOG.md", "contributing.md": ROOT / "CONTRIBUTING.md"} | {
    f"studies/{readme.parent.name}.md": readme for readme in sorted(STUDIES.glob("*/README.md"))
}
"""Pages whose source is outside `docs/`."""

_LINK = re.compile(r"(?<=\]\()(?!https?:|#)([^)#\s]+)")
_PART = re.compile(r"<!-- from (\S+): (.+) -->")


def on_config(config: MkDocsConfig) -> MkDocsConfig:
    """Fill the parts of the navigation that follow from what there is."""
    decisions = sorted(Path(config.docs_dir, "decisions").glob("*.md"))
    filled = {
        "GALLERY": ["gallery/index.md", *(f"gallery/{name}.md" for name in gallery.names())],
        "STUDIES": ["comparison.md", *(uri for uri in ELSEWHERE if uri.startswith("studies/"))],
        "API": [{module.removeprefix("relforest."): reference.uri(module)} for module in reference.modules()],
        "DECISIONS": [f"decisions/{path.name}" for path in decisions],
    }
    config.nav = _filled(config.nav, filled)
    return config


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add the pages and pictures that are made now."""
    made: dict[str, str | bytes] = {uri: path.read_text("utf-8") for uri, path in ELSEWHERE.items()}
    made |= {reference.uri(module): reference.page(module) for module in reference.modules()}
    made |= gallery.pages()
    for uri, content in made.items():
        files.append(File.generated(config, uri, content=content))
    return files


def on_page_markdown(markdown: str, page: Page, config: MkDocsConfig, files: Files) -> str:  # noqa: ARG001
    """Fetch sections of other texts, and let links to files of the repository lead to their pages."""
    uri = page.file.src_uri
    if uri.startswith(("api/", "gallery/")):
        return markdown

    def section(match: re.Match[str]) -> str:
        text = (ROOT / match[1]).read_text("utf-8")
        found = re.search(rf"^## {re.escape(match[2])}\n(.*?)(?=^## |\Z)", text, re.DOTALL | re.MULTILINE)
        if not found:
            raise ValueError(f"{uri}: {match[1]} has no section {match[2]!r}")
        return _LINK.sub(lambda link: _target(ROOT / match[1], link[1], uri), found[1])

    source = ELSEWHERE.get(uri, Path(config.docs_dir, uri))
    markdown = _LINK.sub(lambda link: _target(source, link[1], uri), markdown)
    return _PART.sub(section, markdown)


def _target(source: Path, link: str, uri: str) -> str:
    """Return where a link in a file of the repository leads on a page of the site."""
    path = (source.parent / link).resolve()
    docs = ROOT / "docs"
    pages = {place: address for address, place in ELSEWHERE.items()}
    if path in pages:
        address = pages[path]
    elif path.is_relative_to(docs):
        address = path.relative_to(docs).as_posix()
    else:
        return link
    return "../" * uri.count("/") + address


def _filled(nav: Any, filled: dict[str, list[Any]]) -> Any:  # noqa: ANN401 - nested lists and dictionaries
    if isinstance(nav, str):
        return filled.get(nav, nav)
    if isinstance(nav, dict):
        return {title: _filled(part, filled) for title, part in nav.items()}
    return [_filled(part, filled) for part in nav]
