"""The report page as one HTML text: it contains everything that it shows and loads nothing.

Text from designs is escaped everywhere: in HTML, and in the JSON of the view, which must not end its script element.
"""

from __future__ import annotations

import base64
import html
import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from gearmesh.view.report.card import Card, MeshCard
from gearmesh.view.report.page_file import page_file


@dataclass(frozen=True)
class PageSection:
    """A part of the page with a heading: `body` is HTML, which a `folded` part shows only when it is opened."""

    heading: str
    body: str
    folded: bool = False

    @property
    def anchor(self) -> str:
        return re.sub(r"[^a-z0-9]+", "-", self.heading.lower()).strip("-")


def page(
    title: str,
    summary: str,
    card: Card,
    stage: Mapping[str, Any],
    pictures: Sequence[tuple[str, bytes]],
    sections: Sequence[PageSection],
) -> str:
    """Return the page: title and a line under it, the view with the card beside it, then the sections.

    `pictures` are captions and JPEG files; the first replaces the view if a browser cannot draw it.
    """
    parts = {
        **_common_parts(title, summary, sections),
        "CARD": _card(card),
        "PICTURE": picture(*pictures[0], identity="still") if pictures else "",
        "STAGE": script_json(stage),
        "THREE": page_file("three.min.js"),
        "LICENCE": html.escape(page_file("three.LICENSE.txt")),
        "VIEWER": page_file("viewer.html").rstrip(),
        "SCENE": page_file("scene.js"),
        "VIEW": page_file("view.js"),
    }
    return _filled("page.html", parts)


def plain_page(
    title: str, summary: str, sections: Sequence[PageSection], shot: str = "", card: Card | None = None
) -> str:
    """Return a page of sections without a view: it has no script.

    With a `card` the page begins with the HTML of a picture, `shot`, and the card beside it.
    """
    top = "" if card is None else f'<div class="top">\n{_card(card)}\n<section id="view">{shot}</section>\n</div>'
    return _filled("plain.html", {**_common_parts(title, summary, sections), "TOP": top})


def _common_parts(title: str, summary: str, sections: Sequence[PageSection]) -> dict[str, str]:
    """Return the parts that every page has."""
    return {
        "TITLE": html.escape(title),
        "SUMMARY": html.escape(summary),
        "STYLE": page_file("page.css"),
        "NAVIGATION": "".join(
            f'<a href="#{section.anchor}">{html.escape(section.heading)}</a>' for section in sections
        ),
        "SECTIONS": "\n".join(map(_section, sections)),
    }


def _filled(template: str, parts: Mapping[str, str]) -> str:
    """Return a template with its parts put in, in one pass: nothing put in is looked at again."""
    return re.sub(r"\{\{([A-Z]+)\}\}", lambda match: parts[match[1]], page_file(template))


def script_json(document: Mapping[str, Any]) -> str:
    """Return JSON for a script element: none of its characters can begin a tag or a comment."""
    text = json.dumps(document, separators=(",", ":"), allow_nan=False)
    return text.replace("&", "\\u0026").replace("<", "\\u003c").replace(">", "\\u003e")


def picture(caption: str, jpeg: bytes, identity: str = "") -> str:
    """Return the HTML of a JPEG picture with its caption."""
    source = base64.b64encode(jpeg).decode("ascii")
    return _figure(f'<img src="data:image/jpeg;base64,{source}" alt="{html.escape(caption)}">', caption, identity)


def drawing(caption: str, file: bytes) -> str:
    """Return the HTML of an SVG drawing or a PNG picture with its caption, as a separate image: ids and styles stay
    inside.
    """
    kind = "png" if file.startswith(b"\x89PNG") else "svg+xml"
    source = base64.b64encode(file).decode("ascii")
    return _figure(f'<img src="data:image/{kind};base64,{source}" alt="{html.escape(caption)}">', caption)


def listing(text: str, button: str) -> str:
    """Return the HTML of a text, unchanged, with a button that copies it."""
    return f'<button type="button" class="copy">{html.escape(button)}</button>\n<pre tabindex="0">{html.escape(text)}</pre>'


def three_version() -> str:
    """Version of the three.js in the page, from the first line of its script."""
    return page_file("three.min.js").split(",", 1)[0].rpartition(" ")[2]


def _figure(image: str, caption: str, identity: str = "") -> str:
    name = f' id="{identity}"' if identity else ""
    return f"<figure{name}>{image}<figcaption>{html.escape(caption)}</figcaption></figure>"


def _section(section: PageSection) -> str:
    heading = html.escape(section.heading)
    if section.folded:
        body = f"<details><summary><h2>{heading}</h2></summary>\n{section.body}\n</details>"
        return f'<section id="{section.anchor}" class="folded">{body}</section>'
    return f'<section id="{section.anchor}"><h2>{heading}</h2>\n{section.body}\n</section>'


def _card_figures(mesh: MeshCard) -> str:
    """Return the figures of a mesh as a list with terms."""
    figures = "".join(
        f"<div><dt>{html.escape(figure.label)}</dt><dd><strong>{html.escape(figure.value)}</strong>"
        f"{f'<small>{html.escape(figure.note)}</small>' if figure.note else ''}</dd></div>"
        for figure in mesh.figures
    )
    return f"<dl>{figures}</dl>"


def _card(card: Card) -> str:
    parts = []
    for mesh in card.meshes:
        heading = f"<h3>{html.escape(mesh.mesh)}</h3>" if len(card.meshes) > 1 else ""
        parts.append(heading + _card_figures(mesh))
    parts.append(f'<p class="{"failed" if card.failures else "good"}">{html.escape(card.verdict)}</p>')
    if not card.warnings:
        parts.append('<p class="good">No warnings.</p>')
    else:
        count = f" ({len(card.warnings)})" if len(card.warnings) > 1 else ""
        items = "".join(f"<li>{html.escape(line)}</li>" for line in card.warnings)
        heading = f"<h3>Warning{'s' * bool(count)}{count}</h3>"
        parts.append(f'<div id="warnings" class="warnings" tabindex="0">{heading}<ul>{items}</ul></div>')
    return f'<section id="card" aria-label="At a glance">{"".join(parts)}</section>'
