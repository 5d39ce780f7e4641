"""XML that people hand in, without what makes a small file large: document types, and elements nested without end."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from typing import Any

#: levels of elements in elements
DEEPEST = 32


class _Builder(ET.TreeBuilder):
    """Refuses document types, with their entities, and deep nesting."""

    def __init__(self) -> None:
        super().__init__()
        self.depth = 0

    def doctype(self, name: str, pubid: str | None, system: str | None) -> None:
        raise ValueError("has a document type; files with entities are not read")

    def start(self, tag: Any, attrs: Any) -> Any:
        self.depth += 1
        if self.depth > DEEPEST:
            raise ValueError("nested too deeply")
        return super().start(tag, attrs)

    def end(self, tag: Any) -> Any:
        self.depth -= 1
        return super().end(tag)


def xml_root(content: bytes) -> ET.Element:
    """The root element of an XML text.

    Raises ParseError for what is no XML, and ValueError or LookupError for a document type, deep nesting and an unknown encoding.
    """
    return ET.fromstring(content, ET.XMLParser(target=_Builder()))
