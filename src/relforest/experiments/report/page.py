"""Sections of a report as one HTML file that works offline."""

from __future__ import annotations

import html
from collections.abc import Iterator, Sequence
from itertools import groupby
from typing import Final

from relforest.experiments.claims import Claim
from relforest.experiments.report.section import Part, Picture, Player, Section
from relforest.experiments.sheets import Passage, Sheet
from relforest.playing.document import asset, filled
from relforest.reports.figure_files import svg_text

_PACKAGE: Final = "relforest.experiments.report"
_SIGNS: Final = {"met": "\u2713 met", "MISSED": "\u2717 missed", "not claimed": "not claimed"}


def report_page(sections: Sequence[Section], *, title: str) -> str:
    """Return a page with all sections, and links to them if there are several.

    Raises
    ------
    InputError
        If a part of the page is missing from this installation.
    """
    links = "".join(
        f'<li><a href="#section-{number}">{html.escape(section.heading)}</a></li>'
        for number, section in enumerate(sections)
    )
    parts = {
        "title": html.escape(title),
        "links": f"<nav aria-label='Sections'><ul>{links}</ul></nav>" if len(sections) > 1 else "",
        "sections": "\n".join(_section(number, each) for number, each in enumerate(sections)),
    }
    return filled(asset(_PACKAGE, "page.html"), parts)


def _section(number: int, section: Section) -> str:
    lead = "".join(f"<p>{html.escape(line)}</p>" for line in section.lead)
    body = "\n".join([_claims(section.claims), *_parts(section.parts)])
    heading = html.escape(section.heading)
    return f'<section id="section-{number}"><h2>{heading}</h2>\n{lead}\n{body}</section>'


def _parts(parts: Sequence[Part]) -> Iterator[str]:
    """Yield the parts one after the other, but pictures beside each other where there is room."""
    for are_pictures, group in groupby(parts, key=lambda part: isinstance(part, Picture)):
        body = "\n".join(map(_part, group))
        yield f'<div class="pictures">{body}</div>' if are_pictures else body


def _claims(claims: Sequence[Claim]) -> str:
    if not claims:
        return ""
    rows = []
    for claim in claims:
        verdict, measured = claim.verdict, "" if claim.missing else f"{claim.measured:.4g}"
        note = f" <small>left out: {html.escape(', '.join(claim.missing))}</small>" if claim.missing else ""
        cells = (
            f'<td class="{verdict.split()[0].lower()}">{_SIGNS[verdict]}</td>',
            f'<td class="text">{html.escape(claim.name)}{note}</td>',
            f"<td>{measured}</td>",
            f"<td>{html.escape(claim.bounds)}</td>",
        )
        rows.append(f"<tr>{''.join(cells)}</tr>")
    head = '<tr><th></th><th class="text">claim</th><th>measured</th><th>bound</th></tr>'
    return _table("Claims", head, rows)


def _part(part: Part) -> str:
    match part:
        case Picture():
            caption = html.escape(part.caption)
            drawn = f'<div class="paper" role="img" aria-label="{caption}">{svg_text(part.figure)}</div>'
            return f"<figure><figcaption>{caption}</figcaption>{drawn}</figure>"
        case Player():
            caption, page = html.escape(part.caption), html.escape(part.page)
            frame = f'<iframe title="{caption}" srcdoc="{page}" loading="lazy"></iframe>'
            return f'<figure class="player"><figcaption>{caption}</figcaption>{frame}</figure>'
        case Passage():
            caption, text = html.escape(part.caption), html.escape(part.text)
            return f"<details><summary>{caption}</summary><pre>{text}</pre></details>"
        case Sheet():
            header, *rows = part.lines()
            head = "".join(f"<th>{html.escape(name)}</th>" for name in header)
            body = [f"<tr>{''.join(f'<td>{html.escape(cell)}</td>' for cell in row)}</tr>" for row in rows]
            return _table(part.caption, f"<tr>{head}</tr>", body)


def _table(caption: str, head: str, rows: Sequence[str]) -> str:
    # A wide table scrolls by itself, also by keyboard.
    return (
        f"<figure><figcaption>{html.escape(caption)}</figcaption>"
        f'<div class="scroll" tabindex="0" role="group" aria-label="{html.escape(caption)}">'
        f"<table><thead>{head}</thead><tbody>{''.join(rows)}</tbody></table></div></figure>"
    )
