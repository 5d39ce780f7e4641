"""XML from users, without document types and unlimited nesting, which make a small file large in memory."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from typing import Any

#: levels of nested elements
MAX_ELEMENT_DEPTH = 32


class _Builder(ET.TreeBuilder):
    """Tree builder that refuses document types, with their entities, and deep nesting."""

    def __init__(self) -> None:
        super().__init__()
        self.depth = 0

    def doctype(self, name: str, pubid: str | None, system: str | None) -> None:
        raise ValueError("has a document type; files with entities are not read")

    def start(self, tag: Any, attrs: Any) -> Any:
        self.depth += 1
        if self.depth > MAX_ELEMENT_DEPTH:
            raise ValueError("nested too deeply")
        return super().start(tag, attrs)

    def end(self, tag: Any) -> Any:
        self.depth -= 1
        return super().end(tag)


def xml_root(content: bytes) -> ET.Element:
    """Return the root element of an XML text.

    Raises ParseError for a text that is not XML. Raises ValueError or LookupError for a document type, deep nesting or
    an unknown encoding.
    """
    return ET.fromstring(content, ET.XMLParser(target=_Builder()))
